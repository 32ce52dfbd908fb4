//! Light on hair and skin as the runtime draws them: formula by formula, and skin and fins as whole pixels.

use super::{COUNT, Worst, coat, hold, on_device, on_sphere, open, random, reference};
use crate::coats;
use furrier::data::coat::{FinEdge, Tile};
use furrier::data::image::linear_from_srgb;
use furrier::data::light::Directional;
use furrier::data::shell::{depth_of_opacity, signed, unorm};
use furrier::gpu::{Source, Text};
use furrier::math::{DVec3, Mat4, Vec2, Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::gpu::pipelines::SHARED;
use furrier::runtime::{CoatMesh, DrawList, Frame, Show, SkinMesh};

/// Vectors per input.
const OUTPUTS: usize = 3;

/// Evaluates the formulas of `shading.wgsl`.
pub const MAIN: Source = Source {
    path: "formulas/look.wgsl",
    text: Text::Wgsl(
        "
#import furrier::shading::{Hair, scattered, above_horizon, multiply_scattered, skin_radiance}

@group(2) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(2) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = 5u * id.x;
    let albedo = inputs[i].xyz;
    let direct = inputs[i].w;
    let tangent = inputs[i + 1u].xyz;
    let normal = inputs[i + 2u].xyz;
    let viewer = inputs[i + 3u].xyz;
    let light = inputs[i + 4u].xyz;
    let reach = multiply_scattered(direct, albedo);
    let hair = Hair(albedo, tangent, normal, viewer);
    outputs[3u * id.x] = vec4(scattered(hair, light, direct, reach), above_horizon(inputs[i + 1u].w));
    outputs[3u * id.x + 1u] = vec4(reach, 0.0);
    outputs[3u * id.x + 2u] = vec4(skin_radiance(albedo, normal, viewer, light, inputs[i + 2u].w), 0.0);
}
",
    ),
};

#[test]
fn shaders_and_rust_agree_on_light_on_hair_and_skin() {
    let gpu = open();
    let chance = random(4, 10);
    let mut inputs = Vec::new();
    for u in chance.chunks_exact(4) {
        let sphere = |at: Vec4, length: f32| on_sphere(Vec2::new(at.x, at.y)) * length;
        inputs.extend([
            u[0],
            sphere(u[1], u[1].z).extend(2.0 * u[1].w - 1.0),
            sphere(u[2], 1.0).extend(u[2].w),
            sphere(u[3], 1.0).extend(0.0),
            on_sphere(Vec2::new(u[3].z, u[3].w)).extend(0.0),
        ]);
    }
    let outputs = on_device(&gpu, &SHARED, MAIN, &coat::groups(&gpu, &coat::gained(3, 8)), &inputs, OUTPUTS);
    let (mut worst, mut rough) = (Worst::default(), Worst::default());
    for i in 0..COUNT {
        let (given, out) = (&inputs[5 * i..][..5], &outputs[OUTPUTS * i..][..OUTPUTS]);
        let [albedo, tangent, normal, viewer, light] = [0, 1, 2, 3, 4].map(|k| given[k].truncate().as_dvec3());
        let direct = f64::from(given[0].w);
        let reach = reference::multiply_scattered(direct, albedo);
        worst.note_all(i, "scattering between hairs", out[1].truncate(), reach.as_vec3());
        // Through a driver's arc sine.
        let hair = reference::scattered(albedo, tangent, viewer, light, direct, reach);
        rough.note_all(i, "hair", out[0].truncate(), hair.as_vec3());
        worst.note(i, "horizon", out[0].w, reference::above_horizon(given[1].w.into()) as f32);
        let skin = reference::skin_radiance(albedo, normal, viewer, light, given[2].w.into());
        worst.note_all(i, "skin", out[2].truncate(), skin.as_vec3());
    }
    hold([worst.faults(2e-4), rough.faults(2e-3)].concat());
}

/// A picture of 4 × 4 pixels along `ray`, a square of 2 m around the origin.
fn frame(ray: Vec3) -> Frame {
    let (x, y) = furrier::math::orthonormal_basis(-ray);
    let columns = Mat4::from_cols(x.extend(0.0), y.extend(0.0), (0.05 * ray).extend(0.0), Vec4::W);
    let middle = Mat4::from_translation(Vec3::new(0.0, 0.0, 0.5));
    Frame {
        clip_from_world: middle * columns.transpose(),
        eye: (-ray).extend(0.0),
        size: [4; 2],
        lights: vec![
            Directional { to_light: Vec3::new(0.4, 0.3, 0.9).normalize(), irradiance: Vec3::new(3.0, 2.0, 1.0) }.into(),
            Directional { to_light: Vec3::new(-0.9, 0.2, 0.05).normalize(), irradiance: Vec3::new(0.5, 1.0, 2.0) }
                .into(),
        ],
        ambient: Vec3::new(0.2, 0.3, 0.4),
        shadow_map: false,
    }
}

/// A tile of one texel's worth: every texel of skin, fin and fin's tangent the same.
fn plain_tile() -> Tile {
    let mut tile = coats::tile(&coats::fox()[..1], 0.008, 3, 8, 1);
    let fill = |image: &mut furrier::data::image::Image8, bytes: [u8; 4]| {
        image.pixels.chunks_exact_mut(4).for_each(|texel| texel.copy_from_slice(&bytes));
    };
    tile.shells.albedo.iter_mut().for_each(|layers| fill(&mut layers[0], SKIN));
    tile.fin.albedo.iter_mut().for_each(|image| fill(image, FIN));
    tile.fin.tangent.iter_mut().for_each(|image| fill(image, TANGENT));
    tile
}

const SKIN: [u8; 4] = [200, 120, 90, 140];
const FIN: [u8; 4] = [180, 110, 70, 150];
const TANGENT: [u8; 4] = [160, 110, 220, 100];

fn colour(bytes: [u8; 4]) -> DVec3 {
    Vec3::from([0, 1, 2].map(|i| linear_from_srgb(unorm(bytes[i])))).as_dvec3()
}

/// The directions that the pictures are taken along.
fn rays() -> [Vec3; 3] {
    [Vec3::new(0.1, 0.2, -1.0), Vec3::new(0.9, 0.1, -0.6), Vec3::new(-0.3, -0.9, -0.2)].map(Vec3::normalize)
}

/// A pixel as it is drawn and as it should be: half floats lie between.
pub fn like(got: [f32; 4], radiance: DVec3, alpha: f64) -> bool {
    let near = |got: f32, expected: f64| (f64::from(got) - expected).abs() < 2e-3 * (0.2 + expected.abs());
    near(got[3], alpha) && (0..3).all(|i| near(got[i], radiance[i]))
}

#[test]
fn skin_is_lit_as_its_formulas_say() {
    let gpu = open();
    let tiles = [plain_tile()];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let base = Vec3::new(0.8, 0.6, 0.3);
    for (density, ray) in [0.0, 0.4, 2.0].into_iter().flat_map(|density| rays().map(|ray| (density, ray))) {
        let normal = Vec3::new(0.2, -0.1, 1.0).normalize();
        let skin = SkinMesh {
            positions_m: vec![Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 18.0, 0.0)],
            normals: vec![normal; 3],
            colour: vec![base; 3],
            tile: Some(0),
            coat_uv: vec![Vec2::ZERO; 3],
            coat_density: vec![density; 3],
            triangles: vec![[0, 1, 2]],
            ..SkinMesh::default()
        };
        let frame = frame(ray);
        let list = DrawList { skins: vec![skin], furs: vec![], tiles: &tiles };
        let pixel = renderer.prepare(&list).unwrap().draw(&frame, Show::default()).unwrap().picture.pixels[5];
        let albedo = base.as_dvec3() * if density > 0.0 { colour(SKIN) } else { DVec3::ONE };
        // What is seen of hair's shadow on skin counts up to 1.5.
        let depth = f64::from(-unorm(SKIN[3]).ln() * density).min(1.5);
        let gloss = if density > 0.0 { 0.0 } else { 1.0 };
        let mut radiance = albedo * frame.ambient.as_dvec3() * (-depth).exp();
        for light in frame.lights.iter().map(|light| light.at(Vec3::ZERO)) {
            let (to_light, normal) = (light.to_light.as_dvec3(), normal.as_dvec3());
            let shadow = (-depth * reference::skin_slant(normal.dot(to_light))).exp();
            let shown = reference::skin_radiance(albedo, normal, -ray.as_dvec3(), to_light, gloss);
            radiance += light.irradiance.as_dvec3() * shadow * shown;
        }
        println!("density {density}, {ray}: {pixel:?} for {radiance}");
        assert!(like(pixel, radiance, 1.0), "{pixel:?} for {radiance}, density {density} along {ray}");
    }
}

#[test]
fn fins_are_as_opaque_and_as_bright_as_their_formulas_say() {
    let gpu = open();
    let tiles = [plain_tile()];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let (start, end, offset) = (Vec3::new(-3.0, -3.0, 0.0), Vec3::new(3.0, -3.0, 0.5), Vec3::new(0.6, 6.0, 0.8));
    let normal = Vec3::new(0.3, 0.5, 0.8).normalize();
    let tint = Vec4::new(0.9, 0.8, 1.1, 0.7);
    let thickness = 1.3;
    let mut seen = 0;
    for ray in rays() {
        let fur = CoatMesh {
            tile: 0,
            positions_m: vec![start, end],
            normals: vec![normal; 2],
            offsets_m: vec![offset; 2],
            axes: vec![],
            uv: vec![Vec2::ZERO; 2].into(),
            tint: vec![tint; 2].into(),
            triangles: &[],
            fins: vec![FinEdge { ends: [0, 1], opposite: [0, 1], u: [0.0, 1.0], thickness }].into(),
            ..CoatMesh::default()
        };
        let frame = frame(ray);
        let list = DrawList { skins: vec![], furs: vec![fur], tiles: &tiles };
        let pixel = renderer.prepare(&list).unwrap().draw(&frame, Show::default()).unwrap().picture.pixels[5];
        let (across, along) = ((end - start).cross(offset).normalize(), (end - start).normalize());
        let facing = across.dot(ray).abs();
        let weight = (2.0 * facing - 1.0).max(0.0) / facing;
        let depth = f64::from(depth_of_opacity(unorm(FIN[3])) * thickness * weight * tint.w);
        let alpha = -(-depth).exp_m1();
        let stored = Vec3::from([0, 1, 2].map(|i| signed(TANGENT[i])));
        let up = offset.normalize();
        let tangent = (along * stored.x + across * stored.y + up * stored.z).normalize() * stored.length().min(1.0);
        let albedo = colour(FIN) * tint.truncate().as_dvec3();
        let outside = f64::from(-unorm(TANGENT[3]).ln() * tint.w);
        let reach = |transmittance: f64| reference::multiply_scattered(transmittance, albedo);
        let mut radiance = albedo * frame.ambient.as_dvec3() * reach((-outside).exp());
        for light in frame.lights.iter().map(|light| light.at(Vec3::ZERO)) {
            let (to_light, tangent) = (light.to_light.as_dvec3(), tangent.as_dvec3());
            let cosine = normal.as_dvec3().dot(to_light);
            let lateral = (1.0 - tangent.dot(to_light).powi(2)).max(0.0).sqrt();
            let shadow = (-outside * lateral / cosine.abs().max(0.052)).exp();
            let shown = reference::scattered(albedo, tangent, -ray.as_dvec3(), to_light, shadow, reach(shadow));
            radiance += reference::above_horizon(cosine) * light.irradiance.as_dvec3() * shown;
        }
        println!("facing {facing:.2}: {pixel:?} for {} and {alpha}", radiance * alpha);
        assert!(like(pixel, radiance * alpha, alpha), "{pixel:?} for {} and {alpha}", radiance * alpha);
        seen += usize::from(alpha > 0.1);
    }
    assert!(seen >= 1, "no fin was seen");
}
