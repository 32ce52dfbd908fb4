//! What of a scene stays on the device whatever the camera: skin, lights, tables, and the hair where all of it is drawn.

use super::items::{AT_BORDER, LINEAR, NOTHING, StrandItem, TriangleItem, VertexItem};
use super::layout::SceneUniform;
use crate::data::strands::Strands;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::gpu::light::LightItem;
use crate::hybrid::prepared::Prepared;
use crate::math::table::Table;
use crate::volume::march::content::TABLES;
use crate::volume::mean::MeanShadow;
use crate::volume::scene::Scene;
use crate::volume::shell::{Shell, outer};
use bytemuck::Zeroable;
use std::sync::OnceLock;

/// A scene on the device, but for what a view asks of it.
pub(super) struct Resident {
    /// All but what a view counts.
    pub uniform: SceneUniform,
    /// All but how finely a view resolves them and where that is stored.
    pub triangles: Vec<TriangleItem>,
    /// Vertices of the skin.
    pub vertices: wgpu::Buffer,
    /// Heights of hair, and the mean shadow's depths.
    pub tables: wgpu::Buffer,
    /// Lights, the key first.
    pub lights: wgpu::Buffer,
    /// Columns of the mean shadow by triangle and corner of its lattice.
    pub columns: wgpu::Buffer,
    /// The looks of guard hair and undercoat.
    pub looks: wgpu::Buffer,
    /// Outer faces of the shell.
    pub faces: wgpu::Buffer,
    /// Bytes of skin and shell.
    pub bytes: usize,
    /// All hair, once a view has drawn it.
    whole: OnceLock<Hair>,
}

/// Guard hair on the device.
#[derive(Clone)]
pub(super) struct Hair {
    /// One item each.
    pub strands: wgpu::Buffer,
    /// Points of one after the other, m.
    pub points: wgpu::Buffer,
    /// How many.
    pub count: usize,
    /// Bytes of both.
    pub bytes: usize,
}

impl Hair {
    /// Uploads strands; none will do.
    ///
    /// # Errors
    /// As [`Gpu::read_only`].
    pub(super) fn new(gpu: &Gpu, strands: Option<&Strands>) -> Result<Self> {
        let items = strands.map_or(Vec::new(), StrandItem::of);
        let points_m = strands.map_or(&[][..], |strands| &strands.points_m);
        Ok(Self {
            strands: gpu.read_only("strands", &items)?,
            points: gpu.read_only("strand points", points_m)?,
            count: items.len(),
            bytes: size_of_val(&items[..]) + size_of_val(points_m),
        })
    }
}

impl Resident {
    /// Uploads a scene.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] where something does not fit the adapter.
    pub(super) fn new(gpu: &Gpu, prepared: &Prepared<'_>) -> Result<Self> {
        let Prepared { scene, lighting, settings, normals, above, content, mean, .. } = prepared;
        let shell = content.as_ref().map(|content| &content.shell);
        let faces = shell.map_or(Vec::new(), faces);
        let mut uniform = SceneUniform::new(scene, above, lighting, settings);
        uniform.face_count = faces.len() as u32;
        if let Some(Shell { undercoat, .. }) = shell {
            uniform.density_per_square_m = undercoat.density_per_m2;
            uniform.diameter_m = undercoat.diameter_m;
            uniform.stretch = undercoat.stretch;
            uniform.slope = undercoat.slope;
            uniform.pattern_amplitude = undercoat.pattern.amplitude;
            uniform.pattern_wavelength_m = undercoat.wavelength_m();
            uniform.pattern_jitter = undercoat.pattern.jitter;
            uniform.clump_spacing_m = undercoat.clump_spacing_m;
            uniform.clump_strength = undercoat.clump_strength;
        }
        let triangles: Vec<_> =
            (0..scene.skin.triangles.len() as u32).map(|t| triangle(scene, shell, mean.as_ref(), t)).collect();
        let mut tables =
            content.as_ref().map_or(vec![0.0; TABLES * Table::VALUES], |content| content.tables().concat());
        tables.extend(above.values());
        tables.extend(mean.iter().flat_map(MeanShadow::of_columns));
        let vertices = VertexItem::of(scene, normals, shell.map_or(&[], |shell| &shell.offsets_m));
        Ok(Self {
            bytes: size_of_val(&triangles[..]) + size_of_val(&vertices[..]) + size_of_val(&faces[..]),
            uniform,
            triangles,
            vertices: gpu.read_only("vertices", &vertices)?,
            tables: gpu.read_only("tables", &tables)?,
            lights: gpu.read_only("lights", &lighting.all().map(LightItem::from).collect::<Vec<_>>())?,
            columns: gpu.read_only("columns", mean.as_ref().map_or(&[], MeanShadow::numbers))?,
            faces: gpu.read_only("faces", &faces)?,
            looks: gpu.read_only("looks", &[scene.scattering.guard.packed(), scene.scattering.undercoat.packed()])?,
            whole: OnceLock::new(),
        })
    }

    /// All hair of the scene, uploaded where no view has asked for it before: from afar, fewer hairs are drawn.
    ///
    /// # Errors
    /// As [`Hair::new`].
    pub(super) fn whole(&self, gpu: &Gpu, strands: Option<&Strands>) -> Result<Hair> {
        if let Some(hair) = self.whole.get() {
            return Ok(hair.clone());
        }
        let hair = Hair::new(gpu, strands)?;
        Ok(self.whole.get_or_init(|| hair).clone())
    }
}

fn triangle(scene: &Scene<'_>, shell: Option<&Shell<'_>>, mean: Option<&MeanShadow<'_>>, t: u32) -> TriangleItem {
    let at_border = shell.is_some_and(|shell| shell.neighbours.at_border(t));
    let linear = mean.is_some_and(|mean| mean.is_linear(t));
    let beyond = |corner| {
        let side = shell.and_then(|shell| shell.neighbours.beyond(t, corner));
        side.map_or(NOTHING, |beyond| beyond.triangle << 2 | u32::from(beyond.corner))
    };
    let (mean_at, mean_splits) = mean.map_or((0, 0), |mean| mean.lattice(t));
    TriangleItem {
        corners: scene.skin.triangles[t as usize],
        beyond: [0, 1, 2].map(beyond),
        density_at: NOTHING,
        shadow_at: NOTHING,
        rest_area: scene.skin.rest_area_m2(t as usize),
        traits: u32::from(at_border) * AT_BORDER + u32::from(linear) * LINEAR,
        mean_splits,
        mean_at,
        ..TriangleItem::zeroed()
    }
}

/// The shell's outer faces, as `shared/faces.wgsl` numbers them.
fn faces(shell: &Shell<'_>) -> Vec<u32> {
    let numbers = |t: u32| outer::faces(shell, t, 1.0).map(move |f| t << 4 | f.kind << 1 | u32::from(f.turned));
    (0..shell.skin.triangles.len() as u32).flat_map(numbers).collect()
}
