//! What the renderer fills: linear, with alpha, one array per layer.

use crate::math::Vec3;

/// Which layers of a film are filled: each costs memory, 64 bytes per pixel in all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// Radiance and alpha, 16 bytes per pixel: what an eight-bit picture shows.
    Light,
    /// Those and distance, 20 bytes per pixel: what a lens needs.
    LightAndDepth,
    /// All.
    #[default]
    All,
}

/// An image with the layers a bake and an EXR need; every array has `width * height` entries, rows from the top, or none
/// where its layer was not asked for.
///
/// Colour-like layers (`radiance`, `albedo`, `tangent`, `normal`) are premultiplied by `alpha`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Light towards the eye, linear RGB.
    pub radiance: Vec<Vec3>,
    /// Coverage in [0, 1]: 1 − transmittance.
    pub alpha: Vec<f32>,
    /// Mean distance along the ray of what was hit, weighted as alpha, m; 0 where alpha is 0.
    pub depth_m: Vec<f32>,
    /// Diffuse colour of what was hit, linear RGB.
    pub albedo: Vec<Vec3>,
    /// Hair direction root to tip.
    pub tangent: Vec<Vec3>,
    /// Skin normal where skin was hit, else zero.
    pub normal: Vec<Vec3>,
    /// The part of alpha that guard hair gave.
    pub guard: Vec<f32>,
    /// The part of alpha that undercoat gave.
    pub undercoat: Vec<f32>,
}

impl Film {
    /// A film of zeros with all layers.
    pub fn new(width: usize, height: usize) -> Self {
        Self::of_layers(width, height, Layers::All)
    }

    /// A film of zeros.
    pub fn of_layers(width: usize, height: usize, layers: Layers) -> Self {
        let n = width * height;
        let depth = if layers == Layers::Light { 0 } else { n };
        let all = if layers == Layers::All { n } else { 0 };
        Self {
            width,
            height,
            radiance: bytemuck::zeroed_vec(n),
            alpha: vec![0.0; n],
            depth_m: vec![0.0; depth],
            albedo: bytemuck::zeroed_vec(all),
            tangent: bytemuck::zeroed_vec(all),
            normal: bytemuck::zeroed_vec(all),
            guard: vec![0.0; all],
            undercoat: vec![0.0; all],
        }
    }

    /// Coverage: mean alpha.
    pub fn coverage(&self) -> f64 {
        self.alpha.iter().map(|&a| f64::from(a)).sum::<f64>() / self.alpha.len().max(1) as f64
    }
}
