//! The law of a shell on the device: frames, opacity, fetches, gains; flat, bare, mirrored and bent skin among them.

use super::{COUNT, Group, Worst, hold, on_device, on_sphere, open, random, reference};
use crate::coats;
use furrier::coat::axes::Stand;
use furrier::data::coat::Tile;
use furrier::data::shell::guards::{FADE_BELOW, LEAST_COSINE, MOST_TAPS};
use furrier::data::shell::{Filled, HairMedium, Incidence, MOST_ABOVE, Slabs, Stack, closeness, depth_of_opacity};
use furrier::gpu::{Binding, Gpu, Source, Text};
use furrier::math::{DVec2, Mat3, Mat4, Vec2, Vec3, Vec4, orthonormal_basis};
use furrier::runtime::Frame;
use furrier::runtime::gpu::layout::{Mip, SlabItem, TileUniform, ViewUniform};
use furrier::runtime::gpu::pipelines::SHARED;

/// Vectors per input, in and out.
const INPUTS: usize = 11;
const OUTPUTS: usize = 10;

/// Evaluates the law at what the inputs say.
pub const MAIN: Source = Source {
    path: "formulas/coat.wgsl",
    text: Text::Wgsl(
        "
#import furrier::constants::MOST_TAPS
#import furrier::view::ray_direction
#import furrier::coat::{Medium, Ray, frame, hair_frame, ray_in_tile, lateral, across, path_through_slab, gain, presence,
    run_through_slab, depth_of_opacity, fin_share, footprint, medium_of, root_of, filled_slab, closeness,
    area_above, seen_at, seen_above, mean_clear, thinned, at_outline, nearness}

@group(2) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(2) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = 11u * id.x;
    let x_axis = inputs[i].xyz;
    let y_axis = inputs[i + 1u].xyz;
    let up = inputs[i + 2u].xyz;
    let ray = inputs[i + 3u].xyz;
    let slab_m = inputs[i + 3u].w;
    let medium = Medium(inputs[i + 4u].w, inputs[i + 4u].xyz);
    let axis = inputs[i + 5u].xyz;
    let spread = inputs[i + 5u].w;
    let normal = inputs[i + 6u].xyz;
    let bend_per_m = inputs[i + 6u].w;
    let light = inputs[i + 7u].xyz;
    let opacity = inputs[i + 7u].w;
    let pixel = inputs[i + 8u];
    let slope = inputs[i + 9u].xy;
    let level = inputs[i + 9u].z;
    let cosine = inputs[i + 9u].w;

    let texture = frame(x_axis, y_axis, up);
    let straight = ray_in_tile(texture, ray);
    let hair = hair_frame(axis, x_axis, normal, spread, up);
    let seen = ray_in_tile(hair, ray);
    let sweep = Ray(vec3((texture.tile_from_world * ray).xy, seen.direction.z), seen.cosine, seen.fall);
    let path_m = slab_m / abs(seen.direction.z);
    let spot = footprint(pixel.xy, pixel.zw, slope, MOST_TAPS);
    let stored = medium_of(inputs[i + 10u]);

    let chance = inputs[i + 10u];
    let root = root_of(chance, 0.2 + chance.z);
    let filled = filled_slab(1u + u32(6.99 * chance.w), chance.x);

    let first = 10u * id.x;
    outputs[first] = vec4(straight.direction, straight.cosine);
    outputs[first + 1u] = vec4(seen.direction, hair.volume);
    outputs[first + 2u] = vec4(lateral(hair, ray, medium), across(hair, ray, medium), seen_at(chance.x * 4.0), texture.volume);
    outputs[first + 3u] = vec4(run_through_slab(sweep, path_m, slab_m, slope), path_through_slab(straight, slab_m, bend_per_m), seen.fall);
    outputs[first + 4u] = vec4(gain(level, 1u + id.x % 2u, cosine), presence(up * slab_m), depth_of_opacity(opacity), fin_share(cosine, nearness(0.05 * chance.z)));
    outputs[first + 5u] = vec4(spot.line, spot.taps, spot.level);
    outputs[first + 6u] = vec4(spot.round_level, stored.extinction, stored.tangent.x, dot(ray_direction(light), normal));
    outputs[first + 7u] = vec4(f32(filled.layer), filled.slab_m, filled.slabs, closeness(chance.x, chance.y));
    outputs[first + 8u] = vec4(root.density, root.share, area_above(opacity), thinned(opacity, 2.0 * chance.y));
    outputs[first + 9u] = vec4(seen_above(chance.x * 4.0, chance.y * 8.0), mean_clear(chance.x * 4.0), 0.0, 0.0);
}
",
    ),
};

/// A tile whose gains are by chance.
pub fn gained(layers: u32, size: u32) -> Tile {
    let mut tile = coats::tile(&coats::fox()[..1], 0.008, layers, size, 3);
    // The lowest slab is the highest, as in a dense coat.
    let top = |layer: u32| if layer == 0 { 0.0 } else { 0.3 + 0.65 * layer as f32 / (layers - 1) as f32 };
    tile.shells.slabs = Slabs::with_tops((0..layers).map(top).collect()).expect("tops rise");
    let mut stream = furrier::math::hash::Stream::new(21);
    tile.shells.gains.iter_mut().flatten().flatten().for_each(|gain| *gain = 0.5 + stream.unit());
    tile
}

/// What is bound before the inputs: view and tile.
pub fn groups(gpu: &Gpu, tile: &Tile) -> [Group<'static>; 2] {
    let frame = Frame {
        clip_from_world: Mat4::IDENTITY,
        eye: Vec4::new(1.0, 2.0, 3.0, 1.0),
        size: [1, 1],
        lights: vec![],
        ambient: Vec3::ZERO,
        shadow_map: false,
        depths: false,
        level: None,
    };
    let tables = vec![
        gpu.buffer("tile", &[TileUniform::new(tile)], wgpu::BufferUsages::UNIFORM),
        gpu.buffer("slabs", &SlabItem::of(&tile.shells), wgpu::BufferUsages::STORAGE),
        gpu.buffer("mips", &Mip::of(tile), wgpu::BufferUsages::STORAGE),
    ];
    let view = gpu.buffer("view", &[ViewUniform::new(&frame, None)], wgpu::BufferUsages::UNIFORM);
    [(&[Binding::Uniform], vec![view]), (&[Binding::Uniform, Binding::Read, Binding::Read], tables)]
}

/// A place of the skin and a ray to it. Of eight, one is bare and one lies flat; one has no axis and one an axis along the normal.
struct Case {
    texture: [Vec3; 2],
    up: Vec3,
    axis: Vec3,
    normal: Vec3,
    spread: f32,
    ray: Vec3,
    light: Vec3,
    medium: HairMedium,
}

impl Case {
    fn new(kind: usize, u: &[Vec4]) -> Self {
        let normal = on_sphere(Vec2::new(u[0].x, u[0].y));
        let (x, y) = orthonormal_basis(normal);
        let around = |turn: f32| x * (std::f32::consts::TAU * turn).cos() + y * (std::f32::consts::TAU * turn).sin();
        let mirrored = if u[0].z < 0.5 { -1.0 } else { 1.0 };
        let first = around(u[0].w);
        let second = (normal.cross(first) + 0.4 * (u[1].y - 0.5) * first) * (mirrored * (0.6 + 0.8 * u[1].z));
        let lean_rad = match kind % 8 {
            1 => std::f32::consts::FRAC_PI_2 * (0.998 - 0.05 * u[1].w),
            _ => 1.4 * u[1].w,
        };
        let length = if kind.is_multiple_of(8) { 0.0 } else { 0.1 + u[2].x };
        let up = (normal * lean_rad.cos() + around(u[2].y) * lean_rad.sin()) * length;
        let axis = match kind / 8 % 8 {
            0 => Vec3::ZERO,
            1 => normal * 0.7,
            _ => around(u[2].z) * 0.3 + normal * (u[2].w - 0.5),
        };
        let inwards = |v: Vec3| if v.dot(normal) > 0.0 { -v } else { v };
        // Rays near the horizon among them.
        let ray = on_sphere(Vec2::new(u[3].x, u[3].y));
        let ray = (ray - normal * (ray.dot(normal) * if u[3].z < 0.3 { 0.97 } else { 0.0 })).normalize();
        let extinction = 1e4 * u[4].x;
        let m = on_sphere(Vec2::new(u[4].y, u[4].z)) * if u[4].w < 0.1 { 0.0 } else { u[4].w };
        Self {
            texture: [first * (0.6 + 0.8 * u[1].x), second],
            up,
            axis,
            normal,
            spread: 0.5 + u[3].w,
            ray: inwards(ray),
            light: -inwards(on_sphere(Vec2::new(u[5].x, u[5].y))),
            medium: HairMedium { extinction, tangent: m * extinction },
        }
    }
}

#[test]
fn shaders_and_rust_agree_on_the_law() {
    hold(law(&SHARED));
}

/// Compares the law; gives what is off.
pub fn law(shared: &[Source]) -> Vec<String> {
    let gpu = open();
    let tile = gained(8, 32);
    let (edge_m, size, mips) = (tile.edge_m, tile.shells.size as f32, tile.shells.medium.len());
    let chance = random(8, 9);
    let of = |i: usize| &chance[8 * i..8 * i + 8];
    let cases: Vec<Case> = (0..COUNT).map(|i| Case::new(i, of(i))).collect();
    let slab_m = |i: usize| 2e-3 * (0.2 + of(i)[5].z);
    let bend_per_m = |i: usize| 100.0 * (of(i)[5].w - 0.3);
    let pixel = |i: usize| {
        let u = of(i)[6];
        let (turn, at) = (std::f32::consts::TAU * u.x, (u.y * 8.0).exp2() / (4.0 * size));
        // One pixel in four is round, which rounding must not take for two taps.
        let flat = if i.is_multiple_of(4) { 1.0 } else { 0.05 + u.z };
        let major = Vec2::from_angle(turn) * at;
        [major, major.perp() * flat]
    };
    let level = |i: usize| of(i)[6].w * (mips - 1) as f32;
    let slope = |i: usize| if i.is_multiple_of(8) { Vec2::ZERO } else { (of(i)[7].truncate().truncate() - 0.5) * 0.4 };
    let cosine = |i: usize| LEAST_COSINE + (1.0 - LEAST_COSINE) * of(i)[7].z;
    let opacity = |i: usize| if i.is_multiple_of(8) { 1.0 } else { of(i)[7].w };
    let mut inputs = Vec::new();
    for (i, case) in cases.iter().enumerate() {
        let [dx, dy] = pixel(i);
        let slope = slope(i);
        inputs.extend([
            case.texture[0].extend(0.0),
            case.texture[1].extend(0.0),
            case.up.extend(0.0),
            case.ray.extend(slab_m(i)),
            case.medium.tangent.extend(case.medium.extinction),
            case.axis.extend(case.spread),
            case.normal.extend(bend_per_m(i)),
            case.light.extend(opacity(i)),
            Vec4::new(dx.x, dx.y, dy.x, dy.y),
            Vec4::new(slope.x, slope.y, level(i), cosine(i)),
            of(i)[0],
        ]);
    }
    assert_eq!(inputs.len(), INPUTS * COUNT);
    let outputs = on_device(&gpu, shared, MAIN, &groups(&gpu, &tile), &inputs, OUTPUTS);

    let stack = Stack::new(&tile);
    // What is exact, and what goes through a driver's arc cosine.
    let (mut worst, mut rough) = (Worst::default(), Worst::default());
    for (i, case) in cases.iter().enumerate() {
        let out = &outputs[OUTPUTS * i..][..OUTPUTS];
        let Case { texture, up, axis, normal, spread, ray, medium, light } = *case;
        let straight = Incidence::new(ray, Mat3::from_cols(texture[0], texture[1], up), 1.0);
        let d = straight.in_tile();
        let size_of_d = d.length();
        worst.note_all(i, "ray in the texture", out[0].truncate() / size_of_d, d / size_of_d);
        worst.note(i, "cosine", out[0].w, d.z.abs() / size_of_d);
        worst.note(i, "volume of the texture", out[2].w / straight.volume(), 1.0);
        let seen = Stand { normal, axis, up, texture, spread }.seen(ray, 1.0);
        let d = seen.in_tile();
        worst.note_all(i, "ray in hair", out[1].truncate() / d.length(), d / d.length());
        worst.note(i, "volume of hair", out[1].w / seen.volume(), 1.0);
        worst.note(i, "fall", out[3].w / d.z.abs(), seen.share_of_ends());
        // Squares: along the hair little is left of large numbers.
        let along = axis - normal * normal.dot(axis);
        let x = if along.length() > 1e-3 * axis.length() { along } else { texture[0] }.normalize();
        let m = [x * spread, normal.cross(x) * spread, up].map(|v| v.as_dvec3());
        let tangent = medium.tangent.as_dvec3();
        let most = if tangent.length() > 0.0 {
            let unit = tangent / tangent.length();
            f64::from(medium.extinction) * (m[0] * unit.x + m[1] * unit.y + m[2] * unit.z).length()
        } else {
            f64::from(medium.extinction)
        };
        let most = (most / f64::from(seen.volume())) as f32;
        let square = |v: f32| (v / most).powi(2);
        worst.note(i, "extinction", square(out[2].x), square(medium.lateral(&seen)));
        let told = tangent.length() > 0.0;
        worst.note(i, "extinction across", square(out[2].y), if told { square(medium.lateral(&seen)) } else { 1.0 });
        let run = (seen.slope() - slope(i)) * slab_m(i) / edge_m;
        worst.note(i, "run through a slab", out[3].x, run.x);
        worst.note(i, "run through a slab", out[3].y, run.y);
        let (fall, steep) = (straight.share_of_ends() * straight.in_tile().z.abs(), straight.in_tile().z.abs());
        let [fall, steep, slab, bend] = [fall, steep, slab_m(i), bend_per_m(i)].map(f64::from);
        // Where a ray just touches the bottom, roundings decide whether it does.
        if (steep * steep / (4.0 * bend * slab) - 1.0).abs() > 1e-2 {
            let path = reference::path_through_slab(steep, fall, slab, bend);
            worst.note(i, "path through a slab", (f64::from(out[3].z) / path) as f32, 1.0);
        }
        let chance = of(i)[0];
        worst.note(i, "where a slab is seen", out[2].z, reference::seen_at(f64::from(chance.x) * 4.0) as f32);
        let [depth, area] = [f64::from(chance.x) * 4.0, f64::from(chance.y) * 8.0];
        worst.note(i, "hair above what is seen", out[9].x, reference::seen_above(depth, area) as f32);
        worst.note(i, "what comes through in the mean", out[9].y, (-(-depth).exp_m1() / depth.max(1e-12)) as f32);
        worst.note(i, "hair area above", out[8].z / MOST_ABOVE, (1.0 - opacity(i)).powi(2));
        let thinned = reference::thinned(opacity(i).into(), f64::from(chance.y) * 2.0);
        worst.note(i, "opacity of thinned hair", out[8].w, thinned as f32);
        let filled = Filled::new(1 + (6.99 * chance.w) as u32, chance.x, &tile.shells.slabs, tile.height_m);
        // Where a slab just ends at a layer, roundings decide which it is.
        let [bottom, _] = tile.shells.slabs.span((6.99 * chance.w) as usize);
        let middle = bottom / chance.x + 0.5 * filled.slab_m / tile.height_m;
        if tile.shells.slabs.tops().iter().all(|top| (top - middle).abs() > 1e-4) {
            worst.note(i, "slabs filled", out[7].z / 8.0, filled.slabs / 8.0);
            worst.note(i, "layer of a filled slab", out[7].x / 8.0, filled.layer as f32 / 8.0);
        }
        worst.note(i, "filled slab", out[7].y / tile.height_m, filled.slab_m / tile.height_m);
        worst.note(i, "closeness", out[7].w, closeness(chance.x, chance.y));
        worst.note(i, "density at the root", out[8].x, chance.x);
        worst.note(i, "length at the root", out[8].y, (chance.y / (0.2 + chance.z)).min(1.0));
        let (mip, layer) = (level(i) as usize, 1 + i % 2);
        let degrees = f64::from(cosine(i)).acos().to_degrees();
        let of_mip = |mip: usize| reference::gain(&tile.shells.gains[mip.min(mips - 1)][layer], degrees) as f32;
        let gain = of_mip(mip) + (of_mip(mip + 1) - of_mip(mip)) * level(i).fract();
        rough.note(i, "gain", out[4].x, gain);
        let flat = Vec3::new((1.0 - cosine(i) * cosine(i)).sqrt(), 0.0, -cosine(i));
        let seen = Incidence::new(flat, Mat3::IDENTITY, level(i).exp2() / size);
        rough.note(i, "gain of a stack", out[4].x, stack.gain(layer, &seen));
        let offset = f64::from((up * slab_m(i)).length() / tile.height_m);
        worst.note(i, "presence", out[4].y, reference::smoothstep(0.0, FADE_BELOW.into(), offset) as f32);
        worst.note(i, "depth of an opacity", out[4].z, depth_of_opacity(opacity(i)));
        rough.note(
            i,
            "share of fins",
            out[4].w,
            reference::fin_share(cosine(i).into(), (1.0 - 24.0 * 0.05 * f64::from(of(i)[0].z)).clamp(0.0, 1.0)) as f32,
        );
        let [dx, dy] = pixel(i);
        let vectors: [DVec2; 3] = [dx, dy, slope(i)].map(|v| v.as_dvec2());
        let spot = reference::footprint(vectors, size.into(), mips as f64, MOST_TAPS.into());
        let over = (spot.ratio - 1e-3).fract();
        if over > 1e-4 && over < 1.0 - 1e-4 {
            let line = Vec2::new(out[5].x, out[5].y).as_dvec2();
            let line = if line.dot(spot.line) < 0.0 { -line } else { line };
            let width = vectors.iter().map(|v| v.length()).sum::<f64>();
            worst.note(i, "line of taps", (line.distance(spot.line) / width) as f32, 0.0);
            worst.note(i, "taps", out[5].z, spot.taps as f32);
            worst.note(i, "level", out[5].w, spot.level as f32);
            worst.note(i, "round level", out[6].x, spot.round_level as f32);
        }
        let unit_per_m = TileUniform::new(&tile).medium_unit_per_m;
        worst.note(i, "decoded extinction", out[6].y / unit_per_m, of(i)[0].x);
        worst.note(i, "decoded tangent", out[6].z / unit_per_m, of(i)[0].y);
        let from_eye = (light - Vec3::new(1.0, 2.0, 3.0)).normalize();
        worst.note(i, "ray from the eye", out[6].w, from_eye.dot(normal));
    }
    [worst.faults(2e-4), rough.faults(2e-3)].concat()
}
