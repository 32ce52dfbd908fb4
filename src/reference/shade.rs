//! What a point of hair or skin sends to the eye, in f64: the formulas of `crate::shade` and `crate::volume::scene`, with the
//! key light's optical depth integrated anew for every point.

use super::bvh::DRay;
use super::guard::GuardCones;
use super::light::Arriving;
use super::medium::{Counted, DMedium};
use super::point::DShellPoint;
use super::skin::SkinBvh;
use super::trace::Tracer;
use crate::data::strands::Strands;
use crate::math::{DVec3, Vec3};
use crate::shade::Angles;
use crate::shade::law::{Place, Scattering};
use crate::volume::mean::BLOCKED;
use crate::volume::scene::{self, Above, Lighting, Scene, sky_depth, slant_depth, terminator};
use std::f64::consts::FRAC_1_PI;
use std::sync::atomic::{AtomicU32, Ordering};

/// Optical depth beyond which no light is left.
const DARK: f64 = 12.0;

/// Heights of a segment of guard hair from which its shadow is followed.
const HEIGHTS_PER_SEGMENT: usize = 3;

fn heights_of(strands: &Strands) -> usize {
    (strands.points_per_strand - 1) * HEIGHTS_PER_SEGMENT + 1
}

/// What a point looks like.
#[derive(Clone, Copy, Debug, Default)]
pub struct Appearance {
    /// Radiance, linear RGB.
    pub radiance: DVec3,
    /// Diffuse colour.
    pub albedo: DVec3,
    /// Direction of the hair, or zero.
    pub tangent: DVec3,
    /// Normal of the skin, or zero.
    pub normal: DVec3,
}

/// What stands around a shaded point.
struct Site {
    at_m: DVec3,
    normal: DVec3,
    lean: DVec3,
    /// Hair area above per skin area.
    above: f32,
    /// Optical depth towards the key light.
    key_depth: f64,
    /// Hair area per volume times diameter.
    crowding: f64,
}

/// Shades what rays find.
pub struct Shader<'a> {
    scene: &'a Scene<'a>,
    lighting: &'a Lighting,
    medium: Option<&'a DMedium<'a>>,
    guard: Option<&'a GuardCones<'a>>,
    /// Optical depths towards the key light at heights of guard hairs, as bits of f32; NaN where not asked for yet.
    shadows: Vec<AtomicU32>,
    skin: &'a SkinBvh,
    /// Hair area per volume times diameter of guard hair and undercoat, where the fields are 1.
    crowding: [f32; 2],
    above: Above,
    normals: &'a [Vec3],
}

impl<'a> Shader<'a> {
    /// For a scene.
    pub fn new(scene: &'a Scene<'a>, lighting: &'a Lighting, tracer: &Tracer<'a>, normals: &'a [Vec3]) -> Self {
        let Tracer { skin, guard, medium } = *tracer;
        let heights = guard.map_or(0, |guard| guard.strands().len() * heights_of(guard.strands()));
        Self {
            scene,
            lighting,
            medium,
            skin,
            guard,
            shadows: std::iter::repeat_with(|| AtomicU32::new(f32::NAN.to_bits())).take(heights).collect(),
            crowding: [scene.guard.map(|(_, fibre)| fibre), scene.undercoat]
                .map(|fibre| fibre.map_or(0.0, scene::crowding)),
            above: Above::new([scene.guard.map(|(_, fibre)| fibre), scene.undercoat]),
            normals,
        }
    }

    /// Undercoat at a point, seen along `direction`.
    pub fn undercoat(&self, point: &DShellPoint, direction: DVec3) -> Appearance {
        let Some(medium) = self.medium else { return Appearance::default() };
        let fields = self.scene.fields;
        let ramp = self.scene.undercoat.map_or(Vec3::ONE, |fibre| fibre.profile.ramp_at(point.t as f32));
        let albedo = medium.vector(&fields.tint, point) * ramp.as_dvec3();
        let hair = medium.hair(point);
        let height_m = point.t * self.height_m(point);
        let site = self.site(point, medium.slabs.position_m(point), height_m, hair, self.key_depth(point));
        let site = Site { crowding: f64::from(self.crowding[1]), ..site };
        let look = &self.scene.scattering.undercoat;
        let radiance = self.hair(&site, look, albedo, hair, -direction, self.lighting.fill_on_undercoat);
        Appearance { radiance, albedo, tangent: hair, normal: DVec3::ZERO }
    }

    /// A guard hair at a point along it, in its points.
    pub fn guard(&self, strand: u32, along_strand: f64, direction: DVec3) -> Appearance {
        let Some(guard) = self.guard else { return Appearance::default() };
        let strands = guard.strands();
        let foot = self.foot(strand);
        let points = strands.points_of_m(strand as usize);
        let last = points.len() - 1;
        let segment = (along_strand as usize).min(last - 1);
        let along = along_strand - segment as f64;
        let point = |i: usize| points[i.min(last)].as_dvec3();
        let lean = self.lean(&foot);
        // The hair's direction turns evenly from point to point.
        let at_point = |i: usize| (point(i + 1) - point(i.saturating_sub(1))).normalize_or(lean);
        let tangent = at_point(segment).lerp(at_point(segment + 1), along).normalize_or(lean);
        let height_m = self.height_over(&foot, lean, strand, along_strand);
        let at_m = point(segment).lerp(point(segment + 1), along);
        let site = self.site(&foot, at_m, height_m, lean, self.hair_depth(strand, along_strand));
        let albedo =
            strands.tint[strand as usize].as_dvec3() * strands.profile.ramp_at(guard.s(along_strand) as f32).as_dvec3();
        let density = self.scalar(&self.scene.fields.density, &foot);
        let site = Site { crowding: f64::from(self.crowding[0]) * density, ..site };
        let radiance = self.hair(&site, &self.scene.scattering.guard, albedo, tangent, -direction, true);
        Appearance { radiance, albedo, tangent, normal: DVec3::ZERO }
    }

    /// Skin at a point, seen along `direction`.
    pub fn skin(&self, point: &DShellPoint, direction: DVec3) -> Appearance {
        let outside = self.normal(point);
        let back = direction.dot(outside) > 0.0;
        let normal = if back { -outside } else { outside };
        let lean = self.lean(point);
        let albedo = self.vector(&self.scene.fields.tint, point) * self.scene.skin_factor.as_dvec3();
        let at_m = self.vector(&self.scene.skin.positions_m, point);
        // The back of the skin is bare.
        let site = if back {
            Site { at_m, normal, lean, above: 0.0, key_depth: 0.0, crowding: 0.0 }
        } else {
            self.site(point, at_m, 0.0, lean, self.key_depth(point))
        };
        let mut radiance = self.lighting.ambient.as_dvec3() * albedo * libm::exp(-f64::from(sky_depth(site.above)));
        for (i, light) in self.lighting.all().map(|light| Arriving::new(light, at_m)).enumerate() {
            let cosine = light.to_light.dot(normal);
            if cosine > 0.0 {
                let to_light = light.to_light.as_vec3();
                let open = f64::from(terminator(to_light, normal.as_vec3()));
                let lit = FRAC_1_PI * cosine * open * libm::exp(-self.depth(i, to_light, &site));
                radiance += light.irradiance * albedo * lit;
            }
        }
        Appearance { radiance, albedo, tangent: DVec3::ZERO, normal }
    }

    /// Ambient light and all lights on hair of direction `hair`.
    fn hair(&self, site: &Site, look: &Scattering, albedo: DVec3, hair: DVec3, to_eye: DVec3, fill: bool) -> DVec3 {
        let worn = look.wear(albedo.to_array());
        let (above, normal) = (f64::from(site.above), site.normal);
        let normals = [hair.dot(normal), to_eye.dot(normal)];
        let angles = Angles::of_dvectors(hair, normal, to_eye);
        let place = Place::new(angles, normals[1], above, above, [normals[0], normals[1], normals[1]]);
        let mut sum = self.lighting.ambient.as_dvec3() * DVec3::from(look.sky(&place, &worn, site.crowding));
        let count = if fill { 1 + self.lighting.fill.len() } else { 1 };
        for (i, light) in self.lighting.all().take(count).enumerate() {
            let light = Arriving::new(light, site.at_m);
            let open = if i == 0 { 1.0 } else { f64::from(terminator(light.to_light.as_vec3(), normal.as_vec3())) };
            let to_light = light.to_light.normalize();
            let angles = Angles::of_dvectors(hair, to_light, to_eye);
            let depth = self.depth(i, light.to_light.as_vec3(), site);
            let normals = [normals[0], normals[1], to_light.dot(normal)];
            let place = Place::new(angles, to_light.dot(to_eye), above, depth, normals);
            sum += light.irradiance * DVec3::from(look.light(angles, &place, &worn, site.crowding)) * open;
        }
        sum
    }

    /// Optical depth towards light `i`: the key's, followed through the hair, or that of a flat layer.
    fn depth(&self, i: usize, to_light: Vec3, site: &Site) -> f64 {
        if i == 0 {
            return site.key_depth;
        }
        f64::from(slant_depth(site.above, to_light, site.normal.as_vec3(), site.lean.as_vec3()))
    }

    /// What stands around hair at `at_m`, over a point, `height_m` above the skin.
    fn site(&self, point: &DShellPoint, at_m: DVec3, height_m: f64, lean: DVec3, key_depth: f64) -> Site {
        let fields = self.scene.fields;
        let (density, length) = (self.scalar(&fields.density, point) as f32, self.scalar(&fields.length, point) as f32);
        let above = self.above.at(height_m as f32, density, length);
        Site { at_m, normal: self.normal(point), lean, above, key_depth, crowding: 0.0 }
    }

    /// Optical depth of hair between a point and the key light, up to the first skin.
    fn key_depth(&self, point: &DShellPoint) -> f64 {
        let Some(medium) = self.medium else { return 0.0 };
        let at_m = medium.slabs.position_m(point);
        let Arriving { to_light, distance_m, .. } = Arriving::new(&self.lighting.key, at_m);
        let from_m = 1e-7 * self.height_m(point);
        let ray = DRay::new(at_m, to_light.normalize());
        let to_m = self.skin.meet(&ray, from_m).map_or(f64::INFINITY, |(at_m, _)| at_m);
        let blocked = if to_m < distance_m { f64::from(BLOCKED) } else { 0.0 };
        blocked + medium.depth_along(&ray, from_m, to_m.min(distance_m), Counted::Both, DARK)
    }

    /// The same for a guard hair, which is shadowed as the column over its own root is: a cubic through four heights of it.
    fn hair_depth(&self, strand: u32, along_strand: f64) -> f64 {
        let Some(guard) = self.guard else { return 0.0 };
        let heights = heights_of(guard.strands());
        let at = along_strand * HEIGHTS_PER_SEGMENT as f64;
        let first = (at as usize).saturating_sub(1).min(heights - 4);
        let x = at - first as f64;
        let depth = |i: usize| {
            let cell = &self.shadows[strand as usize * heights + first + i];
            let known = f32::from_bits(cell.load(Ordering::Relaxed));
            if !known.is_nan() {
                return f64::from(known);
            }
            let foot = self.foot(strand);
            let along_strand = (first + i) as f64 / HEIGHTS_PER_SEGMENT as f64;
            let height_m = self.height_over(&foot, self.lean(&foot), strand, along_strand);
            let t = (height_m / self.height_m(&foot)).max(0.0);
            // Whoever comes first finds the same.
            let found = self.key_depth(&DShellPoint { t, ..foot }) as f32;
            cell.store(found.to_bits(), Ordering::Relaxed);
            f64::from(found)
        };
        let weights = [
            -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
            x * (x - 2.0) * (x - 3.0) / 2.0,
            -x * (x - 1.0) * (x - 3.0) / 2.0,
            x * (x - 1.0) * (x - 2.0) / 6.0,
        ];
        (0..4).map(|i| weights[i] * depth(i)).sum::<f64>().max(0.0)
    }

    /// Where a guard hair grows.
    fn foot(&self, strand: u32) -> DShellPoint {
        let root = self.guard.map_or_else(Default::default, |guard| guard.strands().roots[strand as usize]);
        let [u, v] = root.barycentric.map(f64::from);
        DShellPoint { triangle: root.triangle, b: DVec3::new(u, v, 1.0 - u - v), t: 0.0 }
    }

    /// Height of a guard hair over its foot at a point along it, m along the lean.
    fn height_over(&self, foot: &DShellPoint, lean: DVec3, strand: u32, along_strand: f64) -> f64 {
        let Some(guard) = self.guard else { return 0.0 };
        let points = guard.strands().points_of_m(strand as usize);
        let segment = (along_strand as usize).min(points.len() - 2);
        let at = points[segment].as_dvec3().lerp(points[segment + 1].as_dvec3(), along_strand - segment as f64);
        let normal = self.normal(foot);
        (at - points[0].as_dvec3()).dot(normal) / lean.dot(normal).max(0.05)
    }

    fn lean(&self, point: &DShellPoint) -> DVec3 {
        self.vector(&self.scene.fields.lean, point).normalize_or(self.normal(point))
    }

    /// Height of the shell at a point, m along the lean.
    fn height_m(&self, point: &DShellPoint) -> f64 {
        self.medium.map_or(1.0, |medium| medium.slabs.up_m(point).length())
    }

    fn normal(&self, point: &DShellPoint) -> DVec3 {
        self.vector(self.normals, point).normalize_or(DVec3::Y)
    }

    fn scalar(&self, values: &[f32], point: &DShellPoint) -> f64 {
        let v = self.scene.skin.triangles[point.triangle as usize].map(|v| f64::from(values[v as usize]));
        v[0] * point.b.x + v[1] * point.b.y + v[2] * point.b.z
    }

    fn vector(&self, values: &[Vec3], point: &DShellPoint) -> DVec3 {
        let v = self.scene.skin.triangles[point.triangle as usize].map(|v| values[v as usize].as_dvec3());
        v[0] * point.b.x + v[1] * point.b.y + v[2] * point.b.z
    }
}
