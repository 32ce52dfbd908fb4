//! A scene as one camera sees it: how finely its shell is resolved, its stored density and shadow, and the hair that is drawn.

use super::GpuRenderer;
use super::items::{InsideItem, TriangleItem};
use super::layout::BlocksUniform;
use super::resident::Hair;
use crate::error::Result;
use crate::gpu::Timer;
use crate::hybrid::strands::LIT_POINTS;
use crate::stage::projection::Projection;
use crate::volume::march::volume::Volume;
use crate::volume::shell::{lattice, locate};

/// Everything that stays the same from band to band.
pub(super) struct Seen {
    /// Group 0.
    pub group: wgpu::BindGroup,
    /// Group 1.
    pub volume: wgpu::BindGroup,
    /// Outer faces of the shell.
    pub faces: wgpu::Buffer,
    /// Prisms around the eye.
    pub inside: wgpu::Buffer,
    /// Logarithms of guard hair's radiance, [`LIT_POINTS`] of each strand.
    pub log_radiance: wgpu::Buffer,
    /// Triangles of the skin.
    pub triangle_count: usize,
    /// Outer faces.
    pub face_count: usize,
    /// Segments of guard hair.
    pub segment_count: usize,
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
#[derive(Default)]
struct Stored {
    /// Column and triangle of each block.
    starts: Vec<[u32; 2]>,
    columns: usize,
}

impl Stored {
    /// Those of `order` that fit into `most_columns`; `columns_of` gives their columns. Tells `begins` where each begins.
    fn new(
        order: impl Iterator<Item = u32>,
        most_columns: usize,
        columns_of: impl Fn(u32) -> u32,
        mut begins: impl FnMut(u32, u32),
    ) -> Self {
        let mut stored = Self { starts: Vec::new(), columns: 0 };
        for triangle in order {
            let columns = columns_of(triangle) as usize;
            if stored.columns + columns > most_columns {
                continue;
            }
            begins(triangle, stored.columns as u32);
            stored.starts.push([stored.columns as u32, triangle]);
            stored.columns += columns;
        }
        stored
    }
}

impl Seen {
    /// Uploads what a view asks for and fills the shell. At most `most_bytes` go to the stored density, prisms within the view
    /// first; where that is not enough, the march asks the noise itself: the same picture, slower.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] where something does not fit the adapter.
    pub(super) fn new(
        renderer: &GpuRenderer<'_>,
        volume: Option<&Volume<'_>>,
        view: &Projection,
        most_bytes: usize,
    ) -> Result<Self> {
        let GpuRenderer { gpu, prepared, kernels, resident, .. } = renderer;
        let strands = prepared.scene.guard.map(|(strands, _)| strands);
        let hair = match strands.and_then(|strands| prepared.settings.thinning(view).of(strands)) {
            Some(thinned) => Hair::new(gpu, Some(&thinned))?,
            None => resident.whole(gpu, strands)?,
        };
        let mut uniform = resident.uniform;
        let layers = uniform.layers as usize;
        let mut triangles = resident.triangles.clone();
        let most_columns = most_bytes.min(gpu.largest_storage_bytes() as usize).min(u32::MAX as usize) / layers;
        let [density, shadow] = stored(volume, view, &mut triangles, most_columns);

        let around = volume.map_or(Vec::new(), |v| locate::around(v.shell(), view.eye_m));
        let inside: Vec<_> =
            around.iter().map(|&(triangle, point)| InsideItem { b: point.b, t: point.t, triangle }).collect();
        uniform.inside_count = inside.len() as u32;
        uniform.strand_count = hair.count as u32;
        let scene = gpu.buffer("scene", &[uniform], wgpu::BufferUsages::UNIFORM);
        let triangles_buffer = gpu.read_only("triangles", &triangles)?;
        let layouts = &kernels.layouts;
        let group = gpu.group(
            &layouts.scene,
            &[
                &scene,
                &triangles_buffer,
                &resident.vertices,
                &resident.tables,
                &resident.lights,
                &hair.strands,
                &hair.points,
                &resident.columns,
                &resident.looks,
            ],
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
        let looks_bytes = hair.count * LIT_POINTS * 12;
        Ok(Self {
            group,
            volume: gpu.group(&layouts.volume, &[&stored[0], &stored[1]]),
            faces: resident.faces.clone(),
            inside: gpu.read_only("prisms around the eye", &inside)?,
            log_radiance: gpu.storage("looks", hair.count * LIT_POINTS, 12)?,
            triangle_count: triangles.len(),
            face_count: uniform.face_count as usize,
            segment_count: hair.count * (uniform.points_per_strand as usize - 1),
            strand_count: hair.count,
            stored_bytes,
            bytes: [resident.bytes, hair.bytes + looks_bytes],
            fill_ms: timer.read_ms(gpu)?,
        })
    }
}

/// Which prisms have stored density and which stored shadow; writes how fine they are and where they begin to `triangles`.
fn stored(
    volume: Option<&Volume<'_>>,
    view: &Projection,
    triangles: &mut [TriangleItem],
    most_columns: usize,
) -> [Stored; 2] {
    let Some(volume) = volume else { return [Stored::default(), Stored::default()] };
    for (t, item) in (0..).zip(&mut *triangles) {
        (item.density_splits, item.shadow_splits) = (volume.subdivisions(t), volume.shadow_subdivisions(t));
    }
    let (seen, unseen): (Vec<u32>, Vec<u32>) = (0..triangles.len() as u32).partition(|&t| may_be_seen(volume, view, t));
    let density = Stored::new(
        seen.iter().chain(&unseen).copied(),
        most_columns,
        |t| 1 << (2 * volume.subdivisions(t)),
        |t, at| triangles[t as usize].density_at = at,
    );
    // Only what is seen is asked for its shadow, and what hair beside open borders grows on.
    let at_border = |&&t: &&u32| volume.shell().neighbours.at_border(t);
    let shadow = Stored::new(
        seen.iter().chain(unseen.iter().filter(at_border)).copied(),
        usize::MAX / (volume.layers() as usize + 1),
        |t| lattice::corners(volume.shadow_subdivisions(t)),
        |t, at| triangles[t as usize].shadow_at = at,
    );
    [density, shadow]
}

/// Whether a ray of the view may pass the prism over a triangle: not where all its corners lie outside of one side of the
/// picture. A prism lies within its corners' hull.
fn may_be_seen(volume: &Volume<'_>, view: &Projection, t: u32) -> bool {
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
