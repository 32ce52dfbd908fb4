//! Light on skin as the runtime draws it: formula by formula; and skin and fins as whole pixels.

use super::{COUNT, Worst, coat, hold, on_device, on_sphere, open, random, reference};
use crate::coats;
use furrier::data::coat::{FinEdge, Tile, TileLooks};
use furrier::data::image::linear_from_srgb;
use furrier::data::light::Directional;
use furrier::data::shell::{above_of, signed, unorm};
use furrier::gpu::{Source, Text};
use furrier::math::{DVec3, Mat4, Vec2, Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::gpu::pipelines::SHARED;
use furrier::runtime::{CoatMesh, DrawList, Frame, Show, SkinMesh};
use furrier::shade::Angles;
use furrier::shade::law::Place;
use furrier::volume::scene::{slant_depth, terminator};

/// Vectors per input.
const OUTPUTS: usize = 2;

/// Evaluates the formulas of `shading.wgsl`.
pub const MAIN: Source = Source {
    path: "formulas/look.wgsl",
    text: Text::Wgsl(
        "
#import furrier::shading::{past_border, past_skin, skin_radiance, way_to_border, way_up}

@group(2) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(2) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = 4u * id.x;
    let albedo = inputs[i].xyz;
    let normal = inputs[i + 1u].xyz;
    let viewer = inputs[i + 2u].xyz;
    let light = inputs[i + 3u].xyz;
    let rise = inputs[i].w;
    let bend_per_m = inputs[i + 2u].w;
    let height_m = inputs[i + 3u].w;
    outputs[2u * id.x] = vec4(skin_radiance(albedo, normal, viewer, light, inputs[i + 1u].w), 0.0);
    let border_m = 0.1 * inputs[i + 1u].w;
    let over_skin = vec2(log(way_up(rise, bend_per_m, height_m)), past_skin(rise, bend_per_m, height_m));
    let at_border = vec2(log(way_to_border(rise, border_m, height_m)), past_border(rise, border_m, height_m));
    outputs[2u * id.x + 1u] = vec4(over_skin, at_border);
}
",
    ),
};

#[test]
fn shaders_and_rust_agree_on_light_on_skin() {
    let gpu = open();
    let chance = random(4, 10);
    let mut inputs = Vec::new();
    for u in chance.chunks_exact(4) {
        let sphere = |at: Vec4| on_sphere(Vec2::new(at.x, at.y));
        inputs.extend([
            u[0].truncate().extend(2.0 * u[0].w - 1.0),
            sphere(u[1]).extend(u[1].w),
            sphere(u[2]).extend(40.0 * u[2].w - 5.0),
            sphere(u[3]).extend(0.02 * u[3].w),
        ]);
    }
    let outputs = on_device(&gpu, &SHARED, MAIN, &coat::groups(&gpu, &coat::gained(3, 8)), &inputs, OUTPUTS);
    let mut worst = Worst::default();
    for i in 0..COUNT {
        let (given, out) = (&inputs[4 * i..][..4], &outputs[OUTPUTS * i..][..OUTPUTS]);
        let [albedo, normal, viewer, light] = [0, 1, 2, 3].map(|k| given[k].truncate().as_dvec3());
        let [rise, bend_per_m, height_m] = [0, 2, 3].map(|k| f64::from(given[k].w));
        worst.note(i, "way up", out[1].x, reference::way_up(rise, bend_per_m, height_m).ln() as f32);
        worst.note(i, "past the skin", out[1].y, reference::past_skin(rise, bend_per_m, height_m) as f32);
        let border_m = 0.1 * f64::from(given[1].w);
        worst.note(i, "way to border", out[1].z, reference::way_to_border(rise, border_m, height_m).ln() as f32);
        worst.note(i, "past the border", out[1].w, reference::past_border(rise, border_m, height_m) as f32);
        let skin = reference::skin_radiance(albedo, normal, viewer, light, given[1].w.into());
        worst.note_all(i, "skin", out[0].truncate(), skin.as_vec3());
    }
    hold(worst.faults(2e-4));
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
        depths: false,
        level: None,
    }
}

/// A tile of one texel's worth: every texel of skin, fin and fin's tangent the same.
fn plain_tile() -> Tile {
    let mut tile = coats::tile(&coats::fox()[..1], 0.008, 3, 8, 1);
    let fill = |image: &mut furrier::data::image::Image8, bytes: [u8; 4]| {
        image.pixels.chunks_exact_mut(4).for_each(|texel| texel.copy_from_slice(&bytes));
    };
    // The fins are as tall.
    tile.height_m = 6.0;
    tile.shells.albedo.iter_mut().for_each(|layers| fill(&mut layers[0], SKIN));
    tile.fin.albedo.iter_mut().for_each(|image| fill(image, FIN));
    tile.fin.tangent.iter_mut().for_each(|image| fill(image, TANGENT));
    let of = super::law::looks().map(|look| look.packed());
    tile.looks = Some(TileLooks { of, crowding: [CROWDING, 0.3], undercoat_share: vec![1.0, 1.0, 0.0] });
    tile
}

/// Of guard hair, of which the top layer and fins are.
const CROWDING: f32 = 0.05;
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
        let depth = f64::from(above_of(SKIN[3]) * density).min(1.5);
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
    let thickness = 3.0;
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
        let near_outline = reference::at_outline(normal.dot(ray).into(), 0.0);
        let amount = f64::from(thickness * weight * tint.w) * near_outline;
        let alpha = reference::thinned(unorm(FIN[3]).into(), amount);
        let stored = Vec3::from([0, 1, 2].map(|i| signed(TANGENT[i])));
        let up = offset.normalize();
        let tangent = (along * stored.x + across * stored.y + up * stored.z).normalize().as_dvec3();
        let albedo = colour(FIN) * tint.truncate().as_dvec3();
        let outside = f64::from(above_of(TANGENT[3]) * tint.w * offset.length() / tiles[0].height_m);
        let [look, _] = super::law::looks();
        let worn = look.wear(albedo.to_array());
        let (normal, to_eye) = (normal.as_dvec3(), -ray.as_dvec3());
        let crowding = f64::from(CROWDING * tint.w);
        let radiance_of = |to_light: DVec3, depth: f64| {
            let angles = Angles::of_dvectors(tangent, to_light, to_eye);
            let normals = [tangent.dot(normal), to_eye.dot(normal), to_light.dot(normal)];
            let place = Place::new(angles, to_light.dot(to_eye), outside, depth, normals);
            [look.light(angles, &place, &worn, crowding), look.sky(&place, &worn, crowding)].map(DVec3::from)
        };
        let mut radiance = frame.ambient.as_dvec3() * radiance_of(normal, outside)[1];
        for (i, light) in frame.lights.iter().map(|light| light.at(Vec3::ZERO)).enumerate() {
            let to_light = light.to_light.as_dvec3();
            let (rise, lateral) = (normal.dot(to_light), (1.0 - tangent.dot(to_light).powi(2)).max(0.0).sqrt());
            let [n, t] = [normal, tangent].map(|v| v.as_vec3());
            let (depth, open) = match i {
                // Of one fin nothing is known to bend.
                0 => (outside * lateral * reference::way_up(rise, 0.0, 1.0), reference::past_skin(rise, 0.0, 1.0)),
                _ => (slant_depth(outside as f32, light.to_light, n, t).into(), terminator(light.to_light, n).into()),
            };
            radiance += open * light.irradiance.as_dvec3() * radiance_of(to_light, depth)[0];
        }
        println!("facing {facing:.2}: {pixel:?} for {} and {alpha}", radiance * alpha);
        assert!(like(pixel, radiance * alpha, alpha), "{pixel:?} for {} and {alpha}", radiance * alpha);
        seen += usize::from(alpha > 0.1);
    }
    assert!(seen >= 1, "no fin was seen");
}
