//! The shell's undercoat at the resolution of a view: density by sub-element, and the law that turns it into optical depth.

use super::content::Content;
use super::{From, MarchSteps};
use crate::fur::groom::clump::Nearby;
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, Vec3Row, Vec3s};
use crate::volume::shell::Shell;
use crate::volume::shell::block::{Block, Blocks, codes};
use crate::volume::shell::prisms::Prisms;
use crate::volume::shell::subelement;
use std::f32::consts::FRAC_PI_4;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Subdivisions that split an edge into parts of about `part_m`.
pub fn splits(edge_m: f32, part_m: f32) -> u32 {
    libm::roundf(libm::log2f((edge_m / part_m).max(1.0))) as u32
}

/// [`Content`] as finely as a view resolves it, ready to be marched through.
///
/// Sub-elements are filled prism by prism when a ray first needs them; a prism's values depend on nothing but itself, so
/// threads and order do not matter.
#[derive(Debug)]
pub struct Volume<'a> {
    /// What fills the shell.
    pub content: &'a Content<'a>,
    subdivisions: Vec<u8>,
    density: Vec<OnceLock<Block>>,
    density_ns: AtomicU64,
}

impl<'a> Volume<'a> {
    /// Of `content`; `subdivisions` gives d per triangle.
    pub fn new(content: &'a Content<'a>, subdivisions: Vec<u8>) -> Self {
        let density = std::iter::repeat_with(OnceLock::new).take(subdivisions.len()).collect();
        Self { content, subdivisions, density, density_ns: AtomicU64::new(0) }
    }

    /// The shell.
    pub fn shell(&self) -> &'a Shell<'a> {
        &self.content.shell
    }

    /// Layers between skin and top.
    pub fn layers(&self) -> u32 {
        self.content.resolution.layers
    }

    /// Bytes of sub-elements filled so far.
    pub fn bytes(&self) -> usize {
        self.density.iter().filter_map(OnceLock::get).map(Block::bytes).sum()
    }

    /// Time spent filling so far, summed over threads, ms.
    pub fn filling_ms(&self) -> f64 {
        self.density_ns.load(Ordering::Relaxed) as f64 * 1e-6
    }

    /// Density over its mean in the sub-elements of a prism. Where they are filled now, the time this takes is added to
    /// `filling_ns`.
    #[inline]
    pub fn block(&self, triangle: u32, filling_ns: &mut u64) -> &Block {
        let cell = &self.density[triangle as usize];
        if let Some(block) = cell.get() {
            return block;
        }
        cell.get_or_init(|| {
            let start = Instant::now();
            let block = lanes::run(Fill { volume: self, triangle });
            let ns = start.elapsed().as_nanos() as u64;
            self.density_ns.fetch_add(ns, Ordering::Relaxed);
            *filling_ns += ns;
            block
        })
    }

    /// Subdivisions of the stored density of a triangle.
    pub fn subdivisions(&self, triangle: u32) -> u32 {
        u32::from(self.subdivisions[triangle as usize])
    }

    /// Subdivisions of the stored shadow of a triangle.
    pub fn shadow_subdivisions(&self, triangle: u32) -> u32 {
        let Content { shell, resolution, .. } = self.content;
        let d = self.subdivisions(triangle);
        let coarser = d.saturating_sub(resolution.shadow_coarser);
        let splits_of = |details: f32| {
            let coarsest_m = details * resolution.coarsest_details * shell.undercoat.detail_m();
            splits(shell.skin.mean_edge_m(triangle as usize), coarsest_m)
        };
        // Light comes in over open borders, and what it finds between clumps there is seen end on.
        coarser.max(if shell.neighbours.at_border(triangle) { splits_of(0.5) } else { splits_of(2.0).min(d) })
    }

    /// The steps of `length_m` that begin at `from`.
    ///
    /// Extinction is ρ⊥ D |sin∠|; ρ⊥, hair length per volume, is what stands on the triangle's area, so it thins as the
    /// prism widens. The ends of hairs that lie between the step's heights add (π/4) D² |cos∠| each.
    #[inline(always)]
    pub(super) fn steps<I: Isa>(
        &self,
        prisms: &Prisms,
        blocks: &Blocks<'_>,
        from: &From<I>,
        length_m: F32s<I>,
    ) -> MarchSteps<I> {
        let zero = F32s::splat(0.0);
        let middle = from.points.moved(from.rates, length_m * 0.5).inside();
        let b = middle.barycentric();
        let content = self.content;
        let undercoat = &content.shell.undercoat;
        let up_m = from.j.up_m.length();
        let hair = from.j.up_m * (F32s::splat(1.0) / up_m);
        let cosine = hair.dot(from.direction);
        let per_m2 = prisms.density(b) * blocks.at(b, middle.t) * undercoat.density_per_m2;
        // Hairs per volume and unit of t: on the triangle stand per_m2 · 2A/2 of them, in a volume of |det|/2 per t.
        let per_volume = per_m2 * prisms.twice_area_m2() / from.j.determinant.abs();
        // Not √(1 − cos²), which rounds to a thousandth where a ray runs along the hair.
        let sine = undercoat.mean_sines(hair.cross(from.direction).length());
        let length_per_volume = per_volume * up_m * content.reaching(middle.t) * undercoat.stretch;
        let begin_t = from.points.t;
        let ends = (content.reach_at(begin_t) - content.reach_at(begin_t + from.rates.z * length_m)).abs();
        let diameter_m = undercoat.diameter_m;
        // Once per hair, whichever end faces the ray: a cylinder's shadow is its side's and one end's.
        let end_m2 = cosine.abs() * (FRAC_PI_4 * diameter_m * diameter_m);
        let end_depth = ends.gt(zero).keep(per_volume * ends / from.rates.z.abs() * end_m2);
        let depth = length_per_volume * sine * length_m * diameter_m + end_depth;
        MarchSteps {
            from_m: from.at_m,
            length_m,
            b,
            t: middle.t,
            hair,
            direction: from.direction,
            depth: depth.lt(F32s::splat(f32::INFINITY)).keep(depth),
        }
    }
}

/// Fills the density of one prism.
struct Fill<'v, 'a> {
    volume: &'v Volume<'a>,
    triangle: u32,
}

/// Values at a triangle's corners, mixed.
#[inline(always)]
fn mixed<I: Isa>(corners: [Vec3; 3], b: Vec3s<I>) -> Vec3s<I> {
    Vec3s::splat(corners[0]) * b.x + Vec3s::splat(corners[1]) * b.y + Vec3s::splat(corners[2]) * b.z
}

impl lanes::Work for Fill<'_, '_> {
    type Output = Block;

    #[inline(always)]
    fn run<I: Isa>(self) -> Block {
        let Self { volume, triangle } = self;
        let shell = volume.shell();
        let corners = shell.skin.triangles[triangle as usize].map(|v| v as usize);
        // Patterns keep to the rest pose, so that they do not swim under a moving skin.
        let foot_m = shell.skin.rest_corners_m(triangle as usize);
        let normals = corners.map(|v| volume.content.rest_normals[v]);
        let clump = corners.map(|v| shell.fields.clump[v]);
        let d = u32::from(volume.subdivisions[triangle as usize]);
        let (layers, per_layer) = (volume.layers() as usize, 1_usize << (2 * d));
        let mut nearby = Nearby::default();
        let mut values = vec![0; layers * per_layer];
        for first in (0..per_layer).step_by(I::LANES) {
            let count = I::LANES.min(per_layer - first);
            let mut b = Vec3Row::default();
            for lane in 0..count {
                b.set(lane, subelement::centre((first + lane) as u32, d));
            }
            let b = Vec3s::<I>::of(&b);
            let root_m = mixed(foot_m, b);
            let normal = mixed(normals, b).normalized_or(Vec3s::splat(Vec3::Y));
            let factor = b.x * clump[0] + b.y * clump[1] + b.z * clump[2];
            let columns = shell.undercoat.columns(&mut nearby, root_m, normal, factor);
            for layer in 0..layers {
                let t = F32s::splat((layer as f32 + 0.5) / layers as f32);
                let codes = codes(columns.crowdings(t)).row();
                for (lane, &code) in codes[..count].iter().enumerate() {
                    values[(first + lane) * layers + layer] = code as u8;
                }
            }
        }
        Block::of_codes(d, layers as u32, values)
    }
}
