//! What a point of hair or skin sends to the eye, in f64: the formulas of `crate::shade` and `crate::render::pelt`, with the
//! key light's optical depth integrated anew for every point.

use super::bvh::Ray;
use super::guard::{Crossing, Guard};
use super::medium::{Counted, Medium};
use super::shell::Place;
use super::skin::Skin;
use crate::data::strands::Strands;
use crate::error::Result;
use crate::math::{DVec3, Vec3};
use crate::render::mean::MeanShadow;
use crate::render::pelt::{Layer, Lighting, Pelt, sky_depth, slant_depth, terminator};
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::lobes::Lobes;
use crate::shade::{Angles, shadow_power};
use std::f64::consts::FRAC_1_PI;

/// Optical depth beyond which no light is left.
const DARK: f64 = 8.0;

/// How the key light's shadow is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadow {
    /// Integrated along the ray to the light.
    Followed,
    /// The renderer's, in the mean: quick, and close enough that the difference hardly varies.
    Mean,
}

/// What a point looks like.
#[derive(Clone, Copy, Debug, Default)]
pub struct Look {
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
    normal: DVec3,
    lean: DVec3,
    /// Hair area above per skin area.
    above: f32,
    /// Optical depth towards the key light.
    key_depth: f64,
}

/// Shades what rays find.
pub struct Shader<'a> {
    pelt: &'a Pelt<'a>,
    lighting: &'a Lighting,
    medium: Option<&'a Medium<'a>>,
    mean: Option<MeanShadow<'a>>,
    skin: &'a Skin,
    lobes: Lobes<f64>,
    undercoat: KajiyaKay<f64>,
    normals: &'a [Vec3],
}

impl<'a> Shader<'a> {
    /// For a pelt.
    ///
    /// # Errors
    /// As [`Lobes::new`].
    pub fn new(
        pelt: &'a Pelt<'a>,
        lighting: &'a Lighting,
        medium: Option<&'a Medium<'a>>,
        skin: &'a Skin,
        normals: &'a [Vec3],
    ) -> Result<Self> {
        let hair = &pelt.hair;
        Ok(Self {
            pelt,
            lighting,
            medium,
            mean: MeanShadow::new(pelt, lighting.key.to_light),
            skin,
            lobes: Lobes::new(&hair.guard)?,
            undercoat: KajiyaKay::new(hair.undercoat_diffuse, hair.undercoat_specular, hair.undercoat_exponent),
            normals,
        })
    }

    /// Undercoat at a place, seen along `direction`.
    pub fn undercoat(&self, place: &Place, direction: DVec3, shadow: Shadow) -> Look {
        let Some(medium) = self.medium else { return Look::default() };
        let fields = self.pelt.fields;
        let ramp = self.pelt.undercoat.map_or(Vec3::ONE, |fibre| fibre.profile.ramp_at(place.t as f32));
        let albedo = medium.vector(&fields.tint, place) * ramp.as_dvec3();
        let hair = medium.hair(place);
        let height_m = place.t * self.height_m(place);
        let site = self.site(place, height_m, hair, shadow);
        let diffuse = albedo * self.pelt.hair.undercoat_diffuse;
        let scattered = |angles: Angles<f64>| {
            let (tinted, plain) = self.undercoat.scatter(angles);
            albedo * tinted + plain
        };
        let fill = self.lighting.fill_on_undercoat;
        let radiance = self.hair(&site, diffuse, hair, -direction, fill, scattered);
        Look { radiance, albedo, tangent: hair, normal: DVec3::ZERO }
    }

    /// A guard hair where a ray enters it.
    pub fn guard(
        &self,
        strands: &Strands,
        guard: &Guard<'_>,
        crossing: &Crossing,
        direction: DVec3,
        shadow: Shadow,
    ) -> Look {
        let strand = crossing.strand as usize;
        let root = strands.roots[strand];
        let [u, v] = root.barycentric.map(f64::from);
        let foot = Place { triangle: root.triangle, b: DVec3::new(u, v, 1.0 - u - v), t: 0.0 };
        let points = strands.points_of_m(strand);
        let last = points.len() - 1;
        let piece = (crossing.knot as usize).min(last - 1);
        let along = crossing.knot - piece as f64;
        let point = |i: usize| points[i.min(last)].as_dvec3();
        let fields = self.pelt.fields;
        let normal = self.normal(&foot);
        let lean = self.vector(&fields.lean, &foot).normalize_or(normal);
        // The hair's direction turns evenly from point to point.
        let at_knot = |i: usize| (point(i + 1) - point(i.saturating_sub(1))).normalize_or(lean);
        let tangent = at_knot(piece).lerp(at_knot(piece + 1), along).normalize_or(lean);
        let at = point(piece).lerp(point(piece + 1), along);
        let height_m = (at - point(0)).dot(normal) / lean.dot(normal).max(0.05);
        // A hair is shadowed as the column over its root is at the same height.
        let column = Place { t: (height_m / self.height_m(&foot)).max(0.0), ..foot };
        let site = self.site(&column, height_m, lean, shadow);
        let albedo = strands.tint[strand].as_dvec3() * strands.profile.ramp_at(guard.s(crossing) as f32).as_dvec3();
        let p = &self.pelt.hair.guard;
        let share = albedo * (p.tt.albedo + p.trt.albedo + p.diffuse);
        let scattered = |angles: Angles<f64>| {
            let s = self.lobes.scatter(angles);
            DVec3::splat(s.plain) + albedo * s.once + albedo * albedo * s.twice
        };
        let radiance = self.hair(&site, share, tangent, -direction, true, scattered);
        Look { radiance, albedo, tangent, normal: DVec3::ZERO }
    }

    /// Skin at a place, seen along `direction`.
    pub fn skin(&self, place: &Place, direction: DVec3, shadow: Shadow) -> Look {
        let outside = self.normal(place);
        let back = direction.dot(outside) > 0.0;
        let normal = if back { -outside } else { outside };
        let fields = self.pelt.fields;
        let lean = self.vector(&fields.lean, place).normalize_or(normal);
        let albedo = self.vector(&fields.tint, place) * self.pelt.skin_factor.as_dvec3();
        // The back of a pelt is bare.
        let site =
            if back { Site { normal, lean, above: 0.0, key_depth: 0.0 } } else { self.site(place, 0.0, lean, shadow) };
        let mut radiance = self.lighting.ambient.as_dvec3() * albedo * libm::exp(-f64::from(sky_depth(site.above)));
        for (i, light) in std::iter::once(&self.lighting.key).chain(&self.lighting.fill).enumerate() {
            let cosine = light.to_light.as_dvec3().dot(normal);
            if cosine > 0.0 {
                let open = f64::from(terminator(light.to_light, normal.as_vec3()));
                let lit = FRAC_1_PI * cosine * open * libm::exp(-self.depth(i, light.to_light, &site));
                radiance += light.irradiance.as_dvec3() * albedo * lit;
            }
        }
        Look { radiance, albedo, tangent: DVec3::ZERO, normal }
    }

    /// Ambient light and all lights on hair of direction `hair`.
    fn hair(
        &self,
        site: &Site,
        share: DVec3,
        hair: DVec3,
        to_eye: DVec3,
        fill: bool,
        scattered: impl Fn(Angles<f64>) -> DVec3,
    ) -> DVec3 {
        let power = DVec3::new(shadow_power(share.x), shadow_power(share.y), shadow_power(share.z));
        let through = |depth: f64| (power * -depth).map(libm::exp);
        let mut sum = self.lighting.ambient.as_dvec3() * share * through(f64::from(sky_depth(site.above)));
        let lights = std::iter::once(&self.lighting.key).chain(self.lighting.fill.iter().filter(|_| fill));
        for (i, light) in lights.enumerate() {
            let open = f64::from(terminator(light.to_light, site.normal.as_vec3()));
            if open <= 0.0 {
                continue;
            }
            let to_light = light.to_light.as_dvec3().normalize();
            let angles = Angles::of_dvectors(hair, to_light, to_eye);
            let depth = self.depth(i, light.to_light, site);
            sum += light.irradiance.as_dvec3() * scattered(angles) * through(depth) * (angles.cos_in() * open);
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

    /// What stands around hair at a place, `height_m` above the skin.
    fn site(&self, place: &Place, height_m: f64, lean: DVec3, shadow: Shadow) -> Site {
        let fields = self.pelt.fields;
        let (density, length) = (self.scalar(&fields.density, place) as f32, self.scalar(&fields.length, place) as f32);
        let above = |fibre| Layer::new(fibre, density, length).above(height_m as f32);
        let own = self.pelt.undercoat.map_or(0.0, above);
        let guard = self.pelt.guard.map_or(0.0, |(_, fibre)| above(fibre));
        let normal = self.normal(place);
        let to_light = self.lighting.key.to_light;
        let lit = terminator(to_light, normal.as_vec3()) > 0.0;
        let key_depth = match (lit, shadow, &self.mean) {
            (false, ..) => 0.0,
            (true, Shadow::Mean, Some(mean)) => {
                f64::from(mean.depth(place.triangle, place.b.as_vec3(), place.t as f32).min(DARK as f32))
            }
            (true, ..) => self.key_depth(place),
        };
        Site { normal, lean, above: own + guard, key_depth }
    }

    /// Optical depth of hair between a place and the key light, up to the first skin.
    fn key_depth(&self, place: &Place) -> f64 {
        let Some(medium) = self.medium else { return 0.0 };
        let from_m = 1e-7 * self.height_m(place);
        let ray = Ray::new(medium.slabs.position_m(place), self.lighting.key.to_light.as_dvec3().normalize());
        let to_m = self.skin.meet(&ray, from_m).map_or(f64::INFINITY, |(at_m, _)| at_m);
        medium.depth_along(&ray, from_m, to_m, Counted::Both, DARK)
    }

    /// Height of the shell at a place, m along the lean.
    fn height_m(&self, place: &Place) -> f64 {
        self.medium.map_or(1.0, |medium| medium.slabs.frame(place).0.length())
    }

    fn normal(&self, place: &Place) -> DVec3 {
        self.vector(self.normals, place).normalize_or(DVec3::Y)
    }

    fn scalar(&self, values: &[f32], place: &Place) -> f64 {
        let v = self.pelt.skin.triangles[place.triangle as usize].map(|v| f64::from(values[v as usize]));
        v[0] * place.b.x + v[1] * place.b.y + v[2] * place.b.z
    }

    fn vector(&self, values: &[Vec3], place: &Place) -> DVec3 {
        let v = self.pelt.skin.triangles[place.triangle as usize].map(|v| values[v as usize].as_dvec3());
        v[0] * place.b.x + v[1] * place.b.y + v[2] * place.b.z
    }
}
