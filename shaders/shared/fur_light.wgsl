// How hair scatters, and how hair above a point shadows it: src/shade/ and src/volume/scene.rs.
#define_import_path furrier::fur_light

#import furrier::constants::{DEEPEST_HAIR, HORIZON, PI}
#import furrier::scene::{scene, Kind}


// Between a hair, light and eye; directions point away from the hair.
struct Angles {
    sin_in: f32,
    sin_out: f32,
    cos_azimuth: f32,
}

// S, 1/sr, by how often the hair's colour tints it: not, once, twice.
fn angles_of(hair: vec3<f32>, to_light: vec3<f32>, to_eye: vec3<f32>) -> Angles {
    let sin_in = clamp(dot(hair, to_light), -1.0, 1.0);
    let sin_out = clamp(dot(hair, to_eye), -1.0, 1.0);
    let across = sqrt(max((1.0 - sin_in * sin_in) * (1.0 - sin_out * sin_out), 0.0));
    let azimuth = clamp((dot(to_light, to_eye) - sin_in * sin_out) / max(across, 1e-6), -1.0, 1.0);
    return Angles(sin_in, sin_out, select(0.0, azimuth, across > 1e-6));
}

fn cos_of(sine: f32) -> f32 {
    return sqrt(max(1.0 - sine * sine, 0.0));
}

// Kajiya and Kay 1989: (factor of the hair's colour, untinted rest).
fn kajiya_kay(angles: Angles) -> vec2<f32> {
    let mirror = cos_of(angles.sin_in) * cos_of(angles.sin_out) - angles.sin_in * angles.sin_out;
    let highlight = select(0.0, pow(max(mirror, 1e-30), scene.undercoat_exponent), mirror > 0.0);
    return vec2(scene.undercoat_diffuse, scene.undercoat_specular * highlight);
}

fn lobe_along(index: u32, half_rad: f32) -> f32 {
    let x = half_rad - scene.lobes[index].shift_rad;
    return scene.lobes[index].albedo * exp(scene.lobes[index].scale * x * x);
}

// Arc cosine within 2e-8 (Abramowitz and Stegun 1964, 4.4.46): what drivers give is off by a thousandth.
fn arc_cosine(cosine: f32) -> f32 {
    let x = min(abs(cosine), 1.0);
    var sum = 0.00667009 - 0.0012624911 * x;
    sum = sum * x - 0.017088126;
    sum = sum * x + 0.03089188;
    sum = sum * x - 0.050174303;
    sum = sum * x + 0.08897899;
    sum = sum * x - 0.2145988;
    sum = sum * x + 1.5707963;
    let right = sqrt(1.0 - x) * sum;
    return select(right, PI - right, cosine < 0.0);
}

// Cosine of an angle in [-π, π]: 1 - 2 sin²(x/2), sin by its Taylor polynomial.
fn cosine_of(angle_rad: f32) -> f32 {
    let x = 0.5 * angle_rad;
    let square = x * x;
    var sum = 1.0 / 362880.0 - square / 39916800.0;
    sum = sum * square - 1.0 / 5040.0;
    sum = sum * square + 1.0 / 120.0;
    sum = sum * square - 1.0 / 6.0;
    let sine = x * (sum * square + 1.0);
    return 1.0 - 2.0 * sine * sine;
}

// The lobes of Sadeghi et al. 2010: (not tinted, tinted once, tinted twice).
fn guard_lobes(angles: Angles) -> vec3<f32> {
    let theta_in = 0.5 * PI - arc_cosine(angles.sin_in);
    let theta_out = 0.5 * PI - arc_cosine(angles.sin_out);
    let half_rad = 0.5 * (theta_in + theta_out);
    let cos_difference = max(cosine_of(0.5 * (theta_in - theta_out)), 1e-3);
    let spread = 1.0 / (cos_difference * cos_difference);
    let azimuth_rad = arc_cosine(angles.cos_azimuth);
    let surround = sqrt(max(0.5 * (1.0 + angles.cos_azimuth), 0.0)) * scene.surround_norm;
    let behind = PI - azimuth_rad;
    let beside = azimuth_rad - scene.glint_angle_rad;
    let glint = exp(scene.glint_scale * beside * beside) * scene.glint_norm;
    let through = exp(scene.tt_azimuth_scale * behind * behind) * scene.tt_norm;
    return vec3(
        lobe_along(0u, half_rad) * spread * surround,
        lobe_along(1u, half_rad) * spread * through + scene.guard_diffuse,
        lobe_along(2u, half_rad) * spread * (surround + scene.glint * (glint - surround)),
    );
}

// The power to which a transmittance towards the light is raised, per channel of the hair's albedo.
fn shadow_power(albedo: vec3<f32>) -> vec3<f32> {
    return sqrt(clamp(1.0 - albedo, vec3(0.0), vec3(1.0)));
}

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
