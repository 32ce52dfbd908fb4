//! What a ray sees, and how that adds up to a pixel.

use crate::data::film::Film;
use crate::math::Vec3;

/// What one ray sees; colour-like values are premultiplied by alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// 1 − transmittance.
    pub alpha: f32,
    /// Part of alpha from guard hair.
    pub guard: f32,
    /// Part of alpha from undercoat.
    pub undercoat: f32,
    /// Depth × alpha, m.
    pub depth_m: f32,
    /// Colour × alpha.
    pub albedo: Vec3,
    /// Hair direction × alpha.
    pub tangent: Vec3,
    /// Skin normal × alpha.
    pub normal: Vec3,
}

impl Seen {
    /// Adds another.
    pub fn add(&mut self, other: &Self) {
        self.alpha += other.alpha;
        self.guard += other.guard;
        self.undercoat += other.undercoat;
        self.depth_m += other.depth_m;
        self.albedo += other.albedo;
        self.tangent += other.tangent;
        self.normal += other.normal;
    }

    /// All values times `f`.
    pub fn scaled(self, f: f32) -> Self {
        Self {
            alpha: self.alpha * f,
            guard: self.guard * f,
            undercoat: self.undercoat * f,
            depth_m: self.depth_m * f,
            albedo: self.albedo * f,
            tangent: self.tangent * f,
            normal: self.normal * f,
        }
    }

    /// Writes it into pixel `i` of a film.
    pub fn into_film(self, film: &mut Film, i: usize) {
        film.alpha[i] = self.alpha;
        film.depth_m[i] = if self.alpha > 0.0 { self.depth_m / self.alpha } else { 0.0 };
        film.albedo[i] = self.albedo;
        film.tangent[i] = self.tangent;
        film.normal[i] = self.normal;
        film.guard[i] = self.guard;
        film.undercoat[i] = self.undercoat;
    }
}
