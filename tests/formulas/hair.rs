//! Light in hair, noise, hashes, packing: what the kernels know of one hair or one layer.

use super::{COUNT, Worst, hold, on_device, on_sphere, open, random};
use crate::lanes::simplex;
use crate::scenes::{self, Grown};
use furrier::data::light::{Directional, Light, Point, Spot};
use furrier::fur::undercoat::{Pattern, Undercoat};
use furrier::gpu::{Binding, Source, Text};
use furrier::hybrid::Settings;
use furrier::hybrid::gpu::kernels::SHARED;
use furrier::hybrid::gpu::layout::SceneUniform;
use furrier::math::hash::{combine, unit_f32};
use furrier::math::{Vec2, Vec3, Vec4};
use furrier::volume::scene::{Above, sky_depth, slant_depth, terminator};
use furrier::volume::shell::block::{LARGEST, code};
use furrier::volume::shell::subelement;

/// Vectors per input.
const OUTPUTS: usize = 12;

/// Evaluates everything at inputs of eight numbers in [0, 1).
pub const MAIN: Source = Source {
    path: "formulas/hair.wgsl",
    text: Text::Wgsl(
        "
#import furrier::scene::{scene, Strand}
#import furrier::fur_light::{slant_depth, sky_depth, terminator}
#import furrier::light::{Light, light_at}
#import furrier::noise::simplex
#import furrier::hash::{combine, unit, wide_of}
#import furrier::prism::{subelement, subelement_centre}
#import furrier::guard::{opacity_at, guard_ramp, radius_factor, along_hair, root_of}
#import furrier::undercoat::{mean_sine, code_value, decode_value}
#import furrier::undercoat_light::undercoat_ramp
#import furrier::virtual_fragment::{pack_faces, unpack_albedo, unpack_tangent}

@group(1) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

fn on_sphere(u: vec2<f32>) -> vec3<f32> {
    let z = 2.0 * u.x - 1.0;
    let r = sqrt(max(1.0 - z * z, 0.0));
    return vec3(r * cos(6.2831853 * u.y), r * sin(6.2831853 * u.y), z);
}

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    let a = inputs[2u * i];
    let b = inputs[2u * i + 1u];
    let hair = on_sphere(a.xy);
    let light = on_sphere(a.zw);
    let eye = on_sphere(b.xy);
    let first = 12u * i;
    outputs[first] = vec4(terminator(light, eye), sky_depth(b.z), along_hair(u32(100.0 * b.x), b.y), 0.0);
    outputs[first + 2u] = vec4(
        0.0,
        0.0,
        slant_depth(b.z, light, eye, hair),
        opacity_at(b.w),
    );
    let p = 40.0 * (a.xyz - 0.5);
    outputs[first + 3u] = vec4(simplex(p, 0u), simplex(p, 1u), 0.0, 0.0);
    let cell = vec3<i32>(floor(2000.0 * (b.xyz - 0.5)));
    let key = combine(combine(combine(vec2(0u), wide_of(cell.x)), wide_of(cell.y)), wide_of(cell.z));
    outputs[first + 4u] = vec4(unit(key), unit(combine(key, vec2(1u, 0u))), 0.0, radius_factor(b.w));
    let d = u32(b.w * 8.0);
    let element = min(u32(a.w * f32(1u << (2u * d))), (1u << (2u * d)) - 1u);
    let centre = subelement_centre(element, d);
    outputs[first + 5u] = vec4(centre, f32(subelement(centre, d)));
    outputs[first + 6u] = vec4(guard_ramp(b.w), mean_sine(b.x));
    outputs[first + 8u] = vec4(undercoat_ramp(b.w), decode_value(u32(256.0 * b.x)));
    let packed = pack_faces(a.xyz, 2.0 * b.xyz - 1.0);
    outputs[first + 9u] = vec4(unpack_albedo(packed), f32(code_value(20.0 * b.x - 2.0)));
    outputs[first + 10u] = vec4(unpack_tangent(packed), 0.0);
    let cone_scale = 1.0 / (0.05 + 0.2 * b.w);
    let lamp = Light(
        a.xyz - 0.5, a.w, vec3(1.0, 2.0, 3.0), select(1.0, 0.0, i % 8u == 0u), eye, cone_scale, 1.0 - cone_scale * b.z,
    );
    let arriving = light_at(lamp, 0.3 * vec3(b.z, b.w, -b.z));
    outputs[first + 11u] = vec4(root_of(Strand(vec3(0.0), 0u, 0.5 * a.xy, 0u, 0.0)), 0.0);
    outputs[first + 1u] = vec4(arriving.to_light, 0.0);
    outputs[first + 7u] = vec4(arriving.irradiance, 0.0);
}
",
    ),
};

#[test]
fn shaders_and_rust_agree_on_light_in_hair() {
    hold(formulas(&SHARED));
}

/// Compares all; gives what is off.
pub fn formulas(shared: &[Source]) -> Vec<String> {
    let (guard, undercoat) = scenes::mink();
    let mesh = scenes::grid(2, 2, |u, v| Vec3::new(u, 0.0, -v) * 0.01);
    let grown = Grown::new(mesh, &guard, &undercoat, Vec3::X, 35.0, 3);
    let scene = grown.scene();
    let mut uniform = SceneUniform::new(&scene, &Above::new([None; 2]), &scenes::studio(), &Settings::default());
    let volume = Undercoat::new(&grown.undercoat_fibre, Some(Pattern::default()));
    uniform.slope = volume.slope;
    let gpu = open();
    let inputs = random(2, 7);
    let buffer = gpu.buffer("scene", &[uniform], wgpu::BufferUsages::UNIFORM);
    let outputs = on_device(&gpu, shared, MAIN, &[(&[Binding::Uniform], vec![buffer])], &inputs, OUTPUTS);

    let (guard, undercoat) = (grown.guard_fibre.profile, grown.undercoat_fibre.profile);
    let points = grown.guard.points_per_strand;
    let mut worst = Worst::default();
    for i in 0..COUNT {
        let (a, b, out) = (inputs[2 * i], inputs[2 * i + 1], &outputs[OUTPUTS * i..][..OUTPUTS]);
        let mut close = |what: &str, got: f32, expected: f32| worst.note(i, what, got, expected);
        let (hair, light) = (on_sphere(Vec2::new(a.x, a.y)), on_sphere(Vec2::new(a.z, a.w)));
        let eye = on_sphere(Vec2::new(b.x, b.y));
        close("terminator", out[0].x, terminator(light, eye));
        close("depth to the sky", out[0].y, sky_depth(b.z));
        close("slanted depth", out[2].z, slant_depth(b.z, light, eye, hair));
        close("opacity", out[2].w, guard.opacity_at(b.w));
        let (at, strength) = (a.truncate() - 0.5, Vec3::new(1.0, 2.0, 3.0));
        let lamp = if i % 8 == 0 {
            Light::Directional(Directional { to_light: at, irradiance: strength })
        } else {
            let point = Point { position_m: at, intensity: strength, range_m: Some(1.0 / a.w) };
            let outer_cos = b.z - 0.05 - 0.2 * b.w;
            Light::Spot(Spot { point, direction: eye, inner_cos: b.z, outer_cos })
        };
        let arriving = lamp.at(Vec3::new(b.z, b.w, -b.z) * 0.3);
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            close(&format!("direction to a light, {name}"), out[1].to_array()[k], arriving.to_light[k]);
            close(&format!("irradiance, {name}"), out[7].to_array()[k], arriving.irradiance[k]);
        }
        let p = (a.truncate() - 0.5) * 40.0;
        close("noise", out[3].x, simplex(p, 0));
        close("noise", out[3].y, simplex(p, 1));
        close("radius", out[4].w, guard.radius_factor(b.w));
        close("mean sine", out[6].w, volume.mean_sine(b.x));
        close("along the hair", out[0].z, (((100.0 * b.x) as usize % points) as f32 + b.y) / (points - 1) as f32);
        let byte = (256.0 * b.x) as u32 as f32 / 255.0;
        close("stored value", out[8].w, byte * byte * LARGEST);
        // Rounded one way or the other.
        let byte = f32::from(code(20.0 * b.x - 2.0));
        close("code of a value", if (out[9].w - byte).abs() == 1.0 { byte } else { out[9].w }, byte);
        let cell = ((b.truncate() - 0.5) * 2000.0).floor();
        let key = cell.to_array().iter().fold(0, |key, &c| combine(key, c as i64 as u64));
        assert_eq!([out[4].x, out[4].y], [unit_f32(key), unit_f32(combine(key, 1))], "hash of {cell}");
        let d = (b.w * 8.0) as u32;
        let element = ((a.w * (1_u32 << (2 * d)) as f32) as u32).min((1 << (2 * d)) - 1);
        let centre = subelement::centre(element, d);
        assert!((out[5].truncate() - centre).abs().max_element() < 1e-6, "centre of {element} of {d}");
        assert_eq!(out[5].w, element as f32, "sub-element {element} of {d}");
        let colours = a.truncate();
        worst.note_all(i, "guard hair's colour", out[6].truncate(), guard.ramp_at(b.w));
        worst.note_all(i, "undercoat's colour", out[8].truncate(), undercoat.ramp_at(b.w));
        worst.note_all(i, "root", out[11].truncate(), Vec3::new(0.5 * a.x, 0.5 * a.y, 1.0 - 0.5 * (a.x + a.y)));
        // Half floats.
        let near = |got: Vec4, expected: Vec3| (got.truncate() - expected).abs().max_element() < 6e-4;
        assert!(near(out[9], colours) && near(out[10], b.truncate() * 2.0 - 1.0), "packing of input {i}");
    }
    worst.faults(1e-4)
}
