//! The shaders' formulas against the same ones in Rust, over random inputs.

use crate::lanes::simplex;
use crate::scenes::{self, Grown};
use furrier::gpu::{Binding, Choice, Gpu, Library, Source};
use furrier::hybrid::Settings;
use furrier::hybrid::gpu::kernels::SHARED;
use furrier::hybrid::gpu::layout::SceneUniform;
use furrier::math::hash::{Stream, combine, unit_f32};
use furrier::math::{Vec2, Vec3, Vec4};
use furrier::shade::Angles;
use furrier::shade::kajiya_kay::KajiyaKay;
use furrier::shade::lobes::Lobes;
use furrier::volume::scene::{Layer, sky_depth, slant_depth, terminator};
use furrier::volume::shell::subelement;
use std::cell::RefCell;
use std::collections::BTreeMap;

const COUNT: usize = 2048;

/// Evaluates everything at inputs of eight numbers in [0, 1), into eight vectors each.
const MAIN: Source = Source {
    path: "formulas.wgsl",
    text: "
#import furrier::scene::scene
#import furrier::fur_light::{angles_of, guard_lobes, kajiya_kay, above_height, slant_depth, sky_depth, terminator}
#import furrier::noise::simplex
#import furrier::hash::{combine, unit, wide_of}
#import furrier::prism::{subelement, subelement_centre}
#import furrier::guard::{opacity_at, guard_ramp}

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
    let angles = angles_of(hair, light, eye);
    outputs[8u * i] = vec4(guard_lobes(angles), angles.sin_in);
    outputs[8u * i + 1u] = vec4(kajiya_kay(angles), terminator(light, eye), sky_depth(b.z));
    outputs[8u * i + 2u] = vec4(
        above_height(scene.guard_kind, a.x, 0.5 + a.y, 0.03 * a.z),
        above_height(scene.undercoat_kind, a.x, 0.5 + a.y, 0.03 * a.z),
        slant_depth(b.z, light, eye, hair),
        opacity_at(b.w),
    );
    let p = 40.0 * (a.xyz - 0.5);
    outputs[8u * i + 3u] = vec4(simplex(p, 0u), simplex(p, 1u), 0.0, 0.0);
    let cell = vec3<i32>(floor(2000.0 * (b.xyz - 0.5)));
    let key = combine(combine(combine(vec2(0u), wide_of(cell.x)), wide_of(cell.y)), wide_of(cell.z));
    outputs[8u * i + 4u] = vec4(unit(key), unit(combine(key, vec2(1u, 0u))), 0.0, 0.0);
    let d = u32(b.w * 8.0);
    let element = min(u32(a.w * f32(1u << (2u * d))), (1u << (2u * d)) - 1u);
    let centre = subelement_centre(element, d);
    outputs[8u * i + 5u] = vec4(centre, f32(subelement(centre, d)));
    outputs[8u * i + 6u] = vec4(guard_ramp(b.w), 0.0);
}
",
};

fn on_sphere(u: Vec2) -> Vec3 {
    let z = 2.0 * u.x - 1.0;
    let (r, (sin, cos)) = ((1.0 - z * z).max(0.0).sqrt(), (std::f32::consts::TAU * u.y).sin_cos());
    Vec3::new(r * cos, r * sin, z)
}

fn on_gpu(grown: &Grown, inputs: &[Vec4]) -> Vec<Vec4> {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let scene = grown.scene();
    let lobes = Lobes::new(&scene.scattering.guard).unwrap();
    let scene = SceneUniform::new(&scene, &lobes, &scenes::studio(), &Settings::default());
    let scene_layout = gpu.layout("scene", &[Binding::Uniform]);
    let own_layout = gpu.layout("formulas", &[Binding::Read, Binding::Write]);
    let module = gpu.shader_of(&mut Library::new(&SHARED).unwrap(), MAIN).unwrap();
    let kernel = gpu.kernel("formulas", &module, &[&scene_layout, &own_layout], &[]);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let outputs = gpu.buffer("outputs", &vec![Vec4::NAN; 8 * COUNT], usage);
    let scene_group = gpu.group(&scene_layout, &[&gpu.buffer("scene", &[scene], wgpu::BufferUsages::UNIFORM)]);
    let own_group = gpu.group(&own_layout, &[&gpu.read_only("inputs", inputs).unwrap(), &outputs]);
    let read = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: outputs.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder("formulas");
    kernel.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &[&scene_group, &own_group], COUNT / 64);
    encoder.copy_buffer_to_buffer(&outputs, 0, &read, 0, outputs.size());
    gpu.finish(encoder).unwrap();
    bytemuck::pod_collect_to_vec(&gpu.read_buffer(&read).unwrap())
}

#[test]
fn shaders_and_rust_agree_on_every_formula() {
    let (guard, undercoat) = scenes::mink();
    let grown =
        Grown::new(scenes::grid(2, 2, |u, v| Vec3::new(u, 0.0, -v) * 0.01), &guard, &undercoat, Vec3::X, 35.0, 3);
    let scene = grown.scene();
    let mut random = Stream::new(7);
    let inputs: Vec<Vec4> =
        (0..2 * COUNT).map(|_| Vec4::new(random.unit(), random.unit(), random.unit(), random.unit())).collect();
    let outputs = on_gpu(&grown, &inputs);
    let lobes = Lobes::<f32>::new(&scene.scattering.guard).unwrap();
    let hair = &scene.scattering;
    let kajiya = KajiyaKay::<f32>::new(hair.undercoat_diffuse, hair.undercoat_specular, hair.undercoat_exponent);
    let layers = [&grown.guard_fibre, &grown.undercoat_fibre];
    let worst: RefCell<BTreeMap<String, (f32, String)>> = RefCell::default();
    let close = |i: usize, what: &str, got: f32, expected: f32| {
        let off = (got - expected).abs() / (0.1 + expected.abs());
        let said = format!("input {i}: {got} by the shader, {expected} in Rust");
        let mut worst = worst.borrow_mut();
        let entry = worst.entry(what.to_owned()).or_default();
        if off.is_nan() || off >= entry.0 {
            *entry = (off, said);
        }
    };
    for i in 0..COUNT {
        let (a, b, out) = (inputs[2 * i], inputs[2 * i + 1], &outputs[8 * i..8 * i + 8]);
        let (hair, light) = (on_sphere(Vec2::new(a.x, a.y)), on_sphere(Vec2::new(a.z, a.w)));
        let eye = on_sphere(Vec2::new(b.x, b.y));
        let angles = Angles::new(hair.dot(light), hair.dot(eye), light.dot(eye));
        let scattered = lobes.scatter(angles);
        // Where hair, light and eye are nearly in line, the azimuth is a quotient of roundings.
        if angles.sin_in.abs().max(angles.sin_out.abs()) < 0.999 {
            close(i, "R", out[0].x, scattered.plain);
            close(i, "TT", out[0].y, scattered.once);
            close(i, "TRT", out[0].z, scattered.twice);
        }
        let (tinted, plain) = kajiya.scatter(angles);
        close(i, "Kajiya-Kay's diffuse", out[1].x, tinted);
        close(i, "Kajiya-Kay's highlight", out[1].y, plain);
        close(i, "terminator", out[1].z, terminator(light, eye));
        close(i, "depth to the sky", out[1].w, sky_depth(b.z));
        for (kind, got) in layers.iter().zip([out[2].x, out[2].y]) {
            close(i, "hair above", got, Layer::new(kind, a.x, 0.5 + a.y).above(0.03 * a.z));
        }
        close(i, "slanted depth", out[2].z, slant_depth(b.z, light, eye, hair));
        close(i, "opacity", out[2].w, grown.guard_fibre.profile.opacity_at(b.w));
        let p = (a.truncate() - 0.5) * 40.0;
        close(i, "noise", out[3].x, simplex(p, 0));
        close(i, "noise", out[3].y, simplex(p, 1));
        let cell = ((b.truncate() - 0.5) * 2000.0).floor();
        let key = cell.to_array().iter().fold(0, |key, &c| combine(key, c as i64 as u64));
        assert_eq!([out[4].x, out[4].y], [unit_f32(key), unit_f32(combine(key, 1))], "hash of {cell}");
        let d = (b.w * 8.0) as u32;
        let element = ((a.w * (1_u32 << (2 * d)) as f32) as u32).min((1 << (2 * d)) - 1);
        let centre = subelement::centre(element, d);
        assert!((out[5].truncate() - centre).abs().max_element() < 1e-6, "centre of {element} of {d}");
        assert_eq!(out[5].w, element as f32, "sub-element {element} of {d}");
        let ramp = grown.guard_fibre.profile.ramp_at(b.w);
        assert!((out[6].truncate() - ramp).abs().max_element() < 1e-5);
    }
    for (what, (off, said)) in worst.into_inner() {
        println!("{what}: {off:.1e}, {said}");
        assert!(off < 1e-4, "{what} is off by {off}: {said}");
    }
}
