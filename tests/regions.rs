//! Two presets on one skin, and the passage between them.

use furrier::asset::{self, Fallback};
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::data::coat::{Coat, CoatPrimitive};
use furrier::data::shell::{Incidence, Stack, slab_optical_depth};
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Mat4, Vec3, Vec4};
use furrier::preset::Preset;
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{DrawList, Frame, Picture, Show};
use furrier::viewer::stage;
use std::collections::BTreeMap;
use std::path::Path;

const PIXELS: u32 = 192;
/// Columns of the picture that are averaged.
const BINS: usize = 24;

/// A bare preset with this much hair, upright.
fn preset(guard_per_cm2: f32, length_mm: f32, rest: &str) -> String {
    format!(
        "size_m = 0.3\n[guard]\ndensity_per_cm2 = {guard_per_cm2}\nlength = {{ mm = {length_mm} }}\n[undercoat]\n\
         density_per_cm2 = 0\n[groom]\ncomb = \"upright\"\nlean_deg = 0\ngravity = 0\n[colour]\nfrom = \"preset\"\n\
         [shells]\nlayers = 8\ntexture_size = 64\n[fins]\ntexture_width = 16\ntexture_height = 16\n{rest}"
    )
}

/// The plane with sparse long hair at the left, dense shorter hair at the right, and a ramp in between.
fn baked(folder: &Path) -> (asset::Asset, Coat) {
    let ramp = image::GrayImage::from_fn(64, 4, |x, _| {
        image::Luma([((x as f32 - 16.0) / 32.0 * 255.0).clamp(0.0, 255.0) as u8])
    });
    ramp.save(folder.join("ramp.png")).unwrap();
    std::fs::write(folder.join("dense.toml"), preset(300.0, 6.0, "")).unwrap();
    let regions = "[[regions]]\npreset = \"dense.toml\"\nmap = \"ramp.png\"\n";
    std::fs::write(folder.join("sparse.toml"), preset(80.0, 8.0, regions)).unwrap();
    baked_as("sample:plane".as_ref(), folder, "sparse.toml", Fallback::Shells(2))
}

/// A file baked with a preset of the folder.
fn baked_as(input: &Path, folder: &Path, own: &str, fallback: Fallback) -> (asset::Asset, Coat) {
    let out = folder.join("out.glb");
    let request = Request {
        input: input.to_string_lossy().into_owned(),
        reading: Default::default(),
        out: out.clone(),
        preset: Preset::load(&folder.join(own).to_string_lossy()).unwrap(),
        presets: vec![],
        materials: vec![],
        units: Units::Metres,
        method: Method::Lapped,
        seed: 1,
        fallback,
        judge: false,
        cache: None,
        draft: false,
    };
    bake(&request, &mut |_| ()).unwrap();
    asset::read_coat(&out).unwrap()
}

/// A square of the plane `edge_m` wide along x, seen along a ray 40° off its normal, across the ramp.
fn view(edge_m: f32) -> Frame {
    let (sin, cos) = 40.0_f32.to_radians().sin_cos();
    let direction = Vec3::new(0.0, -cos, -sin);
    let scale = 2.0 / edge_m;
    Frame {
        clip_from_world: Mat4::from_cols(
            Vec4::new(scale, 0.0, 0.0, 0.0),
            Vec4::new(0.0, scale * direction.z / direction.y, -1.0, 0.0),
            Vec4::new(0.0, -scale, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.5, 1.0),
        ),
        eye: Vec4::from((-direction, 0.0)),
        size: [PIXELS; 2],
        lights: vec![],
        ambient: Vec3::ONE,
        shadow_map: false,
        depths: false,
        level: Some(0),
    }
}

/// Coverage of shells by columns of a picture of the whole plane, seen along a ray 40° off its normal, across the ramp.
fn columns(gpu: &Gpu, asset: &asset::Asset, coat: &Coat) -> Vec<f32> {
    let view = view(0.16);
    let textures = stage::textures(asset, coat).unwrap();
    let pose = asset.rest_pose().unwrap();
    let scene = stage::scene(asset, coat, &textures, &pose);
    let renderer = Renderer::new(gpu, &coat.tiles, 1).unwrap();
    let show = Show { skin: false, shells: true, fins: false };
    let picture = renderer.prepare(&scene).unwrap().draw(&view, show).unwrap().picture;
    let width = PIXELS as usize / BINS;
    (0..BINS)
        .map(|bin| {
            let inside = |i: &usize| i % PIXELS as usize / width == bin;
            let sum: f32 = (0..picture.pixels.len()).filter(inside).map(|i| picture.pixels[i][3]).sum();
            sum / (picture.pixels.len() / BINS) as f32
        })
        .collect()
}

/// Whether coverage rises all the way from the left to the right, but for the noise of hair.
fn rises(columns: &[f32]) -> bool {
    let mut highest = 0.0_f32;
    columns.iter().all(|&c| {
        let falls = c < highest - 0.015;
        highest = highest.max(c);
        !falls
    })
}

/// Greatest step between neighbouring columns.
fn step(columns: &[f32]) -> f32 {
    columns.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max)
}

#[test]
fn coverage_rises_from_one_tile_to_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(folder.path());
    let kinds: Vec<_> = coat.primitives.iter().map(|p| (p.tile, p.blend.as_ref().map(|b| b.tile))).collect();
    assert_eq!(kinds, [(0, None), (0, Some(1)), (1, None)], "one tile where one is enough");

    // Every triangle once, and what lies at one vertex lies at one place.
    let whole = asset.parts[0].stored.triangles.len();
    assert_eq!(coat.primitives.iter().map(|p| p.triangles.len()).sum::<usize>(), whole);
    let mut offsets: BTreeMap<u32, Vec3> = BTreeMap::new();
    for primitive in &coat.primitives {
        for (&v, &offset) in primitive.base_vertex.iter().zip(&primitive.offset) {
            assert!(
                offset.distance(*offsets.entry(v).or_insert(offset)) < 1e-6 * offset.length(),
                "vertex {v} is torn"
            );
        }
    }

    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let seen = columns(&gpu, &asset, &coat);
    println!("{seen:.3?}");
    assert!(rises(&seen));
    let (left, right) = (seen[2], seen[BINS - 3]);
    assert!(seen[BINS / 2] > left + 0.1 && seen[BINS / 2] < right - 0.05, "the middle is in the middle");
    // A step between columns is where the ramp's third and two thirds are, not where primitives meet.
    let noise = step(&seen[..5]).max(step(&seen[19..]));
    let ramp = (right - left) / 10.0;
    println!("steps: at most {:.3}; hair alone {noise:.3}, ramp {ramp:.3}", step(&seen));
    assert!(step(&seen) < noise + 2.0 * ramp);

    // Planted: the second tile left out of the passage.
    let mut faulty = coat.clone();
    let thinned = |p: &CoatPrimitive| match &p.blend {
        Some(blend) => p.tint.iter().zip(&blend.weight).map(|(t, w)| t.truncate().extend(t.w * (1.0 - w))).collect(),
        None => p.tint.clone(),
    };
    faulty.primitives.iter_mut().for_each(|p| (p.tint, p.blend) = (thinned(p), None));
    let seen = columns(&gpu, &asset, &faulty);
    println!("planted {seen:.3?}");
    assert!(!rises(&seen), "half a passage passes");
}

/// What the product draws where the passage's second tile has weight `w` everywhere, after `fault`: shells alone, 40° off the
/// plane's normal.
fn passage(gpu: &Gpu, asset: &asset::Asset, worn: &CoatPrimitive, coat: &Coat, fault: &Fault<'_>) -> Picture {
    let coat = Coat { primitives: vec![worn.clone()], ..coat.clone() };
    let textures = stage::textures(asset, &coat).unwrap();
    let mut scene = stage::scene(asset, &coat, &textures, &asset.rest_pose().unwrap());
    fault(&mut scene);
    let show = Show { skin: false, shells: true, fins: false };
    // Well inside the strip that the passage is.
    let view = Frame { size: [PIXELS / 2; 2], ..view(0.06) };
    let renderer = Renderer::new(gpu, &coat.tiles, 1).unwrap();
    renderer.prepare(&scene).unwrap().draw(&view, show).unwrap().picture
}

/// A change to what is drawn.
type Fault<'a> = dyn Fn(&mut DrawList<'_>) + 'a;

fn at_weight(worn: &CoatPrimitive, w: f32) -> CoatPrimitive {
    let mut worn = worn.clone();
    worn.blend.as_mut().unwrap().weight.fill(w);
    worn
}

/// How far optical depths of a passage, as drawn after `fault`, are from (1 − w) of the first tile's and w of the second's,
/// each drawn alone: the greatest mean size of the difference over the weights, as a share of the mean depth.
pub fn depths_off(fault: &Fault<'_>) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(folder.path());
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let worn = &coat.primitives[1];
    let depths = |worn: &CoatPrimitive, fault: &Fault<'_>| -> Vec<f32> {
        passage(&gpu, &asset, worn, &coat, fault).pixels.iter().map(|p| -(1.0 - p[3]).ln()).collect()
    };
    let alone = CoatPrimitive { blend: None, ..worn.clone() };
    let into = worn.blend.as_ref().unwrap().tile;
    let scale = coat.tiles[worn.tile].edge_m / coat.tiles[into].edge_m;
    let uv = worn.uv.iter().map(|uv| *uv * scale).collect();
    let [first, second] = [alone.clone(), CoatPrimitive { tile: into, uv, ..alone }].map(|w| depths(&w, &|_| ()));
    let n = first.len() as f32;
    let off = |w: f32| {
        let drawn = depths(&at_weight(worn, w), fault);
        let expected = first.iter().zip(&second).map(|(a, b)| (1.0 - w) * a + w * b);
        let (mut off, mut sum) = (0.0, 0.0);
        for (drawn, expected) in drawn.iter().zip(expected) {
            (off, sum) = (off + (drawn - expected).abs() / n, sum + expected / n);
        }
        println!("weight {w}: depth {sum:.3} in the mean, {off:.4} off");
        off / sum
    };
    [0.0, 0.25, 0.5, 0.75, 1.0].map(off).into_iter().fold(0.0, f32::max)
}

/// What a shell hides that is too clear to be drawn, and eight bits of opacity.
pub const DEPTHS_ALIKE: f32 = 0.01;

#[test]
fn between_two_tiles_the_optical_depth_is_their_mean_by_weight() {
    let off = depths_off(&|_| ());
    assert!(off < DEPTHS_ALIKE, "{off}");
}

/// A passage from a tile into the same tile, at weights of one half: how much more of the second's hair is seen than of the
/// first's, over both. Of mixed hair it is as much.
fn second_prevails(fault: &Fault<'_>) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(folder.path());
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let mut worn = at_weight(&coat.primitives[1], 0.5);
    worn.tile = worn.blend.as_ref().unwrap().tile;
    let [first, second] = [0, 1].map(|black| {
        let drawn = passage(&gpu, &asset, &worn, &coat, &|scene| {
            fault(scene);
            scene.furs[1 - black].tint.to_mut().iter_mut().for_each(|tint| *tint = Vec4::new(0.0, 0.0, 0.0, tint.w));
        });
        drawn.pixels.iter().map(|p| p[0]).sum::<f32>()
    });
    (second - first) / (second + first)
}

#[test]
fn two_tiles_on_one_shell_take_turns_in_which_is_above() {
    let in_turn = second_prevails(&|_| ());
    let one_above = second_prevails(&|scene| scene.furs[1].over_last = false);
    println!("the second prevails by {in_turn:.4} in turn, {one_above:.4} if always above");
    assert!(in_turn.abs() < 0.01 && one_above > 0.02, "{in_turn}, {one_above}");
}

/// How much of what is seen is the second tile's hair: what mixed hair would show less what slabs drawn over one another do, mean
/// and root mean square over a tile. `over` says of each slab whether the second tile is drawn over the first.
fn colour_error(stacks: &[Stack<'_>], layers: usize, theta_deg: f32, w: f32, over: impl Fn(usize) -> bool) -> [f32; 2] {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    let seen = Incidence::new(Vec3::new(sin, 0.0, -cos), furrier::math::Mat3::IDENTITY, 1.0 / 64.0);
    let depth = |tile: usize, layer: usize, uv| {
        let stack: &Stack<'_> = &stacks[tile];
        stack.gain(layer, &seen) * slab_optical_depth(&stack.fetch(layer, uv, &seen), &seen, stack.slab_m(layer))
    };
    let errors: Vec<f32> = (0..1024)
        .map(|i| {
            let uv = furrier::math::Vec2::new((i % 32) as f32 + 0.5, (i / 32) as f32 + 0.5) / 32.0;
            let (mut through, mut error) = (1.0, 0.0);
            for layer in (1..layers).rev() {
                let (a, b) = ((1.0 - w) * depth(0, layer, uv), w * depth(1, layer, uv));
                let opacity = |depth: f32| -f32::exp_m1(-depth);
                let mixed = if a + b > 0.0 { opacity(a + b) * b / (a + b) } else { 0.0 };
                let drawn = opacity(b) * if over(layer) { 1.0 } else { 1.0 - opacity(a) };
                error += through * (drawn - mixed);
                through *= (-a - b).exp();
            }
            error
        })
        .collect();
    let mean = |of: &dyn Fn(f32) -> f32| errors.iter().map(|&e| of(e)).sum::<f32>() / errors.len() as f32;
    [mean(&|e| e), mean(&|e| e * e).sqrt()]
}

/// Two tiles on the same shells are drawn one over the other: opacity is exact, colour leans to the one above. They take turns
/// from slab to slab, and little is left.
#[test]
fn colours_of_a_passage_are_nearly_those_of_mixed_hair() {
    let folder = tempfile::tempdir().unwrap();
    let (_, coat) = baked(folder.path());
    let stacks: Vec<_> = coat.tiles.iter().map(Stack::new).collect();
    let layers = coat.tiles[0].shells.layers as usize;
    let mut worst = [0.0_f32; 2];
    for theta in [0.0, 40.0, 70.0] {
        for w in [0.25, 0.5, 0.75] {
            let one_above = colour_error(&stacks, layers, theta, w, |_| true);
            let in_turn = colour_error(&stacks, layers, theta, w, |layer| layer % 2 == 0);
            println!("{theta}°, {w}: one above {one_above:.4?}, in turn {in_turn:.4?}");
            worst = [worst[0].max(one_above[0].abs()), worst[1].max(in_turn[0].abs())];
        }
    }
    assert!(worst[1] < 0.005 && worst[1] < 0.25 * worst[0], "{worst:?}");
}

/// The plane in two materials, of which the right one is a region of the other's preset.
fn of_materials(folder: &Path, reach: &str) -> (asset::Asset, Coat) {
    let mut document = asset::load("sample:plane").unwrap().document;
    let whole = document.json["meshes"][0]["primitives"][0].clone();
    let indices = document.integers(whole["indices"].as_u64().unwrap() as usize, 1).unwrap();
    let accessor = whole["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let x: Vec<f32> = document.floats(accessor, 3).unwrap().chunks(3).map(|p| p[0]).collect();
    let mut primitives = Vec::new();
    for (side, name) in ["body", "mane"].into_iter().enumerate() {
        let right = |t: &[u32]| t.iter().map(|&v| x[v as usize]).sum::<f32>() > 0.0;
        let own: Vec<u32> = indices.chunks(3).filter(|t| usize::from(right(t)) == side).flatten().copied().collect();
        let bytes: Vec<u8> = own.iter().copied().flat_map(u32::to_le_bytes).collect();
        let view = document.push_view(&bytes, Some(34963));
        let accessor =
            serde_json::json!({"bufferView": view, "componentType": 5125, "count": own.len(), "type": "SCALAR"});
        let mut primitive = whole.clone();
        primitive["indices"] = document.push("accessors", accessor).into();
        primitive["material"] = document.push("materials", serde_json::json!({"name": name})).into();
        primitives.push(primitive);
    }
    document.json["meshes"][0]["primitives"] = serde_json::json!(primitives);
    let input = folder.join("two.glb");
    std::fs::write(&input, document.to_glb().unwrap()).unwrap();
    std::fs::write(folder.join("mane.toml"), preset(300.0, 6.0, "")).unwrap();
    let regions = format!("[[regions]]\npreset = \"mane.toml\"\nmaterial = \"mane\"\nreach = {{ mm = {reach} }}\n");
    std::fs::write(folder.join("body.toml"), preset(80.0, 8.0, &regions)).unwrap();
    baked_as(&input, folder, "body.toml", Fallback::None)
}

#[test]
fn a_region_reaches_across_the_border_of_its_material() {
    let folder = tempfile::tempdir().unwrap();
    let passing = |reach: &str| {
        let (asset, coat) = of_materials(folder.path(), reach);
        // Share of the mane's tile along x: of what passes, and 0 or 1 of what does not.
        let mut along: Vec<(f32, f32)> = Vec::new();
        for primitive in &coat.primitives {
            let part = asset.parts.iter().find(|part| part.primitive == primitive.primitive).unwrap();
            for (v, &base) in primitive.base_vertex.iter().enumerate() {
                let x = part.stored.positions[base as usize].x;
                along.push((x, primitive.blend.as_ref().map_or(primitive.tile as f32, |blend| blend.weight[v])));
            }
        }
        along
    };
    let within = |along: &[(f32, f32)], low: f32, high: f32| -> Vec<f32> {
        along.iter().filter(|(x, _)| (low..high).contains(x)).map(|(_, share)| *share).collect()
    };
    let wide = passing("60");
    assert!(within(&wide, 0.001, 1.0).iter().all(|&share| share == 1.0), "the mane is whole");
    let near = within(&wide, -0.05, -0.005);
    assert!(near.iter().any(|&share| share > 0.1 && share < 0.9), "{near:?}");
    assert!(within(&wide, -1.0, -0.062).iter().all(|&share| share == 0.0), "beyond its reach there is none");
}

#[test]
fn fallback_shells_of_a_passage_keep_the_colours_of_a_texture() {
    let folder = tempfile::tempdir().unwrap();
    let ramp = image::GrayImage::from_fn(16, 4, |x, _| image::Luma([(x * 17) as u8]));
    ramp.save(folder.path().join("ramp.png")).unwrap();
    let with = |rest: &str| preset(100.0, 6.0, rest).replace("from = \"preset\"", "from = \"asset\"");
    std::fs::write(folder.path().join("other.toml"), with("")).unwrap();
    let regions = "[[regions]]\npreset = \"other.toml\"\nmap = \"ramp.png\"\n";
    std::fs::write(folder.path().join("own.toml"), with(regions)).unwrap();
    let input = crate::painted::square(folder.path(), "square.glb", |_, _| [30, 200, 30], 4);
    let (asset, coat) = baked_as(&input, folder.path(), "own.toml", Fallback::Shells(2));
    assert!(coat.primitives.iter().any(|primitive| primitive.blend.is_some()));
    assert!(coat.primitives.iter().all(|primitive| primitive.colour.is_some()));
    let document = &asset.document;
    for primitive in document.json["meshes"][1]["primitives"].as_array().unwrap() {
        let colours = document.floats(primitive["attributes"]["COLOR_0"].as_u64().unwrap() as usize, 4).unwrap();
        assert!(colours.chunks(4).all(|c| c[1] > 0.4 && c[0] < 0.05), "{:?}", &colours[..4]);
    }
}
