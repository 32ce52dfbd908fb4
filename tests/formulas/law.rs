//! The law by which fur is lit: fibre, colours, what was scattered more than once.

use super::{COUNT, Worst, hold, on_device, on_sphere, open, random, reference};
use crate::scenes;
use furrier::gpu::{Binding, Source, Text};
use furrier::hybrid::gpu::kernels::SHARED;
use furrier::math::{Vec2, Vec3, Vec4};
use furrier::shade::Angles;
use furrier::shade::law::{Place, Scattering, of_colour};

/// Vectors per input.
const INPUTS: usize = 5;
const OUTPUTS: usize = 12;

/// Evaluates the law at what the inputs say.
pub const MAIN: Source = Source {
    path: "formulas/law.wgsl",
    text: Text::Wgsl(
        "
#import furrier::law::{HairPlace, angles_of, cos_of, worn_of, around_hair, lobe_scale, crossing, fibre_scatter, of_colour, law_light,
    law_sky, gaps, beyond, lit, lit_by_sky, seen_of}
#import furrier::looks::looks

@group(1) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let which = id.x % 2u;
    let i = 5u * id.x;
    let hair = inputs[i].xyz;
    let light = inputs[i + 1u].xyz;
    let eye = inputs[i + 2u].xyz;
    let normal = inputs[i + 3u].xyz;
    let colour = inputs[i + 4u].xyz;
    let crowding = inputs[i + 4u].w;
    let angles = angles_of(hair, light, eye);
    let place = HairPlace(inputs[i].w, inputs[i + 1u].w, dot(light, eye), dot(hair, normal), dot(eye, normal), dot(light, normal));
    let worn = worn_of(which, colour);
    let seen = seen_of(which, place.above, angles.sin_out, place.hair_normal, place.eye_normal);
    let lobe = looks[which].lobes[id.x / 2u % 4u];
    let first = 12u * id.x;
    outputs[first] = vec4(angles.sin_in, angles.sin_out, angles.cos_azimuth, cos_of(angles.sin_in));
    outputs[first + 1u] = vec4(log(worn.absorption), crossing(which, angles.sin_in));
    outputs[first + 2u] = vec4(worn.logit, lobe_scale(lobe.even, lobe.odd, lobe.last, angles.sin_in, cos_of(angles.sin_in)));
    outputs[first + 3u] = around_hair(which, angles.cos_azimuth);
    outputs[first + 4u] = vec4(fibre_scatter(seen, angles, worn.absorption), gaps(angles.cos_azimuth, place.light_normal));
    outputs[first + 5u] = law_light(seen, place, angles);
    outputs[first + 6u] = law_sky(which, place.above, angles.sin_out, place.hair_normal, place.eye_normal);
    outputs[first + 7u] = vec4(of_colour(inputs[i + 3u] - vec4(3.0, 0.0, 0.0, 0.0), worn.logit, -1.0), beyond(place));
    outputs[first + 8u] = vec4(lit(seen, angles, place, worn, crowding), 0.0);
    outputs[first + 9u] = vec4(lit_by_sky(which, place.above, angles.sin_out, place.hair_normal, place.eye_normal, worn, 0.3), 0.0);
    outputs[first + 10u] = vec4(looks[which].lobes[3].last.xyz, looks[which].rest.x);
    outputs[first + 11u] = looks[which].paths;
}
",
    ),
};

#[test]
fn shaders_and_rust_agree_on_the_law_of_light() {
    hold(formulas(&SHARED));
}

/// Two looks: the default fibre's; and one by which every bound of the law is met: colours ask for more than the greatest and less
/// than the least absorption, and much is scattered.
pub fn looks() -> [Scattering; 2] {
    let known = scenes::scattering().undercoat;
    let mut other = known;
    other.colouring.factors[1] *= 2.5;
    other.law.light[0][0] += 3.0;
    other.fibre.paths[1] += 0.3;
    other.fibre.azimuth.mirror = 0.1;
    other.fibre.inverse_index_squared = 0.5;
    (other.fibre.azimuth.inner_cosine, other.fibre.azimuth.inner_even) = (0.1, 0.02);
    other.fibre.lobes[3].tilt = 0.03;
    [known, other]
}

/// Compares all; gives what is off.
pub fn formulas(shared: &[Source]) -> Vec<String> {
    let looks = looks();
    let chance = random(INPUTS, 13);
    let sphere = |u: Vec4| on_sphere(Vec2::new(u.x, u.y));
    let mut inputs = Vec::new();
    for (i, u) in chance.chunks_exact(INPUTS).enumerate() {
        // Near and far, from nothing to more than any slab.
        let above = if i % 16 == 3 { 0.05 * u[0].z } else { 20.0 * u[0].z * u[0].z };
        let slant = (6.0 * u[1].z - 3.0).exp();
        let light = if i % 32 == 5 { sphere(u[2]) } else { sphere(u[1]) };
        let normal = sphere(u[3]);
        inputs.extend([
            sphere(u[0]).extend(above),
            light.extend(above * slant),
            sphere(u[2]).extend(0.0),
            normal.extend(u[3].w),
            (u[4].truncate() * 1.1 - 0.05).extend(0.1 * u[4].w),
        ]);
    }
    let gpu = open();
    let packed = looks.map(|look| look.packed());
    // The scene's own buffers are not looked at.
    let nothing = || gpu.buffer("nothing", &[Vec4::ZERO], wgpu::BufferUsages::UNIFORM);
    let mut buffers: Vec<_> = (0..8).map(|_| nothing()).collect();
    buffers.push(gpu.buffer("looks", &packed, wgpu::BufferUsages::STORAGE));
    let bindings: Vec<_> = (0..9).map(|i| if i < 8 { Binding::Uniform } else { Binding::Read }).collect();
    let outputs = on_device(&gpu, shared, MAIN, &[(&bindings, buffers)], &inputs, OUTPUTS);

    // Sums of many terms, and exponentials of them, are further apart by rounding.
    let (mut worst, mut rough) = (Worst::default(), Worst::default());
    for i in 0..COUNT {
        let (given, out) = (&inputs[INPUTS * i..][..INPUTS], &outputs[OUTPUTS * i..][..OUTPUTS]);
        let look = &looks[i % 2];
        let [hair, light, eye, normal, colour] = [0, 1, 2, 3, 4].map(|k| given[k].truncate());
        let angles = Angles::new(hair.dot(light), hair.dot(eye), light.dot(eye));
        let (above, depth, crowding) = (given[0].w, given[1].w, given[4].w);
        let normals = [hair.dot(normal), eye.dot(normal), light.dot(normal)];
        let place = Place::new(angles, light.dot(eye), above, depth, normals);
        let worn = look.wear(colour.to_array());
        let lit = look.fibre.lit(angles);
        worst.note(i, "sine of light", out[0].x, angles.sin_in);
        worst.note(i, "sine of the eye", out[0].y, angles.sin_out);
        worst.note(i, "cosine of a sine", out[0].w, angles.cos_in());
        worst.note(i, "way through", out[1].w, reference::crossing(&look.fibre, angles.sin_in));
        for k in 0..3 {
            worst.note(i, "ln of absorption", out[1][k], worn[k].absorption.ln());
            worst.note(i, "logit", out[2][k], worn[k].logit);
        }
        let lobe = &look.fibre.lobes[i / 2 % 4];
        worst.note(i, "D", out[2].w, reference::scale(lobe, angles.sin_in));
        // Given as numbers: which of a look's numbers is which.
        let last = &look.fibre.lobes[3];
        assert_eq!(out[10], Vec4::new(last.scale[8], last.softness, last.tilt, look.fibre.azimuth.medulla[2]));
        assert_eq!(out[11].to_array(), look.fibre.paths);
        let cubic = given[3] - Vec4::new(3.0, 0.0, 0.0, 0.0);
        let of = worn.map(|worn| of_colour(cubic.to_array(), worn.logit, -1.0));
        worst.note_all(i, "of a colour", out[7].truncate(), of.into());
        worst.note(i, "beyond any slab", out[7].w, reference::beyond(above, depth, normals[2]));
        let (multiple, sky) = (look.law.multiple(&place), look.law.sky(&place));
        for k in 0..4 {
            rough.note(i, "ln of what was scattered before", out[5][k], multiple[k]);
            rough.note(i, "ln of light of the sky", out[6][k], sky[k]);
        }
        rough.note_all(i, "lit by the sky", out[9].truncate(), look.sky(&place, &worn, 0.3).into());
        // Where hair, light and eye are nearly in line, the azimuth is a quotient of roundings.
        if angles.sin_in.abs().max(angles.sin_out.abs()) < 0.999 {
            worst.note(i, "azimuth", out[0].z, angles.cos_azimuth);
            let around = look.fibre.azimuth.at(angles.cos_azimuth);
            (0..4).for_each(|k| worst.note(i, "around the hair", out[3][k], around[k]));
            rough.note(i, "shared depth", out[4].w, reference::gaps(angles.cos_azimuth, normals[2]));
            let through = worn.map(|worn| lit.through(worn.absorption));
            rough.note_all(i, "scattered", out[4].truncate(), through.into());
            let sent = look.light(angles, &place, &worn, crowding);
            rough.note_all(i, "lit", out[8].truncate(), Vec3::from(sent));
        }
    }
    [worst.faults(1e-4), rough.faults(5e-4)].concat()
}
