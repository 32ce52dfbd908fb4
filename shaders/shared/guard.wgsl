// Guard hair: its profile and its fragments, as src/data/strands.rs and src/hybrid/strands/.
#define_import_path furrier::guard

#import furrier::scene::{scene, Strand}

// Barycentric coordinates of a strand's root.
fn root_of(strand: Strand) -> vec3<f32> {
    return vec3(strand.b, 1.0 - strand.b.x - strand.b.y);
}

// Colour factor at s in [0, 1] along the hair.
fn guard_ramp(s: f32) -> vec3<f32> {
    let ramp = scene.guard_ramp;
    return select(mix(ramp[1].xyz, ramp[2].xyz, 2.0 * s - 1.0), mix(ramp[0].xyz, ramp[1].xyz, 2.0 * s), s < 0.5);
}

// The hair's own opacity at s in [0, 1].
fn opacity_at(s: f32) -> f32 {
    let k = scene.tip_exponent;
    let faded = scene.tip_transparency * (exp(k * s) - 1.0) / (exp(k) - 1.0);
    return select(1.0 - faded, 1.0, scene.tip_transparency == 0.0);
}

// Radius over root radius at s in [0, 1].
fn radius_factor(s: f32) -> f32 {
    return 1.0 + (scene.taper - 1.0) * s;
}

// How far along its hair a place `along` the segment from `point` on lies, in [0, 1].
fn along_hair(point: u32, along: f32) -> f32 {
    return (f32(point % scene.points_per_strand) + along) / f32(scene.points_per_strand - 1u);
}
