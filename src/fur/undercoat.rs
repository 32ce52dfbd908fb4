//! Undercoat as a density over the shell: how many hairs reach a height, how they crowd, how they block a ray
//! (`docs/steps/march.md`).

use super::groom::clump::{ClumpGrid, Nearby};
use super::groom::fibre::{Fibre, LENGTH_SPREAD};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Mask, Scalar, Vec3s};
use crate::math::noise::simplex_lanes;

/// The pattern that thins and thickens undercoat (Andersen et al. 2016 §3.2): one noise over the skin through all layers,
/// blurred towards the tips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// Largest relative departure from the mean density, in [0, 1].
    pub amplitude: f32,
    /// Distance between features, in distances between clumps.
    pub wavelength: f32,
    /// Sideways jitter of the pattern at the tips, in wavelengths.
    pub jitter: f32,
}

impl Default for Pattern {
    fn default() -> Self {
        Self { amplitude: 0.4, wavelength: 0.5, jitter: 0.5 }
    }
}

/// The crowding of hair over points of the skin, one per lane.
#[derive(Clone, Copy, Debug)]
pub struct Columns<I: Isa> {
    amplitude: f32,
    at: Vec3s<I>,
    blur: Vec3s<I>,
    strength: F32s<I>,
    /// The q at which hair would come from beyond the clump's cell.
    wall: F32s<I>,
    /// Wavelengths after which the pattern repeats.
    waves: Option<f32>,
}

impl Columns<Scalar> {
    /// Density over its mean at height `t`.
    pub fn crowding(&self, t: f32) -> f32 {
        self.crowdings(F32s::splat(t)).row().0[0]
    }
}

impl<I: Isa> Columns<I> {
    /// Densities over their means at heights `t`.
    #[inline(always)]
    pub fn crowdings(&self, t: F32s<I>) -> F32s<I> {
        let one = F32s::splat(1.0);
        let mut factor = one;
        if self.amplitude > 0.0 {
            factor = factor + simplex_lanes(self.at + self.blur * t, 0, self.waves) * self.amplitude;
        }
        let pull = (t * t.sqrt() * self.strength).min(F32s::splat(0.9));
        let q = one / (one - pull);
        q.lt(self.wall).keep(factor * q * q)
    }
}

/// A kind of hair as a volume. Heights t are shares of the tallest hair's, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undercoat {
    /// Hairs per skin area, 1/m².
    pub density_per_m2: f32,
    /// Diameter, m.
    pub diameter_m: f32,
    /// Height of the tallest hair, m, where the length field is 1.
    pub height_m: f32,
    /// Length along the hair over its height.
    pub stretch: f32,
    /// Standard deviation of each hair's slope against the mean.
    pub slope: f32,
    /// Pattern of the density.
    pub pattern: Pattern,
    mean: f32,
    spread: f32,
    /// Mean distance between clumps, m.
    pub clump_spacing_m: f32,
    /// Edge of the square that it repeats on along x and y, m; none on a skin.
    torus_m: Option<f32>,
    /// How far tips move towards their clump's centre, in [0, 1].
    pub clump_strength: f32,
}

impl Undercoat {
    /// Of a kind of hair, with or without a pattern in its density.
    pub fn new(fibre: &Fibre, pattern: Option<Pattern>) -> Self {
        let variation = fibre.shape.length_variation;
        let mean = 1.0 / (1.0 + LENGTH_SPREAD * variation);
        let spacing_m = fibre.shape.clump.spacing_mm * 1e-3;
        let height_m = fibre.height_m();
        Self {
            density_per_m2: fibre.density_per_m2,
            diameter_m: fibre.radius_m * (1.0 + fibre.profile.taper),
            height_m,
            stretch: fibre.longest_m() / height_m.max(f32::MIN_POSITIVE),
            slope: libm::tanf(fibre.shape.jitter_deg.to_radians()),
            pattern: pattern.unwrap_or(Pattern { amplitude: 0.0, ..Pattern::default() }),
            mean,
            spread: mean * variation,
            clump_spacing_m: spacing_m,
            torus_m: None,
            clump_strength: fibre.shape.clump.strength,
        }
    }

    /// The same hair on a square that repeats after `edge_m`: clumps become a whole part of it wide, and three wavelengths of the
    /// pattern too (what [`simplex_lanes`] asks for).
    pub fn on_torus(mut self, edge_m: f32) -> Self {
        let threes = (edge_m / (3.0 * self.wavelength_m())).round().max(1.0);
        self.clump_spacing_m = ClumpGrid::on_torus(self.clump_spacing_m, edge_m).spacing_m;
        self.pattern.wavelength = edge_m / (3.0 * threes) / self.clump_spacing_m;
        self.torus_m = Some(edge_m);
        self
    }

    /// Share of the hairs that reach height `t`: lengths are normally distributed.
    pub fn reaching(&self, t: f32) -> f32 {
        if t > 1.0 {
            return 0.0;
        }
        if self.spread < 1e-6 {
            return f32::from(u8::from(t <= self.mean));
        }
        0.5 * libm::erfcf((t - self.mean) / (self.spread * std::f32::consts::SQRT_2))
    }

    /// Distance between the pattern's features, m.
    pub fn wavelength_m(&self) -> f32 {
        self.pattern.wavelength * self.clump_spacing_m
    }

    /// Finest detail of [`Self::columns`], m; infinite where there is none.
    pub fn detail_m(&self) -> f32 {
        let pattern = if self.pattern.amplitude > 0.0 { self.wavelength_m() } else { f32::INFINITY };
        let clumps = if self.clump_strength > 0.0 { self.clump_spacing_m } else { f32::INFINITY };
        0.2 * pattern.min(clumps)
    }

    /// What crowds the hair over the skin's point `root_m` with this normal, at all heights.
    pub fn column(&self, root_m: Vec3, normal: Vec3, clump_factor: f32) -> Columns<Scalar> {
        self.column_near(&mut Nearby::default(), root_m, normal, clump_factor)
    }

    /// The same; `nearby` may have been used for a point close by.
    pub fn column_near(&self, nearby: &mut Nearby, root_m: Vec3, normal: Vec3, clump_factor: f32) -> Columns<Scalar> {
        self.columns(nearby, Vec3s::splat(root_m), Vec3s::splat(normal), F32s::splat(clump_factor))
    }

    /// The same for points in lanes; `nearby` may have been used for points close by.
    ///
    /// Clumps are cones: a hair at distance r from its clump's centre stands at r/q at height t, q = 1/(1 − pull), so that
    /// what was spread over the clump's cell crowds by q² inside, and nothing is left outside: where the hair that would
    /// stand here had to come from beyond the cell's wall.
    #[inline(always)]
    pub fn columns<I: Isa>(
        &self,
        nearby: &mut Nearby,
        root_m: Vec3s<I>,
        normal: Vec3s<I>,
        clump_factor: F32s<I>,
    ) -> Columns<I> {
        let mut columns = Columns {
            amplitude: self.pattern.amplitude,
            at: Vec3s::all(0.0),
            blur: Vec3s::all(0.0),
            strength: clump_factor * self.clump_strength,
            wall: F32s::splat(f32::INFINITY),
            waves: self.torus_m.map(|edge_m| (edge_m / self.wavelength_m()).round()),
        };
        if columns.amplitude > 0.0 {
            columns.at = root_m.over(F32s::splat(self.wavelength_m()));
            // A fine noise moves the coarse one about, more towards the tips.
            let fine = columns.at * F32s::splat(4.0);
            let waves = columns.waves.map(|waves| 4.0 * waves);
            let (a, b) = (simplex_lanes(fine, 1, waves), simplex_lanes(fine, 2, waves));
            columns.blur = Vec3s::new(a, b, -a) * F32s::splat(self.pattern.jitter);
        }
        let mut waiting = columns.strength.gt(F32s::splat(1e-3)).bits();
        if waiting != 0 {
            let period = self.torus_m.map(|edge_m| (edge_m / self.clump_spacing_m).round());
            let grid = ClumpGrid { spacing_m: self.clump_spacing_m, period };
            let over = root_m.over(F32s::splat(self.clump_spacing_m));
            let homes = Vec3s::new(over.x.floor(), over.y.floor(), over.z.floor()).rows();
            // Points close by mostly share their cell.
            while waiting != 0 {
                let first = waiting.trailing_zeros() as usize;
                let mut here = 1 << first;
                for lane in first + 1..I::LANES {
                    here |= u32::from(homes.lane(lane) == homes.lane(first)) << lane;
                }
                let centres_m = nearby.centres_m(homes.lane(first), &grid);
                let found = walls(centres_m, root_m, normal);
                columns.wall = Mask::from_bits(here & waiting).select(found, columns.wall);
                waiting &= !here;
            }
        }
        columns
    }

    /// [`Self::mean_sine`] in lanes.
    #[inline(always)]
    pub fn mean_sines<I: Isa>(&self, sine: F32s<I>) -> F32s<I> {
        let variance = self.slope * self.slope;
        let s2 = sine * sine;
        let c = F32s::splat(0.570_796 * variance) / (s2 * 0.434 + (variance + 1e-12)) + 1.0;
        ((s2 + c * variance) * (1.0 / (1.0 + variance))).sqrt().min(F32s::splat(1.0))
    }

    /// Mean |sin∠(ω, t)| over the hairs' slopes, where the mean hair's is `sine`.
    ///
    /// The slope across the ray is normal in two dimensions, so its mean length is Rice's; √(s² + c σ²), with c between
    /// π/2 and 1, is within 1 % of it.
    pub fn mean_sine(&self, sine: f32) -> f32 {
        let variance = self.slope * self.slope;
        let s2 = sine * sine;
        let c = 1.0 + 0.570_796 * variance / (variance + 0.434 * s2 + 1e-12);
        // The slope is measured against the hair's height: steeper hairs are thinner by their cosine.
        ((s2 + c * variance) / (1.0 + variance)).sqrt().min(1.0)
    }
}

/// The q at which hair of the nearest of these centres' clumps would come from beyond its cell.
#[inline(always)]
fn walls<I: Isa>(centres_m: &[Vec3; 27], root_m: Vec3s<I>, normal: Vec3s<I>) -> F32s<I> {
    let (mut own, mut own_m2) = (Vec3s::all(f32::INFINITY), F32s::splat(f32::INFINITY));
    for &centre_m in centres_m {
        let other = Vec3s::splat(centre_m) - root_m;
        let other_m2 = other.dot(other);
        let nearer = other_m2.lt(own_m2);
        own = other.select(nearer, own);
        own_m2 = nearer.select(other_m2, own_m2);
    }
    let away = normal * own.dot(normal) - own;
    let mut wall = F32s::splat(f32::INFINITY);
    for &centre_m in centres_m {
        let other = Vec3s::splat(centre_m) - root_m;
        // A point at root + (q − 1)·away is as near to both centres where it passes the plane between them.
        let across = away.dot(other - own);
        let left = (other.dot(other) - own_m2) * 0.5;
        wall = across.gt(F32s::splat(0.0)).select(wall.min(left / across + 1.0), wall);
    }
    wall
}
