//! Light on guard hair, at some places along each strand.

use super::strands::{LIT_POINTS, lit_point_s};
use crate::data::strands::Strands;
use crate::hybrid::prepared::Prepared;
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Row, Vec3Row, Vec3s};
use crate::shade::Angles;
use crate::shade::law::Place;
use crate::volume::march::content::Content;
use crate::volume::march::shadows::Shadows;
use crate::volume::mean::MeanShadow;
use crate::volume::scene::{self, ramps, slant_depths, terminators};
use crate::volume::shell::lattice::Lattices;
use rayon::prelude::*;

/// Shades guard hair. Holds what does not change from hair to hair.
pub struct GuardShader<'a> {
    prepared: &'a Prepared<'a>,
    strands: &'a Strands,
    shadows: Option<&'a Shadows<'a>>,
    eye_m: Vec3,
    /// Hair area per volume times diameter, where the fields are 1.
    crowding: f32,
    /// Where strands are lit.
    sites: Vec<LitPoint>,
}

/// Where on a strand it is lit.
struct LitPoint {
    /// Along the strand, in [0, 1].
    s: f32,
    segment: usize,
    /// Along the segment, in [0, 1].
    along: f32,
}

/// The column over a hair's root: hair is shadowed as it is at the same height.
struct Column<'a> {
    triangle: u32,
    b: Vec3,
    /// The shadow in the mean, and its share of the tips per height, 1/m.
    mean: Option<(&'a MeanShadow<'a>, f32)>,
    /// Beside an open border, where clumps are seen from their sides: the shadow with clumps up to undercoat's top, and t per
    /// height, 1/m.
    clumped: Option<(&'a Content<'a>, f32, Lattices<'a>)>,
}

impl Column<'_> {
    /// Optical depths towards the key light.
    #[inline(always)]
    fn depths<I: Isa>(&self, height_m: F32s<I>) -> F32s<I> {
        let mean = match self.mean {
            Some((shadow, share_per_m)) => {
                let [undercoat, other] = shadow.at(self.triangle, self.b, height_m * share_per_m);
                undercoat + other
            }
            None => F32s::splat(0.0),
        };
        let Some((content, t_per_m, lattices)) = &self.clumped else { return mean };
        let t = height_m * *t_per_m;
        let inside = !t.gt(F32s::splat(1.0));
        inside.select(lattices.at(Vec3s::splat(self.b), content.level(t.within(0.0, 1.0))), mean)
    }
}

impl<'a> GuardShader<'a> {
    /// For the guard hair `strands`, seen from `eye_m`.
    pub fn new(
        prepared: &'a Prepared<'a>,
        strands: &'a Strands,
        shadows: Option<&'a Shadows<'a>>,
        eye_m: Vec3,
    ) -> Self {
        let scene = &prepared.scene;
        let last = (strands.points_per_strand - 1) as f32;
        let site = |i: usize| {
            let s = lit_point_s(i);
            let segment = ((s * last) as usize).min(strands.points_per_strand - 2);
            LitPoint { s, segment, along: s * last - segment as f32 }
        };
        let sites = (0..LIT_POINTS).map(site).collect();
        let crowding = scene.guard.map_or(0.0, |(_, fibre)| scene::crowding(fibre));
        Self { prepared, strands, shadows, eye_m, crowding, sites }
    }

    /// Fills the stored shadow that strands beside open borders are lit by, prism by prism: strands of one prism, asking for it
    /// side by side, would wait for each other.
    pub fn prepare(&self, strands: &[u32]) {
        let Some(shadows) = self.shadows else { return };
        let at_border = |&triangle: &u32| shadows.volume.shell().neighbours.at_border(triangle);
        let roots = strands.par_iter().map(|&strand| self.strands.roots[strand as usize].triangle);
        let mut triangles: Vec<u32> = roots.filter(at_border).collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles.par_iter().with_max_len(1).for_each(|&triangle| {
            shadows.lattice(triangle);
        });
    }

    /// Radiance at the lit points of some strands, root first, into `out`, a row for each.
    pub fn strands(&self, strands: &[u32], out: &mut [Vec3Row]) {
        lanes::run(Shade { shader: self, strands, out });
    }

    #[inline(always)]
    fn strand<I: Isa>(&self, strand: usize) -> Vec3Row {
        let (strands, scene) = (self.strands, &self.prepared.scene);
        let root = strands.roots[strand];
        let corners = scene.skin.triangles[root.triangle as usize].map(|v| v as usize);
        let b = Vec3::new(root.barycentric[0], root.barycentric[1], 1.0 - root.barycentric[0] - root.barycentric[1]);
        let mix3 = |values: &[Vec3]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
        let mix1 = |values: &[f32]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
        let normal = mix3(&self.prepared.normals).normalize_or(Vec3::Y);
        let lean = mix3(&scene.fields.lean).normalize_or(normal);
        let (density, length) = (mix1(&scene.fields.density), mix1(&scene.fields.length));
        // Height along the lean, so that a leaning coat's layers are as thick as its hairs are long.
        let rise = lean.dot(normal).max(0.05);

        let points = strands.points_of_m(strand);
        let last = points.len() - 1;
        let column = self.column(root.triangle, b, rise, length);
        let point = |i: usize| points[i.min(last)];
        // The hair's direction turns evenly from point to point.
        let turn = |i: usize| if i == 0 || i >= last { 2.0 } else { 1.0 };
        let step = |i: usize| (point(i + 1) - point(i.saturating_sub(1))) * turn(i);
        let mut lit = [Vec3::ZERO; LIT_POINTS];
        for first in (0..self.sites.len()).step_by(I::LANES) {
            let count = I::LANES.min(self.sites.len() - first);
            let (mut at_m, mut along, mut s) = (Vec3Row::default(), Vec3Row::default(), Row::default());
            for (lane, site) in self.sites[first..first + count].iter().enumerate() {
                at_m.set(lane, point(site.segment).lerp(point(site.segment + 1), site.along));
                along.set(lane, step(site.segment).lerp(step(site.segment + 1), site.along));
                s.0[lane] = site.s;
            }
            let at_m = Vec3s::<I>::of(&at_m);
            let height_m = (at_m - Vec3s::splat(points[0])).dot(Vec3s::splat(normal));
            let normal = Vec3s::splat(normal);
            let site = GuardSite {
                at_m,
                albedo: self.ramp(F32s::of(&s)).times(Vec3s::splat(strands.tint[strand])),
                hair: Vec3s::of(&along).normalized_or(Vec3s::splat(lean)),
                to_eye: (Vec3s::splat(self.eye_m) - at_m).normalized_or(normal),
                normal,
                lean: Vec3s::splat(lean),
                above: self.prepared.above.at_lanes(height_m * (1.0 / rise), density, length),
                key_depth: column.depths(height_m),
                crowding: self.crowding * density,
            };
            let Vec3s { x, y, z } = self.radiance(&site);
            let log_radiance = Vec3s::new(log(x), log(y), log(z)).rows();
            for (lane, lit) in lit[first..first + count].iter_mut().enumerate() {
                *lit = log_radiance.lane(lane);
            }
        }
        let mut row = Vec3Row::default();
        lit.iter().enumerate().for_each(|(i, &lit)| row.set(i, lit));
        row
    }

    fn column(&self, triangle: u32, b: Vec3, rise: f32, length: f32) -> Column<'a> {
        let shadows = self.shadows.filter(|shadows| shadows.volume.shell().neighbours.at_border(triangle));
        let clumped = shadows.map(|shadows| {
            let (volume, lattice) = (shadows.volume, shadows.lattice(triangle));
            let mut lattices = Lattices::new(volume.layers());
            (0..MOST).for_each(|lane| lattices.set(lane, lattice));
            (volume.content, 1.0 / (rise * volume.shell().undercoat.height_m * length.max(1e-3)), lattices)
        });
        let mean = self.prepared.mean.as_ref().map(|mean| (mean, mean.share(1.0 / rise, length)));
        Column { triangle, b, mean, clumped }
    }

    #[inline(always)]
    fn radiance<I: Isa>(&self, site: &GuardSite<I>) -> Vec3s<I> {
        let hair = &self.prepared.scene.scattering.guard;
        let Vec3s { x, y, z } = site.albedo;
        let worn = hair.wear([x, y, z]);
        let normals = [site.hair.dot(site.normal), site.to_eye.dot(site.normal)];
        let lighting = self.prepared.lighting;
        let mut sum = Vec3s::splat(Vec3::ZERO);
        let crowding = F32s::splat(site.crowding);
        for (i, light) in lighting.all().enumerate() {
            let (to_light, irradiance) = light.at_lanes(site.at_m);
            let angles = Angles::of_lanes(site.hair, to_light, site.to_eye);
            let (depth, open) = match i {
                0 => (site.key_depth, F32s::splat(1.0)),
                _ => (slant_depths(site.above, to_light, site.normal, site.lean), terminators(to_light, site.normal)),
            };
            let normals = [normals[0], normals[1], to_light.dot(site.normal)];
            let place = Place::new(angles, to_light.dot(site.to_eye), site.above, depth, normals);
            let [x, y, z] = hair.light(angles, &place, &worn, crowding);
            sum = sum + Vec3s::new(x, y, z).times(irradiance * open);
        }
        if lighting.ambient != Vec3::ZERO {
            let angles = Angles::of_lanes(site.hair, site.normal, site.to_eye);
            let place = Place::new(angles, normals[1], site.above, site.above, [normals[0], normals[1], normals[1]]);
            let [x, y, z] = hair.sky(&place, &worn, crowding);
            sum = sum + Vec3s::new(x, y, z).times(Vec3s::splat(lighting.ambient));
        }
        sum
    }

    /// Colour factors along the hair.
    #[inline(always)]
    fn ramp<I: Isa>(&self, s: F32s<I>) -> Vec3s<I> {
        ramps(&self.strands.profile.ramp, s)
    }
}

/// Natural logarithm; of nothing, one whose power is nothing again.
#[inline(always)]
fn log<I: Isa>(radiance: F32s<I>) -> F32s<I> {
    radiance.max(F32s::splat(f32::MIN_POSITIVE)).log2() * std::f32::consts::LN_2
}

/// Shades some strands.
struct Shade<'a, 'o> {
    shader: &'a GuardShader<'a>,
    strands: &'a [u32],
    out: &'o mut [Vec3Row],
}

impl lanes::Work for Shade<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(self) {
        for (&strand, out) in self.strands.iter().zip(self.out) {
            *out = self.shader.strand::<I>(strand as usize);
        }
    }
}

/// Points of a hair to be lit.
struct GuardSite<I: Isa> {
    at_m: Vec3s<I>,
    albedo: Vec3s<I>,
    hair: Vec3s<I>,
    to_eye: Vec3s<I>,
    normal: Vec3s<I>,
    lean: Vec3s<I>,
    /// Hair area above per skin area.
    above: F32s<I>,
    /// Optical depth towards the key light.
    key_depth: F32s<I>,
    /// Hair area per volume times diameter.
    crowding: f32,
}
