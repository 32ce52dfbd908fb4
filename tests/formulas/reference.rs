//! Formulas of the shaders that Rust has no other use for, written down from their equations: f64 where that is shorter.

use furrier::data::coat::GAIN_ANGLES_DEG;
use furrier::data::shell::guards::{LEAST_CLEAR, LEAST_COSINE};
use furrier::math::{DVec2, DVec3, Vec3};
use furrier::shade::fibre::{Fibre, FibreLobe};
use furrier::shade::law::polynomial::LOWEST_LIGHT;
use furrier::shade::law::{FADING, LEAST_ABOVE, MOST_KNOWN, MOST_SLANT};
use furrier::volume::mean;
use furrier::volume::shell::lattice;
use furrier::volume::shell::prism::ShellPoint;
use std::f64::consts::PI;

/// (b₁, b₂, t) moved into the prism.
pub fn inside(at: Vec3) -> Vec3 {
    let b = Vec3::new(1.0 - at.x - at.y, at.x, at.y).max(Vec3::ZERO);
    let b = b / b.element_sum();
    Vec3::new(b.y, b.z, at.z.clamp(0.0, 1.0))
}

/// The side that a line along `rates` passes first, 3 for top and skin, and after how far.
pub fn next_side(place: &ShellPoint, rates: Vec3) -> (f32, f32) {
    let b = place.barycentric();
    let after = |left: f32, rate: f32| if rate < 0.0 { left / -rate } else { f32::INFINITY };
    let sides = [
        after(b.x, -rates.x - rates.y),
        after(b.y, rates.x),
        after(b.z, rates.y),
        after(1.0 - place.t, -rates.z).min(after(place.t, rates.z)),
    ];
    let first = (0..4).min_by(|&i, &j| sides[i].total_cmp(&sides[j])).unwrap_or(3);
    (first as f32, sides[first])
}

/// Optical depths towards the key light at a share of the tips' height: of undercoat, and of other hair. `of_level` gives
/// undercoat's, guard hair's and other limbs' parts at one of a triangle's columns and a level.
pub fn mean_depths(of_level: impl Fn(u32, usize) -> Vec3, b: Vec3, share: f32, linear: bool) -> [f32; 2] {
    let at = share.clamp(0.0, 1.0) * mean::LAYERS as f32;
    let low = (at as usize).min(mean::LAYERS - 1);
    let (corners, weights) = lattice::around(1, b);
    let parts = corners.map(|corner| of_level(corner, low).lerp(of_level(corner, low + 1), at - low as f32));
    let weighted = |of: &dyn Fn(Vec3) -> f32| (0..3).map(|i| of(parts[i]) * weights[i]).sum::<f32>();
    // Depth of the hair around goes linearly, or what it lets through does.
    if linear {
        let other = -weighted(&|p| (-p.z).exp()).ln();
        return [weighted(&|p| p.x), weighted(&|p| p.y) + other];
    }
    let other = -weighted(&|p| (-p.y - p.z).exp()).ln();
    [-weighted(&|p| (-p.x - p.y - p.z).exp()).ln() - other, other]
}

/// How far a ray runs in a slab `slab_m` high that bends away from it by `bend_per_m`: where its height over the bottom, which
/// falls by `steep`, is 0 (found by halving), or where it turns, by `fall`.
pub fn path_through_slab(steep: f64, fall: f64, slab_m: f64, bend_per_m: f64) -> f64 {
    let height_m = |s: f64| slab_m - steep * s + bend_per_m * s * s;
    // Where there is a bottom to meet, it is no farther than twice as far as on a plane.
    let plane_m = 2.0 * slab_m / steep;
    let turn_m = if bend_per_m > 0.0 { plane_m.min(steep / (2.0 * bend_per_m)) } else { plane_m };
    if height_m(turn_m) > 0.0 {
        return fall / (2.0 * bend_per_m);
    }
    let (mut above, mut below) = (0.0, turn_m);
    for _ in 0..80 {
        let middle = 0.5 * (above + below);
        *(if height_m(middle) > 0.0 { &mut above } else { &mut below }) = middle;
    }
    above
}

/// Mean weight max(0, 2|p| − 1) of fins over edges of every direction ψ, p = sin α cos ψ, by sums; from afar at the outline alone.
pub fn fin_share(cos_view: f64, near: f64) -> f64 {
    let sine = (1.0 - cos_view * cos_view).max(0.0).sqrt();
    let n = 4000;
    let weight = |i: usize| (2.0 * (sine * ((i as f64 + 0.5) / n as f64 * PI).cos()).abs() - 1.0).max(0.0);
    (0..n).map(weight).sum::<f64>() / n as f64 * at_outline(cos_view, near)
}

/// How far fins stand for hair, from afar and near by.
pub fn at_outline(cos_view: f64, near: f64) -> f64 {
    let edge = 0.16 * (1.0 - near) + 0.5 * near;
    1.0 - smoothstep(edge, 2.0 * edge, cos_view.abs())
}

/// A fetch: from the first to the last tap, taps, their level, and the level of equal area.
pub struct Footprint {
    /// Up to its sign.
    pub line: DVec2,
    pub taps: f64,
    pub level: f64,
    pub round_level: f64,
    /// Longer over shorter axis.
    pub ratio: f64,
}

/// Of the ellipse Σ x xᵀ over three vectors, on a texture of `size` texels.
pub fn footprint(vectors: [DVec2; 3], size: f64, mips: f64, most_taps: f64) -> Footprint {
    let sum = |of: &dyn Fn(DVec2) -> f64| vectors.iter().map(|&v| of(v)).sum::<f64>();
    let (a, b, c) = (sum(&|v| v.x * v.x), sum(&|v| v.x * v.y), sum(&|v| v.y * v.y));
    let angle = 0.5 * (2.0 * b).atan2(a - c);
    let axis = DVec2::from_angle(angle);
    let along = |d: DVec2| (a * d.x * d.x + 2.0 * b * d.x * d.y + c * d.y * d.y).max(0.0).sqrt();
    let (major, minor) = (along(axis), along(axis.perp()).max(1.0 / size));
    let taps = (major / minor - 1e-3).ceil().clamp(1.0, most_taps);
    let level = |width: f64| (width * size).log2().clamp(0.0, mips - 1.0);
    Footprint {
        line: axis * (major - minor).max(0.0),
        taps,
        level: level(major.max(minor) / taps),
        round_level: level((major.max(minor) * minor).sqrt()),
        ratio: major / minor,
    }
}

/// Gain at an angle in degrees.
pub fn gain(gains: &[f32; 9], degrees: f64) -> f64 {
    let angles = GAIN_ANGLES_DEG.map(f64::from);
    let after = (1..8).find(|&i| degrees <= angles[i]).unwrap_or(8);
    let share = ((degrees - angles[after - 1]) / (angles[after] - angles[after - 1])).clamp(0.0, 1.0);
    f64::from(gains[after - 1]) * (1.0 - share) + f64::from(gains[after]) * share
}

/// How deep in a layer lies what is seen of it, as a share of its thickness: where light leaves it, weighted by what gets out, by sums.
pub fn seen_at(depth: f64) -> f64 {
    let n = 4000;
    let (mut sum, mut weights) = (0.0, 0.0);
    for at in (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)) {
        let weight = (-depth * at).exp();
        sum += weight * at;
        weights += weight;
    }
    sum / weights
}

/// Share of a slab's hair that darkens what lies at its bottom as much as the slab darkens what is seen of it, by sums.
pub fn seen_above(depth: f64, area: f64) -> f64 {
    let n = 4000;
    let (mut sum, mut weights) = (0.0, 0.0);
    for at in (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)) {
        let weight = (-depth * at).exp();
        sum += weight * (-area * at).exp();
        weights += weight;
    }
    -(sum / weights).ln() / area
}

/// Opacity of `amount` times as much hair: that part of it, or as many layers of it.
pub fn thinned(opacity: f64, amount: f64) -> f64 {
    if amount < 1.0 { amount * opacity } else { 1.0 - (1.0 - opacity).max(LEAST_CLEAR.into()).powf(amount) }
}

/// Chapman's function as the shaders have it: [`super::way`] compares it with the integral.
pub fn way_up(rise: f64, bend_per_m: f64, scale_m: f64) -> f64 {
    let bent = bend_per_m.max(0.0) * scale_m;
    let steep = rise.abs();
    let out = 2.0 / (steep + (steep * steep + 16.0 / PI * bent).sqrt()).max(0.04);
    let level = (PI / bent.max(1e-6)).sqrt();
    let through = (steep * steep / (4.0 * bent).max(1e-6)).min(20.0).exp();
    if rise >= 0.0 { out } else { level * through - out }
}

/// Share of a light that comes by the skin to a height above it.
pub fn past_skin(rise: f64, bend_per_m: f64, height_m: f64) -> f64 {
    let sunk_m = rise * rise / (4.0 * bend_per_m).max(1e-6);
    if rise >= 0.0 { 1.0 } else { 1.0 - smoothstep(0.3, 1.0, sunk_m / height_m.max(1e-9)) }
}

/// Light's way through hair that thins out with height, where the coat ends after `border_m`: ∫ e^(−rise s/scale) ds/scale.
pub fn way_to_border(rise: f64, border_m: f64, scale_m: f64) -> f64 {
    let ahead = border_m / scale_m.max(1e-9);
    let up = (ahead * rise).clamp(-20.0, 80.0);
    if up.abs() < 1e-6 { ahead } else { -ahead * (-up).exp_m1() / up }
}

/// Share of a light that comes past the edge of the skin.
pub fn past_border(rise: f64, border_m: f64, height_m: f64) -> f64 {
    1.0 - smoothstep(0.3, 1.0, -rise * border_m / height_m.max(1e-9))
}

/// Smooth step from 0 at `from` to 1 at `to`.
pub fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// 1/cos θ_t by Snell's law, the cosine 0.1 at least.
pub fn crossing(fibre: &Fibre, sine: f32) -> f32 {
    let inside = f64::from(sine) * f64::from(fibre.inverse_index_squared).sqrt();
    (1.0 / (1.0 - inside * inside).sqrt().max(0.1)) as f32
}

/// D of a lobe: its factors times 1, q, q², q³, c, s, sq, sq², sc, over c + w, with q = w/(c + w).
pub fn scale(lobe: &FibreLobe, sine: f32) -> f32 {
    let (s, w) = (f64::from(sine), f64::from(lobe.softness));
    let c = (1.0 - s * s).max(0.0).sqrt();
    let q = w / (c + w);
    let terms = [1.0, q, q * q, q * q * q, c, s, s * q, s * q * q, s * c];
    (terms.iter().zip(lobe.scale).map(|(term, factor)| term * f64::from(factor)).sum::<f64>() / (c + w)) as f32
}

/// Depth that light and eye share, over crowding: 1/(0.18 + 0.735 |sin φ/2| + 20.7 sin² φ/2) + 1.1/cos − 0.65, the light's cosine
/// being 0.2 at least.
pub fn gaps(cos_azimuth: f32, light_normal: f32) -> f32 {
    let half = (0.5 * f64::from(cos_azimuth.clamp(-1.0, 1.0)).acos()).sin();
    (1.0 / (0.18 + 0.735 * half + 20.7 * half * half) + 1.1 / f64::from(light_normal).max(0.2) - 0.65) as f32
}

/// What is left of scattered light by the depth that is more than 1.25 times the hair above, 0.1 at least, on the light's slant.
pub fn beyond(above: f32, depth: f32, light_normal: f32) -> f32 {
    let most = f64::from(above).max(LEAST_ABOVE) * MOST_SLANT
        / ((f64::from(light_normal) - LOWEST_LIGHT).abs() + LOWEST_LIGHT);
    (-FADING * (f64::from(depth) - most.min(MOST_KNOWN)).max(0.0)).exp() as f32
}

/// Radiance of skin: Lambert, and a Blinn-Phong lobe of exponent 60 under Schlick's Fresnel term.
pub fn skin_radiance(albedo: DVec3, normal: DVec3, to_viewer: DVec3, to_light: DVec3, gloss: f64) -> DVec3 {
    let half = (to_light + to_viewer).normalize();
    let fresnel = 0.04 + 0.96 * (1.0 - half.dot(to_viewer).max(0.0)).powi(5);
    let highlight = fresnel * 62.0 / (8.0 * PI) * normal.dot(half).max(0.0).powi(60);
    (albedo / PI + DVec3::splat(gloss * highlight)) * normal.dot(to_light).max(0.0)
}

/// The exponent of the shadow of upright hair on skin, whose 45° is stored.
pub fn skin_slant(cos_light: f64) -> f64 {
    let slope = (1.0 - cos_light * cos_light).max(0.0).sqrt() / cos_light.abs().max(f64::from(LEAST_COSINE));
    slope.max(0.3)
}
