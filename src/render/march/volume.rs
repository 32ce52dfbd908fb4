//! What fills the shell: density by sub-element, and the law that turns it into optical depth.

use super::light::Shadows;
use super::{Start, Step, Stepping};
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::Vec3;
use crate::render::pelt::{Layer, Pelt};
use crate::render::shell::Shell;
use crate::render::shell::block::Block;
use crate::render::shell::prism::{Jacobian, Place};
use std::f32::consts::FRAC_PI_4;
use std::sync::OnceLock;

/// How the volume is resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Layers between skin and top.
    pub layers: u32,
    /// Edge of a sub-element that is aimed at, px.
    pub subelement_px: f32,
    /// Most subdivisions of a triangle.
    pub most_subdivisions: u32,
    /// How many subdivisions fewer the stored shadow has.
    pub shadow_coarser: u32,
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
            pattern: Some(Pattern::default()),
        }
    }
}

/// Heights at which tables are kept.
const TABLE: usize = 64;

/// The undercoat of a pelt, ready to be marched through.
///
/// Sub-elements are filled prism by prism when a ray first needs them; a prism's values depend on nothing but itself, so
/// threads and order do not matter.
#[derive(Debug)]
pub struct Volume<'a> {
    shell: Shell<'a>,
    normals: &'a [Vec3],
    /// Normals of the rest pose, where the skin is in another.
    rest_normals: Option<Vec<Vec3>>,
    resolution: Resolution,
    subdivisions: Vec<u8>,
    density: Vec<OnceLock<Block>>,
    /// Shadows of the key light.
    pub shadows: Shadows,
    reaching: [f32; TABLE + 1],
    /// Hair area per skin area above a height: of undercoat, and of both kinds.
    above: [[f32; TABLE + 1]; 2],
}

impl<'a> Volume<'a> {
    /// Of a pelt's undercoat; none where it has no such hair. `subdivisions` gives d per triangle.
    pub fn new(
        pelt: &Pelt<'a>,
        normals: &'a [Vec3],
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
        let cells = |count: usize| std::iter::repeat_with(OnceLock::new).take(count).collect();
        let height = |i: usize| i as f32 / TABLE as f32;
        let own = Layer::new(fibre, 1.0, 1.0);
        let guard = pelt.guard.map(|(_, fibre)| Layer::new(fibre, 1.0, 1.0));
        Some(Self {
            shell: Shell::new(pelt.skin, pelt.fields, undercoat),
            normals,
            rest_normals: pelt.skin.rest_m.as_ref().map(|_| pelt.skin.at_rest().smooth_normals()),
            resolution,
            subdivisions,
            density: cells(triangles),
            shadows: Shadows::new(to_key, triangles),
            reaching: std::array::from_fn(|i| undercoat.reaching(height(i))),
            above: [None, guard].map(|further| {
                std::array::from_fn(|i| {
                    let height_m = height(i) * undercoat.height_m;
                    own.above(height_m) + further.map_or(0.0, |layer| layer.above(height_m))
                })
            }),
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

    /// By height in 64ths of the shell's: the share of hairs that reach it; the hair area above it per skin area, of
    /// undercoat and of both kinds.
    pub fn tables(&self) -> [&[f32]; 3] {
        [&self.reaching, &self.above[0], &self.above[1]]
    }

    /// Bytes of sub-elements filled so far: density and shadow.
    pub fn bytes(&self) -> [usize; 2] {
        [self.density.iter().filter_map(OnceLock::get).map(Block::bytes).sum(), self.shadows.bytes()]
    }

    /// Prisms filled so far, and their sub-elements.
    pub fn filled(&self) -> (usize, usize) {
        self.density.iter().filter_map(OnceLock::get).fold((0, 0), |(n, all), block| (n + 1, all + block.bytes()))
    }

    /// Hair area above height `t` per skin area: of undercoat, and of both kinds.
    pub fn above(&self, triangle: u32, b: Vec3, t: f32) -> [f32; 2] {
        let fields = self.shell.fields;
        let factor = self.shell.scalar(&fields.density, triangle, b) * self.shell.scalar(&fields.length, triangle, b);
        [factor * table(&self.above[0], t), factor * table(&self.above[1], t)]
    }

    /// Unit normal of the skin at a place.
    pub fn normal(&self, triangle: u32, b: Vec3) -> Vec3 {
        self.shell.vector(self.normals, triangle, b).normalize_or(Vec3::Y)
    }

    /// Density over its mean in the sub-element that holds a place.
    pub fn crowding(&self, triangle: u32, b: Vec3, t: f32) -> f32 {
        self.density[triangle as usize].get_or_init(|| self.fill(triangle)).at(b, t)
    }

    fn fill(&self, triangle: u32) -> Block {
        // Patterns keep to the rest pose, so that they do not swim under a moving skin.
        let foot_m = self.shell.skin.rest_corners_m(triangle as usize);
        let normals = self.rest_normals.as_deref().unwrap_or(self.normals);
        let d = u32::from(self.subdivisions[triangle as usize]);
        let clump = &self.shell.fields.clump;
        Block::fill(d, self.resolution.layers, |b| {
            let root_m = foot_m[0] * b.x + foot_m[1] * b.y + foot_m[2] * b.z;
            let factor = self.shell.scalar(clump, triangle, b);
            let normal = self.shell.vector(normals, triangle, b).normalize_or(Vec3::Y);
            let column = self.shell.undercoat.column(root_m, normal, factor);
            move |t| column.crowding(t)
        })
    }

    /// Subdivisions of the stored density of a triangle.
    pub fn subdivisions(&self, triangle: u32) -> u32 {
        u32::from(self.subdivisions[triangle as usize])
    }

    /// Subdivisions of the stored shadow of a triangle.
    pub fn shadow_subdivisions(&self, triangle: u32) -> u32 {
        u32::from(self.subdivisions[triangle as usize]).saturating_sub(self.resolution.shadow_coarser)
    }

    /// The step of `length_m` that begins at a place.
    ///
    /// Extinction is ρ⊥ D |sin∠|; ρ⊥, hair length per volume, is what stands on the triangle's area, so it thins as the
    /// prism widens. The ends of hairs that lie between the step's heights add (π/4) D² |cos∠| each.
    #[expect(clippy::too_many_arguments, reason = "one hot call; a struct of these would be made for it alone")]
    pub fn step(
        &self,
        j: &Jacobian,
        triangle: u32,
        place: &Place,
        rates: Vec3,
        from_m: f32,
        length_m: f32,
        direction: Vec3,
    ) -> Step {
        let middle = place.moved(rates, 0.5 * length_m).inside();
        let b = middle.barycentric();
        let undercoat = &self.shell.undercoat;
        let up_m = j.up_m.length();
        let hair = j.up_m / up_m;
        let cosine = hair.dot(direction);
        let per_m2 = undercoat.density_per_m2
            * self.shell.scalar(&self.shell.fields.density, triangle, b)
            * self.crowding(triangle, b, middle.t);
        // Hairs per volume and unit of t: on the triangle stand per_m2 · 2A/2 of them, in a volume of |det|/2 per t.
        let per_volume = 2.0 * per_m2 * self.shell.skin.rest_area_m2(triangle as usize) / j.determinant.abs();
        // Not √(1 − cos²), which rounds to a thousandth where a ray runs along the hair.
        let sine = undercoat.mean_sine(hair.cross(direction).length());
        let length_per_volume = per_volume * up_m * undercoat.stretch * table(&self.reaching, middle.t);
        let end_t = place.t + rates.z * length_m;
        let ends = (self.reach_at(place.t) - self.reach_at(end_t)).abs();
        let diameter_m = undercoat.diameter_m;
        // Once per hair, whichever end faces the ray: a cylinder's shadow is its side's and one end's.
        let end_depth = if rates.z != 0.0 && ends > 0.0 {
            per_volume * ends / rates.z.abs() * FRAC_PI_4 * diameter_m * diameter_m * cosine.abs()
        } else {
            0.0
        };
        let depth = length_per_volume * diameter_m * sine * length_m + end_depth;
        Step { from_m, length_m, triangle, place: middle, hair, depth: if depth.is_finite() { depth } else { 0.0 } }
    }

    /// As [`Undercoat::reaching`], with all hairs ended where the ray is at the top.
    fn reach_at(&self, t: f32) -> f32 {
        if t >= 1.0 - 1e-4 { 0.0 } else { table(&self.reaching, t) }
    }

    /// Optical depth along a ray that starts at a place, up to `enough`.
    pub fn depth_along(&self, origin_m: Vec3, direction: Vec3, start: Start, stepping: &Stepping, enough: f32) -> f32 {
        let mut sum = 0.0;
        super::march(self, origin_m, direction, start, f32::INFINITY, stepping, |step| {
            sum += step.depth;
            sum < enough
        });
        sum
    }
}

fn table(values: &[f32; TABLE + 1], t: f32) -> f32 {
    let at = t.clamp(0.0, 1.0) * TABLE as f32;
    let low = (at as usize).min(TABLE - 1);
    values[low] + (at - low as f32) * (values[low + 1] - values[low])
}
