//! A scene on the device: skin, hair and lights, and the shell's stored density and shadow.

use super::GpuRenderer;
use super::items::{AT_BORDER, InsideItem, LINEAR, NOTHING, StrandItem, TriangleItem, VertexItem};
use super::layout::{BlocksUniform, SceneUniform};
use crate::error::Result;
use crate::gpu::Timer;
use crate::gpu::light::LightItem;
use crate::hybrid::prepared::Prepared;
use crate::hybrid::strands::LOOKS;
use crate::math::Vec3;
use crate::math::table::Table;
use crate::stage::projection::View;
use crate::volume::march::content::TABLES;
use crate::volume::march::volume::Volume;
use crate::volume::mean::MeanShadow;
use crate::volume::scene::Scene;
use crate::volume::shell::{lattice, locate, outer};
use bytemuck::Zeroable;

/// Everything that stays the same from band to band.
pub(super) struct Resident {
    /// Group 0.
    pub group: wgpu::BindGroup,
    /// Group 1.
    pub volume: wgpu::BindGroup,
    /// Outer faces of the shell.
    pub faces: wgpu::Buffer,
    /// Prisms around the eye.
    pub inside: wgpu::Buffer,
    /// Logarithms of guard hair's radiance, [`LOOKS`] of each strand.
    pub looks: wgpu::Buffer,
    /// Triangles of the skin.
    pub triangle_count: usize,
    /// Outer faces.
    pub face_count: usize,
    /// Pieces of guard hair.
    pub piece_count: usize,
    /// Strands of guard hair.
    pub strand_count: usize,
    /// Bytes of stored density and shadow.
    pub stored_bytes: [usize; 2],
    /// Bytes of skin and strands.
    pub bytes: [usize; 2],
    /// What filled density and shadow, ms.
    pub fill_ms: Option<Vec<f64>>,
}

/// Blocks of sub-elements one after the other.
struct Stored {
    /// Column and triangle of each block.
    starts: Vec<[u32; 2]>,
    columns: usize,
}

impl Stored {
    /// Those of `order` that fit into `most_columns`; `columns_of` gives their columns. Writes where each begins to `place`.
    fn new(
        order: impl Iterator<Item = u32>,
        most_columns: usize,
        columns_of: impl Fn(u32) -> u32,
        mut place: impl FnMut(u32, u32),
    ) -> Self {
        let mut stored = Self { starts: Vec::new(), columns: 0 };
        for triangle in order {
            let columns = columns_of(triangle) as usize;
            if stored.columns + columns > most_columns {
                continue;
            }
            place(triangle, stored.columns as u32);
            stored.starts.push([stored.columns as u32, triangle]);
            stored.columns += columns;
        }
        stored
    }
}

impl Resident {
    /// Uploads a scene and fills its shell. At most `most_bytes` go to the stored density, prisms within the view first;
    /// where that is not enough, the march asks the noise itself: the same picture, slower.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] where something does not fit the adapter.
    pub(super) fn new(
        renderer: &GpuRenderer<'_>,
        volume: Option<&Volume<'_>>,
        view: &View,
        most_bytes: usize,
    ) -> Result<Self> {
        let GpuRenderer { gpu, prepared, kernels, .. } = renderer;
        let Prepared { lighting, settings, normals, mean, .. } = prepared;
        let mean = mean.as_ref();
        let thinned = prepared.scene.guard.and_then(|(strands, _)| settings.thinning(view).of(strands));
        let guard = prepared.scene.guard.map(|(strands, fibre)| (thinned.as_ref().unwrap_or(strands), fibre));
        let scene = &Scene { guard, ..prepared.scene };
        let mut uniform = SceneUniform::new(scene, &prepared.lobes, lighting, settings);
        let layers = uniform.layers as usize;
        let mut triangles: Vec<TriangleItem> =
            (0..scene.skin.triangles.len()).map(|t| triangle(scene, volume, mean, t as u32)).collect();
        let most_columns = most_bytes.min(gpu.largest_storage_bytes() as usize).min(u32::MAX as usize) / layers;
        let (seen, unseen): (Vec<u32>, Vec<u32>) = match volume {
            Some(volume) => (0..triangles.len() as u32).partition(|&t| may_be_seen(volume, view, t)),
            None => Default::default(),
        };
        let splits = |of: &dyn Fn(&Volume<'_>, u32) -> u32, t| volume.map_or(0, |v| of(v, t));
        let density = Stored::new(
            seen.iter().chain(&unseen).copied(),
            most_columns,
            |t| 1 << (2 * splits(&|v, t| v.subdivisions(t), t)),
            |t, at| triangles[t as usize].density_at = at,
        );
        // Only what is seen is asked for its shadow, and what hair beside open borders grows on.
        let at_border = |&&t: &&u32| volume.is_some_and(|v| v.shell().neighbours.at_border(t));
        let shadow = Stored::new(
            seen.iter().chain(unseen.iter().filter(at_border)).copied(),
            usize::MAX / (layers + 1),
            |t| lattice::corners(splits(&|v, t| v.shadow_subdivisions(t), t)),
            |t, at| triangles[t as usize].shadow_at = at,
        );

        let faces = volume.map_or(Vec::new(), faces);
        let around = volume.map_or(Vec::new(), |v| locate::around(v.shell(), view.eye_m));
        let inside: Vec<_> =
            around.iter().map(|&(triangle, place)| InsideItem { b: place.b, t: place.t, triangle }).collect();
        uniform.face_count = faces.len() as u32;
        uniform.inside_count = inside.len() as u32;
        if let Some(volume) = volume {
            let undercoat = &volume.shell().undercoat;
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
        let mut tables = volume.map_or(vec![0.0; TABLES * Table::VALUES], |v| v.content.tables().concat());
        if let Some(mean) = mean {
            tables.extend(mean.of_columns());
            let numbers_at = tables.len() as u32;
            // Whole up to 2²⁴, past which no buffer would hold the columns themselves.
            tables.extend(mean.numbers().iter().map(|&number| number as f32));
            for (t, item) in (0..).zip(&mut triangles) {
                let (first, splits) = mean.lattice(t);
                (item.mean_at, item.mean_splits) = (numbers_at + first, splits);
            }
        }
        let offsets_m = volume.map_or(&[][..], |v| &v.shell().offsets_m);
        let vertices = VertexItem::of(scene, normals, offsets_m);
        let (strands, points): (_, &[Vec3]) = match scene.guard {
            Some((strands, _)) => (StrandItem::of(strands), &strands.points_m),
            None => (Vec::new(), &[]),
        };
        let scene = gpu.buffer("scene", &[uniform], wgpu::BufferUsages::UNIFORM);
        let triangles_buffer = gpu.read_only("triangles", &triangles)?;
        let vertices_buffer = gpu.read_only("vertices", &vertices)?;
        let tables = gpu.read_only("tables", &tables)?;
        let lights: Vec<LightItem> = lighting.all().map(LightItem::from).collect();
        let lights = gpu.read_only("lights", &lights)?;
        let strands_buffer = gpu.read_only("strands", &strands)?;
        let points_buffer = gpu.read_only("strand points", points)?;
        let layouts = &kernels.layouts;
        let group = gpu.group(
            &layouts.scene,
            &[&scene, &triangles_buffer, &vertices_buffer, &tables, &lights, &strands_buffer, &points_buffer],
        );

        let stored_bytes = [density.columns * layers, shadow.columns * (layers + 1)];
        let stored = [gpu.storage("density", stored_bytes[0], 1)?, gpu.storage("shadow", stored_bytes[1], 1)?];
        let timer = Timer::new(gpu, 2);
        let nothing = gpu.storage("no shadow yet", 0, 1)?;
        let volumes = [[&nothing, &nothing], [&stored[0], &nothing]].map(|pair| gpu.group(&layouts.volume, &pair));
        let mut encoder = gpu.encoder("fill the shell");
        for (i, blocks) in [&density, &shadow].into_iter().enumerate() {
            let sizes = BlocksUniform { columns: blocks.columns as u32, count: blocks.starts.len() as u32 };
            let filled = gpu.group(
                &layouts.blocks,
                &[
                    &gpu.buffer("blocks", &[sizes, sizes], wgpu::BufferUsages::UNIFORM),
                    &gpu.read_only("block starts", &blocks.starts)?,
                    &stored[i],
                ],
            );
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(["density", "shadow"][i]),
                timestamp_writes: timer.compute_writes(i as u32),
            });
            let (kernel, threads) = [(&kernels.density, blocks.columns), (&kernels.shadow, stored_bytes[1])][i];
            kernel.dispatch(&mut pass, &[&group, &volumes[i], &filled], threads.div_ceil(64));
        }
        timer.stop(&mut encoder);
        gpu.finish(encoder)?;
        let volume = gpu.group(&layouts.volume, &[&stored[0], &stored[1]]);
        let per_strand = uniform.points_per_strand as usize;
        Ok(Self {
            group,
            volume,
            faces: gpu.read_only("faces", &faces)?,
            inside: gpu.read_only("prisms around the eye", &inside)?,
            looks: gpu.storage("looks", strands.len() * LOOKS, 12)?,
            triangle_count: triangles.len(),
            face_count: faces.len(),
            piece_count: strands.len() * (per_strand - 1),
            strand_count: strands.len(),
            stored_bytes,
            bytes: [
                size_of_val(&triangles[..]) + size_of_val(&vertices[..]) + size_of_val(&faces[..]),
                size_of_val(&strands[..]) + size_of_val(points) + strands.len() * LOOKS * 12,
            ],
            fill_ms: timer.read_ms(gpu)?,
        })
    }
}

fn triangle(scene: &Scene<'_>, volume: Option<&Volume<'_>>, mean: Option<&MeanShadow<'_>>, t: u32) -> TriangleItem {
    let at_border = volume.is_some_and(|v| v.shell().neighbours.at_border(t));
    let linear = mean.is_some_and(|mean| mean.is_linear(t));
    let beyond = |corner| {
        let side = volume.and_then(|v| v.shell().neighbours.beyond(t, corner));
        side.map_or(NOTHING, |beyond| beyond.triangle << 2 | u32::from(beyond.corner))
    };
    TriangleItem {
        corners: scene.skin.triangles[t as usize],
        density_splits: volume.map_or(0, |v| v.subdivisions(t)),
        beyond: [0, 1, 2].map(beyond),
        shadow_splits: volume.map_or(0, |v| v.shadow_subdivisions(t)),
        density_at: NOTHING,
        shadow_at: NOTHING,
        rest_area: scene.skin.rest_area_m2(t as usize),
        traits: u32::from(at_border) * AT_BORDER + u32::from(linear) * LINEAR,
        ..TriangleItem::zeroed()
    }
}

/// The shell's outer faces, as `shared/faces.wgsl` numbers them.
fn faces(volume: &Volume<'_>) -> Vec<u32> {
    let shell = volume.shell();
    let numbers = |t: u32| outer::faces(shell, t, 1.0).map(move |f| t << 4 | f.kind << 1 | u32::from(f.turned));
    (0..shell.skin.triangles.len() as u32).flat_map(numbers).collect()
}

/// Whether a ray of the view may pass the prism over a triangle: not where all its corners lie outside of one side of the
/// picture. A prism lies within its corners' hull.
fn may_be_seen(volume: &Volume<'_>, view: &View, t: u32) -> bool {
    let prism = volume.shell().prism(t);
    let corners = [0, 1, 2].map(|i| [prism.foot_m[i], prism.foot_m[i] + prism.offset_m[i]]);
    let points = corners.as_flattened().iter().map(|&p| view.camera_from_world(p));
    let size = view.size.map(|n| n as f32);
    // Passes look up to half a pixel beside the picture's own rays; a pixel more is room for rounding.
    let (low, high) = (-2.0 - view.centre_px, crate::math::Vec2::new(size[0], size[1]) + 2.0 - view.centre_px);
    let mut outside = [true; 5];
    for p in points {
        let at = p.truncate() * view.focal_px;
        let sides = [at.x < low.x * p.z, at.x > high.x * p.z, at.y < low.y * p.z, at.y > high.y * p.z, p.z < 0.0];
        for (all, side) in outside.iter_mut().zip(sides) {
            *all &= side;
        }
    }
    !outside.contains(&true)
}
