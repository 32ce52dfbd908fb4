//! Light on guard hair, at the points of its strands.

use super::Look;
use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::math::fast::exp_negative;
use crate::render::pelt::{Layer, Lighting, Pelt, sky_depth, slant_depth, terminator};
use crate::shade::lobes::Lobes;
use crate::shade::{Angles, shadow_power};

/// Shades guard hair. Holds what does not change from hair to hair.
pub struct GuardShader<'a> {
    pelt: Pelt<'a>,
    strands: &'a Strands,
    lighting: &'a Lighting,
    lobes: Lobes<f32>,
    normals: &'a [Vec3],
    eye_m: Vec3,
    albedo_share: f32,
}

impl<'a> GuardShader<'a> {
    /// For the pelt's guard hair; `normals` are the skin's smooth ones.
    ///
    /// # Errors
    /// As [`Lobes::new`].
    pub fn new(
        pelt: Pelt<'a>,
        strands: &'a Strands,
        lighting: &'a Lighting,
        normals: &'a [Vec3],
        eye_m: Vec3,
    ) -> crate::Result<Self> {
        let lobes = Lobes::new(&pelt.hair.guard)?;
        let p = &pelt.hair.guard;
        let albedo_share = (p.tt.albedo + p.trt.albedo + p.diffuse) as f32;
        Ok(Self { pelt, strands, lighting, lobes, normals, eye_m, albedo_share })
    }

    /// Appends the looks of one strand's points, root first.
    pub fn strand(&self, strand: usize, out: &mut Vec<Look>) {
        let (strands, pelt) = (self.strands, &self.pelt);
        let root = strands.roots[strand];
        let corners = pelt.skin.triangles[root.triangle as usize].map(|v| v as usize);
        let b = Vec3::new(root.barycentric[0], root.barycentric[1], 1.0 - root.barycentric[0] - root.barycentric[1]);
        let mix3 = |values: &[Vec3]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
        let mix1 = |values: &[f32]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
        let normal = mix3(self.normals).normalize_or(Vec3::Y);
        let lean = mix3(&pelt.fields.lean).normalize_or(normal);
        let (density, length) = (mix1(&pelt.fields.density), mix1(&pelt.fields.length));
        let layer = |fibre| Layer::new(fibre, density, length);
        let layers = [pelt.guard.map(|(_, fibre)| layer(fibre)), pelt.undercoat.map(layer)];

        let points = strands.points_of_m(strand);
        let rise = lean.dot(normal).max(0.05);
        let last = points.len() - 1;
        for (i, &point) in points.iter().enumerate() {
            let s = i as f32 / last as f32;
            let along = (points[(i + 1).min(last)] - points[i.saturating_sub(1)]).normalize_or(lean);
            // Height along the lean, so that a leaning coat's layers are as thick as its hairs are long.
            let height_m = (point - points[0]).dot(normal) / rise;
            let above = layers.iter().flatten().map(|layer| layer.above(height_m)).sum();
            let albedo = strands.tint[strand] * strands.profile.ramp_at(s);
            let to_eye = (self.eye_m - point).normalize_or(normal);
            out.push(Look { radiance: self.radiance(albedo, along, to_eye, normal, lean, above), albedo });
        }
    }

    fn radiance(&self, albedo: Vec3, along: Vec3, to_eye: Vec3, normal: Vec3, lean: Vec3, above: f32) -> Vec3 {
        let power = (albedo * self.albedo_share).map(shadow_power);
        let through = |depth: f32| (power * -depth).map(exp_negative);
        let mut sum = self.lighting.ambient * albedo * self.albedo_share * through(sky_depth(above));
        for light in std::iter::once(&self.lighting.key).chain(&self.lighting.fill) {
            let open = terminator(light.to_light, normal);
            if open <= 0.0 {
                continue;
            }
            let angles = Angles::of_vectors(along, light.to_light, to_eye);
            let s = self.lobes.scatter(angles);
            let scattered = Vec3::splat(s.plain) + albedo * s.once + albedo * albedo * s.twice;
            let depth = slant_depth(above, light.to_light, normal, lean);
            sum += light.irradiance * scattered * through(depth) * (angles.cos_in() * open);
        }
        sum
    }
}
