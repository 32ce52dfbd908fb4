//! What fills the shell: density by sub-element, and the law that turns it into optical depth.

use super::light::Shadows;
use super::prisms::Prisms;
use super::{From, Steps};
use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, Vec3Row, Vec3s};
use crate::render::pelt::{Layer, Pelt};
use crate::render::shell::Shell;
use crate::render::shell::block::{Block, Blocks, codes};
use crate::render::shell::subelement;
use crate::render::table::Table;
use std::cell::Cell;
use std::f32::consts::FRAC_PI_4;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

thread_local! {
    /// Time that this thread has spent on filling densities and the mean shadow, ns: shadows take their own without it.
    pub(in crate::render) static OTHER_NS: Cell<u64> = const { Cell::new(0) };
}

/// How the volume is resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Layers between skin and top.
    pub layers: u32,
    /// Edge of a sub-element that is aimed at, px.
    pub subelement_px: f32,
    /// Most subdivisions of a triangle.
    pub most_subdivisions: u32,
    /// How many subdivisions fewer the stored shadow has, where `coarsest_details` does not ask for more.
    pub shadow_coarser: u32,
    /// Largest sub-elements of density, in finest details of clumps and pattern; those of the shadow are at most twice as
    /// large.
    pub coarsest_details: f32,
    /// Pattern of the density; none for the mean density everywhere but for clumps.
    pub pattern: Option<Pattern>,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            layers: 16,
            subelement_px: 1.5,
            most_subdivisions: 7,
            shadow_coarser: 2,
            coarsest_details: f32::INFINITY,
            pattern: Some(Pattern::default()),
        }
    }
}

/// How many [`Volume::tables`] there are.
pub const TABLES: usize = 3;

/// Subdivisions that split an edge into parts of about `part_m`.
pub fn splits(edge_m: f32, part_m: f32) -> u32 {
    libm::roundf(libm::log2f((edge_m / part_m).max(1.0))) as u32
}

/// A vertex of the skin and the shell over it.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// On the skin, m.
    pub foot_m: Vec3,
    /// Skin to top, m.
    pub offset_m: Vec3,
    /// Smooth normal of the skin.
    pub normal: Vec3,
    /// Hair colour under the root.
    pub tint: Vec3,
    /// Hair density over the preset's.
    pub density: f32,
    /// Hair length over the preset's.
    pub length: f32,
}

/// The undercoat of a pelt, ready to be marched through.
///
/// Sub-elements are filled prism by prism when a ray first needs them; a prism's values depend on nothing but itself, so
/// threads and order do not matter.
#[derive(Debug)]
pub struct Volume<'a> {
    shell: Shell<'a>,
    vertices: Vec<Vertex>,
    /// Twice the area of each triangle in the rest pose, m².
    twice_area_m2: Vec<f32>,
    /// Normals of the rest pose.
    rest_normals: Vec<Vec3>,
    resolution: Resolution,
    subdivisions: Vec<u8>,
    density: Vec<OnceLock<Block>>,
    density_ns: AtomicU64,
    /// Shadows of the key light.
    pub shadows: Shadows,
    reaching: Table,
    /// Hair area per skin area above a height, of both kinds.
    above: Table,
    /// Where between the levels of the stored shadow a height lies.
    level: Table,
}

impl<'a> Volume<'a> {
    /// Of a pelt's undercoat; none where it has no such hair. `subdivisions` gives d per triangle.
    pub fn new(
        pelt: &Pelt<'a>,
        normals: &[Vec3],
        to_key: Vec3,
        resolution: Resolution,
        subdivisions: Vec<u8>,
    ) -> Option<Self> {
        let fibre = pelt.undercoat?;
        let undercoat = Undercoat::new(fibre, resolution.pattern);
        if undercoat.density_per_m2 <= 0.0 || undercoat.height_m <= 0.0 {
            return None;
        }
        let triangles = pelt.skin.triangles.len();
        let own = Layer::new(fibre, 1.0, 1.0);
        let guard = pelt.guard.map(|(_, fibre)| Layer::new(fibre, 1.0, 1.0));
        let above = Table::new(|t| {
            let height_m = t * undercoat.height_m;
            own.above(height_m) + guard.map_or(0.0, |layer| layer.above(height_m))
        });
        let last_level = resolution.layers.max(1) as f32;
        let level = Table::new(|t| {
            let low = (t * last_level).floor().min(last_level - 1.0);
            let [below, here, over] = [low, t * last_level, low + 1.0].map(|level| above.at(level / last_level));
            if over < below { low + (here - below) / (over - below) } else { t * last_level }
        });
        let shell = Shell::new(pelt.skin, pelt.fields, undercoat);
        let fields = pelt.fields;
        let vertex = |v: usize| Vertex {
            foot_m: pelt.skin.positions_m[v],
            offset_m: shell.offsets_m[v],
            normal: normals[v],
            tint: fields.tint[v],
            density: fields.density[v],
            length: fields.length[v],
        };
        Some(Self {
            vertices: (0..pelt.skin.positions_m.len()).map(vertex).collect(),
            twice_area_m2: (0..triangles).map(|t| 2.0 * pelt.skin.rest_area_m2(t)).collect(),
            rest_normals: match pelt.skin.rest_m {
                Some(_) => pelt.skin.at_rest().smooth_normals(),
                None => normals.to_vec(),
            },
            resolution,
            subdivisions,
            density: std::iter::repeat_with(OnceLock::new).take(triangles).collect(),
            density_ns: AtomicU64::new(0),
            shadows: Shadows::new(to_key, &shell),
            reaching: Table::new(|t| undercoat.reaching(t)),
            above,
            level,
            shell,
        })
    }

    /// The shell.
    pub fn shell(&self) -> &Shell<'a> {
        &self.shell
    }

    /// Layers between skin and top.
    pub fn layers(&self) -> u32 {
        self.resolution.layers
    }

    /// By height in 64ths of the shell's: the share of hairs that reach it; the hair area of both kinds above it per skin
    /// area; where between the stored shadow's levels it lies.
    pub fn tables(&self) -> [&[f32]; TABLES] {
        [self.reaching.values(), self.above.values(), self.level.values()]
    }

    /// Where between the stored shadow's levels heights lie: linear there is what a flat coat's shadow is in between, which
    /// falls off fast towards the tips.
    #[inline(always)]
    pub fn level<I: Isa>(&self, t: F32s<I>) -> F32s<I> {
        self.level.at_lanes(t)
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [&Vertex; 3] {
        self.shell.skin.triangles[triangle as usize].map(|v| &self.vertices[v as usize])
    }

    /// Twice the area of a triangle in the rest pose, m²: what its hair grew on.
    #[inline]
    pub fn twice_area_m2(&self, triangle: u32) -> f32 {
        self.twice_area_m2[triangle as usize]
    }

    /// Bytes of sub-elements filled so far: density and shadow.
    pub fn bytes(&self) -> [usize; 2] {
        [self.density.iter().filter_map(OnceLock::get).map(Block::bytes).sum(), self.shadows.bytes()]
    }

    /// Time spent filling so far, summed over threads, ms: density and shadow.
    pub fn filling_ms(&self) -> [f64; 2] {
        [&self.density_ns, &self.shadows.spent_ns].map(|ns| ns.load(Ordering::Relaxed) as f64 * 1e-6)
    }

    /// Hair area of both kinds above heights per skin area.
    #[inline(always)]
    pub fn above<I: Isa>(&self, prisms: &Prisms, steps: &Steps<I>) -> F32s<I> {
        prisms.density(steps.b) * prisms.length(steps.b) * self.above.at_lanes(steps.t)
    }

    /// Density over its mean in the sub-elements of a prism.
    #[inline]
    pub fn block(&self, triangle: u32) -> &Block {
        let cell = &self.density[triangle as usize];
        if let Some(block) = cell.get() {
            return block;
        }
        cell.get_or_init(|| {
            let start = Instant::now();
            let block = lanes::run(Fill { volume: self, triangle });
            let ns = start.elapsed().as_nanos() as u64;
            self.density_ns.fetch_add(ns, Ordering::Relaxed);
            OTHER_NS.set(OTHER_NS.get() + ns);
            block
        })
    }

    /// Subdivisions of the stored density of a triangle.
    pub fn subdivisions(&self, triangle: u32) -> u32 {
        u32::from(self.subdivisions[triangle as usize])
    }

    /// Subdivisions of the stored shadow of a triangle.
    pub fn shadow_subdivisions(&self, triangle: u32) -> u32 {
        let d = self.subdivisions(triangle);
        let coarser = d.saturating_sub(self.resolution.shadow_coarser);
        let splits_of = |details: f32| {
            let coarsest_m = details * self.resolution.coarsest_details * self.shell.undercoat.detail_m();
            splits(self.shell.skin.mean_edge_m(triangle as usize), coarsest_m)
        };
        // Light comes in over open borders, and what it finds between clumps there is seen end on.
        coarser.max(if self.shell.neighbours.at_border(triangle) { splits_of(0.5) } else { splits_of(2.0).min(d) })
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
    ) -> Steps<I> {
        let zero = F32s::splat(0.0);
        let middle = from.places.moved(from.rates, length_m * 0.5).inside();
        let b = middle.barycentric();
        let undercoat = &self.shell.undercoat;
        let up_m = from.j.up_m.length();
        let hair = from.j.up_m * (F32s::splat(1.0) / up_m);
        let cosine = hair.dot(from.direction);
        let per_m2 = prisms.density(b) * blocks.at(b, middle.t) * undercoat.density_per_m2;
        // Hairs per volume and unit of t: on the triangle stand per_m2 · 2A/2 of them, in a volume of |det|/2 per t.
        let per_volume = per_m2 * prisms.twice_area_m2() / from.j.determinant.abs();
        // Not √(1 − cos²), which rounds to a thousandth where a ray runs along the hair.
        let sine = undercoat.mean_sines(hair.cross(from.direction).length());
        let length_per_volume = per_volume * up_m * self.reaching.at_lanes(middle.t) * undercoat.stretch;
        let begin_t = from.places.t;
        let ends = (self.reach_at(begin_t) - self.reach_at(begin_t + from.rates.z * length_m)).abs();
        let diameter_m = undercoat.diameter_m;
        // Once per hair, whichever end faces the ray: a cylinder's shadow is its side's and one end's.
        let end_m2 = cosine.abs() * (FRAC_PI_4 * diameter_m * diameter_m);
        let end_depth = ends.gt(zero).keep(per_volume * ends / from.rates.z.abs() * end_m2);
        let depth = length_per_volume * sine * length_m * diameter_m + end_depth;
        Steps {
            from_m: from.at_m,
            length_m,
            b,
            t: middle.t,
            hair,
            direction: from.direction,
            depth: depth.lt(F32s::splat(f32::INFINITY)).keep(depth),
        }
    }

    /// As [`Undercoat::reaching`], with all hairs ended where the ray is at the top.
    #[inline(always)]
    fn reach_at<I: Isa>(&self, t: F32s<I>) -> F32s<I> {
        t.lt(F32s::splat(1.0 - 1e-4)).keep(self.reaching.at_lanes(t))
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
        let shell = &volume.shell;
        let corners = shell.skin.triangles[triangle as usize].map(|v| v as usize);
        // Patterns keep to the rest pose, so that they do not swim under a moving skin.
        let foot_m = shell.skin.rest_corners_m(triangle as usize);
        let normals = corners.map(|v| volume.rest_normals[v]);
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
