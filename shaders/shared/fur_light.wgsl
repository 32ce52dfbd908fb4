// How hair scatters, and how hair above a point shadows it: src/shade/ and src/volume/scene.rs.
#define_import_path furrier::fur_light

#import furrier::constants::{DEEPEST_HAIR, HORIZON, PI}
#import furrier::scene::{scene, Kind}


// Optical depth towards a light through a flat layer with hair area `above` per skin area.
fn slant_depth(above: f32, to_light: vec3<f32>, normal: vec3<f32>, lean: vec3<f32>) -> f32 {
    let along = dot(to_light, lean);
    return min(above * sqrt(max(1.0 - along * along, 0.0)) / max(dot(to_light, normal), HORIZON), DEEPEST_HAIR);
}

// Share of a light that the body lets pass to hair over skin with this normal.
fn terminator(to_light: vec3<f32>, normal: vec3<f32>) -> f32 {
    let x = clamp((dot(to_light, normal) + 0.35) / 0.35, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Optical depth towards the whole sky.
fn sky_depth(above: f32) -> f32 {
    return min(1.5 * 0.25 * PI * above, DEEPEST_HAIR);
}

// The error function within 1.5e-7 (Abramowitz and Stegun 1964, 7.1.26).
fn erf(x: f32) -> f32 {
    let k = 1.0 / (1.0 + 0.3275911 * abs(x));
    let poly = k * (0.254829592 + k * (-0.284496736 + k * (1.421413741 + k * (-1.453152027 + k * 1.061405429))));
    return sign(x) * (1.0 - poly * exp(-x * x));
}

// Hair area of one kind above `height_m` per skin area, where the fields say `density` and `length`.
fn above_height(kind: Kind, density: f32, length: f32, height_m: f32) -> f32 {
    let area_per_m = kind.area_per_m * density;
    let mean_m = kind.height_m * length;
    let spread_m = mean_m * kind.variation;
    let left = mean_m - height_m;
    let z = left / max(spread_m, 1e-9);
    let share = 0.5 * (1.0 + erf(z * 0.70710678));
    let blurred = max(spread_m * 0.3989423 * exp(-0.5 * z * z) + left * share, 0.0);
    return area_per_m * select(blurred, max(left, 0.0), spread_m < 1e-9 || z > 5.0);
}

// Hair area of both kinds above `height_m` per skin area.
fn above_both(density: f32, length: f32, height_m: f32) -> f32 {
    return above_height(scene.guard_kind, density, length, height_m)
        + above_height(scene.undercoat_kind, density, length, height_m);
}
