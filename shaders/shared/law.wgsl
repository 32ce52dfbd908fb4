// The law by which fur is lit, as src/shade/fibre/ and src/shade/law/. One scattering is the fibre's own, through the followed
// shadow; all further ones come from the law's terms.
#define_import_path furrier::law

#import furrier::law_constants::{BRIGHTEST, COLOUR_NEAR, DEEPEST_LAW, FADING, LEAST_ABOVE, LEAST_LOG_ABSORPTION, LOWEST_EYE, LOWEST_LIGHT,
    MOST_KNOWN, MOST_LOG_ABSORPTION, MOST_SLANT, SLANT_LEAST, SLANT_MOST, THIN, USUAL}
#import furrier::looks::looks

// Between a hair, light and eye; directions point away from the hair.
struct Angles {
    sin_in: f32,
    sin_out: f32,
    cos_azimuth: f32,
}

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

// A colour per channel, as a fibre wears it: absorption per radius, and the logit of the colour that is reached.
struct Worn {
    absorption: vec3<f32>,
    logit: vec3<f32>,
}

fn worn_of(which: u32, colour: vec3<f32>) -> Worn {
    let darkest = looks[which].rest.z;
    let lightest = looks[which].rest.w;
    let near = COLOUR_NEAR * (lightest - darkest);
    let c = clamp(colour, vec3(darkest + near), vec3(lightest - near));
    let u = log((c - darkest) / (lightest - c));
    let f = looks[which].colouring;
    let powers = f.x + u * (f.y + u * (f.z + u * (f.w + u * looks[which].colouring_last.x)));
    return Worn(exp(clamp(powers, vec3(LEAST_LOG_ABSORPTION), vec3(MOST_LOG_ABSORPTION))), log(c / (1.0 - c)));
}

// N of each lobe, 1/rad.
fn around_hair(which: u32, cos_azimuth: f32) -> vec4<f32> {
    let surface = looks[which].surface;
    let inner = looks[which].inner;
    let glint = looks[which].glint;
    let u = cos_azimuth;
    let half_way = sqrt(max(0.5 * (1.0 + u), 0.0));
    let lost = 1.0 - half_way;
    let lost2 = lost * lost;
    let mirrored = surface.y * half_way * (surface.x + (1.0 - surface.x) * lost2 * lost2 * lost);
    let through = surface.w * exp(-surface.z * max(1.0 + u, 0.0));
    let sine = sqrt(max(1.0 - u * u, 0.0));
    let along = u * glint.x - 1.0;
    let across = sine * glint.y;
    let glints = exp(inner.w * min(along + across, 0.0)) + exp(inner.w * min(along - across, 0.0));
    let medulla = glint.z + u * (glint.w + u * looks[which].rest.x);
    return vec4(mirrored, through, inner.x * half_way + inner.y + inner.z * glints, max(medulla, 0.0));
}

// D of a lobe at an inclination.
fn lobe_scale(lobe_even: vec4<f32>, lobe_odd: vec4<f32>, last: vec4<f32>, sine: f32, cosine: f32) -> f32 {
    let per = 1.0 / (cosine + last.y);
    let q = last.y * per;
    let even = lobe_even.x + q * (lobe_even.y + q * (lobe_even.z + q * lobe_even.w)) + cosine * lobe_odd.x;
    let odd = lobe_odd.y + q * (lobe_odd.z + q * lobe_odd.w) + cosine * last.x;
    return (even + sine * odd) * per;
}

// 1/cos θ_t: by how much longer the way through is on a slant.
fn crossing(which: u32, sine: f32) -> f32 {
    return 1.0 / sqrt(max(1.0 - sine * sine * looks[which].rest.y, 0.01));
}

// What of a hair's light hangs on eye and place alone, whichever light falls on it.
struct Seen {
    which: u32,
    // D of each lobe towards the eye, and how much longer the way out is.
    scales: vec4<f32>,
    crossing: f32,
    // Root of the hair area above.
    x: f32,
    // Sums of the law's terms: of those without a light; of those with the slant; with the light's height; with l·t and its square;
    // with the slant's square.
    plain: vec4<f32>,
    by_slant: vec4<f32>,
    by_height: vec4<f32>,
    by_along: vec4<f32>,
    by_along_squared: vec4<f32>,
    by_slant_squared: vec4<f32>,
}

fn seen_of(which: u32, above: f32, eye_hair: f32, hair_normal: f32, eye_normal: f32) -> Seen {
    let co = cos_of(eye_hair);
    var scales = vec4(0.0);
    for (var i = 0u; i < 4u; i++) {
        scales[i] = lobe_scale(looks[which].lobes[i].even, looks[which].lobes[i].odd, looks[which].lobes[i].last, eye_hair, co);
    }
    let x = sqrt(clamp(above, 1e-4, DEEPEST_LAW));
    let x2 = x * x;
    let q = eye_hair;
    let qq = q * q;
    let ct = hair_normal;
    let cv = clamp(eye_normal, LOWEST_EYE, 1.0);
    var plain = looks[which].light[0];
    plain += looks[which].light[1] * x;
    plain += looks[which].light[3] * x2;
    plain += looks[which].light[10] * (x2 * x);
    plain += looks[which].light[14] * (ct * ct);
    plain += looks[which].light[15] * (x * q * ct);
    let by_slant = looks[which].light[4] * x2 + looks[which].light[7] * x + looks[which].light[8] * cv + looks[which].light[11] * qq;
    let by_height = looks[which].light[2] + looks[which].light[17] * (qq * ct) + looks[which].light[21] * (q * ct);
    let by_along = looks[which].light[6] * q;
    let by_along_squared = looks[which].light[16] * qq + looks[which].light[18];
    let by_slant_squared = looks[which].light[19] * x2;
    return Seen(which, scales, crossing(which, q), x, plain, by_slant, by_height, by_along, by_along_squared, by_slant_squared);
}

// S, 1/sr, per channel.
fn fibre_scatter(seen: Seen, angles: Angles, absorption: vec3<f32>) -> vec3<f32> {
    let which = seen.which;
    let si = angles.sin_in;
    let so = angles.sin_out;
    let ci = cos_of(si);
    let co = cos_of(so);
    let cos_sum = ci * co - si * so;
    let sin_sum = si * co + ci * so;
    let level = sqrt(ci * co);
    let around = around_hair(which, angles.cos_azimuth);
    let way = absorption * (0.5 * (crossing(which, si) + seen.crossing));
    var sum = vec3(0.0);
    for (var i = 0u; i < 4u; i++) {
        let even = looks[which].lobes[i].even;
        let odd = looks[which].lobes[i].odd;
        let last = looks[which].lobes[i].last;
        let tilt = last.z * level;
        let kernel = exp(last.w * min(cos_sum - 1.0 + tilt * (sin_sum - 0.5 * tilt), 0.0));
        let sent = around[i] * lobe_scale(even, odd, last, si, ci) * seen.scales[i] * kernel;
        if i == 0u {
            sum += vec3(sent);
        } else {
            sum += sent * exp(-looks[which].paths[i] * way);
        }
    }
    return sum;
}

// Where a hair stands in a coat, and what lights it.
struct HairPlace {
    // Hair area above per skin area.
    above: f32,
    // Optical depth towards the light.
    depth: f32,
    light_eye: f32,
    hair_normal: f32,
    eye_normal: f32,
    light_normal: f32,
}

// The value for colours of these logits, e^most at most.
fn of_colour(cubic: vec4<f32>, logit: vec3<f32>, most: f32) -> vec3<f32> {
    return exp(min(cubic.x + logit * (cubic.y + logit * (cubic.z + logit * cubic.w)), vec3(most)));
}

// ln of what a hair sends towards the eye per irradiance, of light scattered twice or more: a cubic in the colour's logit.
fn law_light(seen: Seen, place: HairPlace, angles: Angles) -> vec4<f32> {
    let which = seen.which;
    let p = angles.sin_in;
    let k = place.light_eye - p * angles.sin_out;
    let cl = clamp(place.light_normal, LOWEST_LIGHT, 1.0);
    // Where next to nothing lies above, its quotients say nothing.
    let across = (place.depth * cl + THIN * USUAL) / (max(place.above, 0.0) + THIN);
    let slant = clamp(log(max(across, 1e-3)), SLANT_LEAST, SLANT_MOST) - log(cl);
    let slanted = slant * cl;
    var sum = seen.plain + seen.by_slant * slant + seen.by_height * cl + p * (seen.by_along + p * seen.by_along_squared);
    sum += slant * slant * seen.by_slant_squared;
    sum += slanted * (looks[which].light[5] + looks[which].light[9] * cl + looks[which].light[13] * (seen.x * slant));
    sum += looks[which].light[12] * k + looks[which].light[20] * (cl * cl);
    return sum;
}

// ln of what a hair sends towards the eye per radiance of the sky, of all its light.
fn law_sky(which: u32, above: f32, eye_hair: f32, hair_normal: f32, eye_normal: f32) -> vec4<f32> {
    let x = sqrt(clamp(above, 1e-4, DEEPEST_LAW));
    let q = eye_hair;
    let ct = hair_normal;
    let cv = clamp(eye_normal, LOWEST_EYE, 1.0);
    let x2 = x * x;
    let qc = q * ct;
    let cc = ct * cv;
    var sum = looks[which].sky[0];
    sum += looks[which].sky[1] * x;
    sum += looks[which].sky[2] * qc;
    sum += looks[which].sky[3] * x2;
    sum += looks[which].sky[4] * cv;
    sum += looks[which].sky[5] * ct;
    sum += looks[which].sky[6] * (x2 * x * ct);
    sum += looks[which].sky[7] * (cc * cv);
    sum += looks[which].sky[8] * (x * ct * ct);
    sum += looks[which].sky[9] * (x * q * q * q);
    sum += looks[which].sky[10] * (x * qc * cv);
    sum += looks[which].sky[11] * cc;
    return sum;
}

// Optical depth that light and eye share, per hair area per volume and diameter, by the azimuth between them.
fn gaps(cos_azimuth: f32, light_normal: f32) -> f32 {
    let half_sine = sqrt(max(0.5 * (1.0 - cos_azimuth), 0.0));
    let both = 1.0 / (0.18 + half_sine * (0.735 + half_sine * 20.7));
    return both + 1.1 / max(light_normal, 0.2) - 0.65;
}

// What is left of scattered light where more lies before the light than in any slab: the less the further the light is below the
// horizon.
fn beyond(place: HairPlace) -> f32 {
    let level = abs(place.light_normal - LOWEST_LIGHT) + LOWEST_LIGHT;
    let known = min(max(place.above, LEAST_ABOVE) * MOST_SLANT / level, MOST_KNOWN);
    return exp(-FADING * max(place.depth - known, 0.0));
}

// Radiance towards the eye per irradiance of one light; `crowding` is hair area per volume times diameter.
fn lit(seen: Seen, angles: Angles, place: HairPlace, worn: Worn, crowding: f32) -> vec3<f32> {
    let shared_depth = min(crowding * gaps(angles.cos_azimuth, place.light_normal), place.depth);
    let arriving = cos_of(angles.sin_in) * exp(shared_depth - place.depth);
    let multiple = of_colour(law_light(seen, place, angles), worn.logit, BRIGHTEST) * beyond(place);
    return fibre_scatter(seen, angles, worn.absorption) * arriving + multiple;
}

// Radiance towards the eye per radiance of a sky that is everywhere the same.
fn lit_by_sky(which: u32, above: f32, eye_hair: f32, hair_normal: f32, eye_normal: f32, worn: Worn, crowding: f32) -> vec3<f32> {
    let lost = 1.0 / (1.0 + exp(worn.logit));
    let gap_depth = min(crowding * 2.4, above) * lost * lost;
    return of_colour(law_sky(which, above, eye_hair, hair_normal, eye_normal), worn.logit, 0.0) * exp(gap_depth);
}
