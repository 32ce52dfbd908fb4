//! The crate `gltf` as an independent witness: it reads what we read and what we wrote, and finds the same triangles,
//! joints, weights, morph targets and poses.

mod reading;

use crate::common::shared;
use crate::made::coat_for;
use crate::poses::animated;
use furrier::asset::coat::{NAME, with_coat};
use furrier::asset::stored::Influences;
use furrier::asset::{self, Asset, Document, Fallback, Part, Pose};
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::data::coat::Coat;
use furrier::math::{DVec3, Vec3};
use furrier::preset::Preset;
use reading::{Moment, Reading, turned};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

/// How far apart two positions may be, over the asset's diagonal: what is left of f32 coordinates.
const NEAR: f64 = 2e-6;

/// One moment as both see it.
struct Both {
    name: String,
    ours: Pose,
    theirs: Moment,
}

/// Rest, every morph target alone, and three times of every animation.
fn moments(asset: &Asset, reading: &Reading) -> Vec<Both> {
    let both = |name: String, ours: Pose, theirs: Moment| Both { name, ours, theirs };
    let rest = both("at rest".into(), asset.rest_pose().expect("a pose"), reading.moment(None));
    let targets = asset.parts.iter().map(|part| part.stored.morphs.len()).max().unwrap_or(0);
    let mut all = vec![];
    for target in 0..targets {
        let alone = |weights: &[Vec<f64>]| -> Vec<Vec<f64>> {
            weights.iter().map(|own| (0..own.len()).map(|k| f64::from(u8::from(k == target))).collect()).collect()
        };
        let ours = Pose { weights: alone(&rest.ours.weights), ..rest.ours.clone() };
        let theirs = Moment { weights: alone(&rest.theirs.weights), ..rest.theirs.clone() };
        all.push(both(format!("target {target} alone"), ours, theirs));
    }
    for animation in 0..reading.gltf.animations().count() {
        for share in [0.13, 0.5, 0.81] {
            let seconds = share * reading.duration_s(animation);
            let ours = asset.pose(animation, seconds).expect("a pose");
            all.push(both(
                format!("animation {animation} at {seconds} s"),
                ours,
                reading.moment(Some((animation, seconds))),
            ));
        }
    }
    all.push(rest);
    all
}

/// Farthest that two lists of points are apart, over `diagonal`.
fn apart(ours: impl Iterator<Item = DVec3>, theirs: &[DVec3], diagonal: f64) -> f64 {
    ours.zip(theirs).map(|(a, b)| a.distance(*b) / diagonal).fold(0.0, f64::max)
}

fn same_weights(ours: &Influences, theirs: &BTreeMap<u16, f32>) -> bool {
    let held = ours.iter().filter(|(_, share)| *share > 0.0);
    held.clone().count() == theirs.len()
        && held.clone().all(|(joint, share)| theirs.get(joint).is_some_and(|t| (t - share).abs() < 1e-6))
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// What of a part the witness sees otherwise.
fn of_part(asset: &Asset, part: &Part, reading: &Reading, moments: &[Both]) -> Vec<String> {
    let mesh = reading.gltf.meshes().nth(part.mesh).expect("a mesh");
    let theirs = reading.primitive(&mesh.primitives().nth(part.primitive).expect("a primitive"));
    let mut found = Vec::new();
    let mut check = |holds: bool, what: &str| {
        if !holds {
            found.push(format!("meshes[{}].primitives[{}]: {what}", part.mesh, part.primitive));
        }
    };
    let stored = &part.stored;
    // Vertices that no triangle uses are not kept.
    let kept = |v: usize| stored.source[v] as usize;
    let all = 0..stored.positions.len();
    check(all.clone().all(|v| stored.positions[v] == theirs.positions[kept(v)]), "positions");
    // Those that wind against their normals are turned as they are read, and a warning says so.
    let against = asset.warnings.iter().any(|warning| warning.contains("wind against their normals"));
    let form = |t: &[u32; 3]| if against { sorted(*t) } else { turned(*t) };
    let triangles: Vec<[u32; 3]> = stored.triangles.iter().map(|t| t.map(|v| kept(v as usize) as u32)).collect();
    check(triangles.iter().map(form).eq(theirs.triangles.iter().map(form)), "triangles");
    let influences = stored.influences.as_deref().unwrap_or_default();
    check(
        influences.is_empty() == theirs.weights.is_empty()
            && influences.iter().enumerate().all(|(v, a)| same_weights(a, &theirs.weights[kept(v)])),
        "joints and weights",
    );
    let same = |ours: &[Vec3], theirs: &[Vec3]| {
        ours.is_empty() == theirs.is_empty() && ours.iter().enumerate().all(|(v, p)| *p == theirs[kept(v)])
    };
    let mut morphs = stored.morphs.iter().zip(&theirs.morphs);
    let alike = morphs.all(|(morph, [p, n])| same(&morph.positions, p) && same(&morph.normals, n));
    check(alike && stored.morphs.len() == theirs.morphs.len(), "morph targets");
    check(part.nodes == reading.shown(part.mesh), "nodes that show it");
    for &node in &part.nodes {
        for Both { name, ours, theirs: moment } in moments {
            let posed = part.posed(asset, ours, node, 1.0);
            let ours = posed.positions_m.iter().map(|p| p.as_dvec3() + part.centre_units);
            let places = reading.places(&theirs, node, moment);
            let places: Vec<_> = all.clone().map(|v| places[kept(v)]).collect();
            let off = apart(ours, &places, asset.diagonal_units);
            check(off < NEAR, &format!("node {node} {name}, {off} of the diagonal off"));
        }
    }
    found
}

/// What of an asset the witness, who reads `bytes`, sees otherwise.
pub fn departures(asset: &Asset, bytes: &[u8]) -> Vec<String> {
    let reading = Reading::of(bytes);
    let moments = moments(asset, &reading);
    asset.parts.iter().flat_map(|part| of_part(asset, part, &reading, &moments)).collect()
}

fn parsed(bytes: &[u8], name: &str) -> Asset {
    let mut warnings = Vec::new();
    let document = Document::parse(bytes, Path::new(name), &mut warnings).expect("it is read");
    Asset::new(document, warnings).expect("it is sound")
}

/// Files of all kinds: every sample, animations made here, and, where they are there, files by others.
fn inputs() -> Vec<(String, Vec<u8>)> {
    let of = |asset: Asset| asset.document.to_glb().expect("a GLB");
    let mut all: Vec<(String, Vec<u8>)> = asset::sample::NAMES
        .iter()
        .map(|name| (format!("sample:{name}"), of(asset::load(&format!("sample:{name}")).expect("a sample"))))
        .collect();
    let spline = [0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.2, 0.0].repeat(2);
    all.push(("a spline".into(), of(animated("rotation", 4, "CUBICSPLINE", &[0.5, 2.0], &spline))));
    let steps = [1.0, 2.0, 3.0, 0.5, 0.7, 0.9, 2.0, 1.0, 1.0];
    all.push(("steps".into(), of(animated("scale", 3, "STEP", &[0.0, 1.0, 2.5], &steps))));
    let Some(shared) = shared() else { return all };
    #[rustfmt::skip]
    let files = [
        "real/Fox", "real/MorphStressTest", "real/RiggedSimple", "real/quaternius_Deer", "real/spot",
        "hard/skinned_animated", "hard/morph_targets", "hard/instanced_nodes", "hard/interleaved", "hard/sparse_accessor",
        "hard/mode_triangle_strip", "hard/mode_triangle_fan", "hard/node_scale_nonuniform_negative",
        "hard/multi_material", "hard/offset_1e6", "hard/scale_1e-6", "hard/positions_only",
    ];
    all.extend(files.map(|name| {
        let bytes = std::fs::read(shared.join(name).with_extension("glb")).expect("the file is there");
        (name.to_owned(), bytes)
    }));
    all
}

#[test]
fn the_witness_reads_inputs_as_we_do() {
    for (name, bytes) in inputs() {
        assert_eq!(departures(&parsed(&bytes, &name), &bytes), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn the_witness_finds_the_input_in_what_we_write() {
    for (name, bytes) in inputs() {
        let asset = parsed(&bytes, &name);
        let written =
            with_coat(&asset, &coat_for(&asset), Fallback::Shells(2)).expect("dressed").to_glb().expect("a GLB");
        assert_eq!(departures(&asset, &written), Vec::<String>::new(), "{name}");
        let (again, reading) = (parsed(&written, &name), Reading::of(&written));
        let coat = asset::coat::coat_of(&again).expect("a coat");
        assert_eq!(coat_departures(&again, &coat, &reading), Vec::<String>::new(), "{name}");
    }
}

/// The accessor whose number stands at `pointer` of `json`, as lists of numbers.
fn numbers(reading: &Reading, json: &serde_json::Value, pointer: &str) -> Vec<f64> {
    use gltf::accessor::{DataType, Dimensions, Iter};
    let index = json.pointer(pointer).and_then(|v| v.as_u64()).expect("an accessor") as usize;
    let accessor = reading.gltf.accessors().nth(index).expect("an accessor");
    let get = |buffer: gltf::Buffer<'_>| reading.bytes(buffer);
    match (accessor.data_type(), accessor.dimensions()) {
        (DataType::U8, Dimensions::Scalar) => Iter::<u8>::new(accessor, get).expect("bytes").map(f64::from).collect(),
        (DataType::U16, Dimensions::Scalar) => {
            Iter::<u16>::new(accessor, get).expect("numbers").map(f64::from).collect()
        }
        (DataType::U32, Dimensions::Scalar) => {
            Iter::<u32>::new(accessor, get).expect("numbers").map(f64::from).collect()
        }
        (DataType::F32, Dimensions::Scalar) => {
            Iter::<f32>::new(accessor, get).expect("numbers").map(f64::from).collect()
        }
        (DataType::F32, Dimensions::Vec2) => {
            Iter::<[f32; 2]>::new(accessor, get).expect("pairs").flatten().map(f64::from).collect()
        }
        (DataType::F32, Dimensions::Vec3) => {
            Iter::<[f32; 3]>::new(accessor, get).expect("vectors").flatten().map(f64::from).collect()
        }
        other => panic!("an accessor of {other:?}"),
    }
}

/// What of a coat the witness sees otherwise: its vertices, and that its triangles are the skin's.
fn coat_departures(asset: &Asset, coat: &Coat, reading: &Reading) -> Vec<String> {
    let mut found = Vec::new();
    for (i, worn) in coat.primitives.iter().enumerate() {
        let before =
            coat.primitives[..i].iter().filter(|p| (p.mesh, p.primitive) == (worn.mesh, worn.primitive)).count();
        let mesh = reading.gltf.meshes().nth(worn.mesh).expect("a mesh");
        let primitive = mesh.primitives().nth(worn.primitive).expect("a primitive");
        let extension = primitive.extension_value(NAME).expect("a coat");
        let json = if before == 0 { extension } else { &extension["more"][before - 1] };
        let mut check = |holds: bool, what: &str| {
            if !holds {
                found.push(format!("coat {i}: {what}"));
            }
        };
        let same = |pointer: &str, ours: &mut dyn Iterator<Item = f64>| ours.eq(numbers(reading, json, pointer));
        let part = asset.parts.iter().find(|part| (part.mesh, part.primitive) == (worn.mesh, worn.primitive));
        let source = &part.expect("a part").stored.source;
        let base = |v: u32| source[worn.base_vertex[v as usize] as usize];
        let based: Vec<f64> = (0..worn.base_vertex.len() as u32).map(|v| f64::from(base(v))).collect();
        check(same("/attributes/BASE_VERTEX", &mut based.into_iter()), "base vertices");
        let of = |list: &[Vec3]| -> Vec<f64> { list.iter().flat_map(|v| v.as_dvec3().to_array()).collect() };
        check(same("/attributes/OFFSET", &mut of(&worn.offset).into_iter()), "offsets");
        let uv = worn.uv.iter().flat_map(|uv| uv.as_dvec2().to_array());
        check(same("/attributes/TEXCOORD_0", &mut uv.collect::<Vec<_>>().into_iter()), "texture coordinates");
        let indices: Vec<usize> = numbers(reading, json, "/indices").iter().map(|&v| v as usize).collect();
        let on_skin = |t: &[usize]| sorted([t[0], t[1], t[2]].map(|v| base(v as u32)));
        let skin: HashSet<[u32; 3]> = reading.primitive(&primitive).triangles.into_iter().map(sorted).collect();
        check(indices.chunks_exact(3).all(|t| skin.contains(&on_skin(t))), "triangles that are not the skin's");
        check(indices.len() == 3 * worn.triangles.len(), "as many triangles");
    }
    found
}

/// Whether at most one morph target is on, and that wholly: shells, whose offsets turn with the skin, follow exactly there.
fn one_target(weights: &[f64]) -> bool {
    weights.iter().all(|w| *w == 0.0 || *w == 1.0) && weights.iter().sum::<f64>() <= 1.0
}

/// What of the plain shells of a baked file the witness sees otherwise: they move as the coat does, on the skin's joints,
/// weights and morph targets. There are `shells` of them, one mesh for each that has a coat.
pub fn shell_departures(asset: &Asset, coat: &Coat, bytes: &[u8], shells: usize) -> Vec<String> {
    let reading = Reading::of(bytes);
    let moments = moments(asset, &reading);
    let furred: BTreeSet<usize> = coat.primitives.iter().map(|worn| worn.mesh).collect();
    let meshes: Vec<_> =
        reading.gltf.meshes().filter(|m| m.extension_value(NAME).is_some_and(|e| e["fallback"] == true)).collect();
    assert_eq!(meshes.len(), furred.len());
    let mut found = Vec::new();
    for (mesh, furred) in meshes.iter().zip(furred) {
        let coats: Vec<_> = coat.primitives.iter().filter(|worn| worn.mesh == furred).collect();
        assert_eq!(mesh.primitives().count(), coats.len() * shells, "shells of {:?}", mesh.name());
        for (k, primitive) in mesh.primitives().enumerate() {
            let (worn, shell) = (coats[k % coats.len()], k / coats.len());
            let (theirs, n) = (reading.primitive(&primitive), worn.base_vertex.len());
            let part =
                asset.parts.iter().find(|p| (p.mesh, p.primitive) == (worn.mesh, worn.primitive)).expect("a part");
            let mut check = |holds: bool, what: &str| {
                if !holds {
                    found.push(format!("{} {k}: {what}", mesh.name().unwrap_or_default()));
                }
            };
            let base = |v: usize| worn.base_vertex[v % n] as usize;
            let influences = part.stored.influences.as_deref().unwrap_or_default();
            let same = |v: usize| same_weights(&influences[base(v)], &theirs.weights[v]);
            check(influences.is_empty() || (0..theirs.positions.len()).all(same), "joints and weights");
            let own = |t: &[u32; 3]| turned(t.map(|v| v + (shell * n) as u32));
            let way = |t: [u32; 3]| if part.mirrored() { turned([t[0], t[2], t[1]]) } else { t };
            check(worn.triangles.iter().map(own).eq(theirs.triangles.iter().map(|&t| way(t))), "triangles");
            let nodes = reading.shown(mesh.index());
            check(nodes.len() == part.nodes.len(), "shells stand wherever the skin does");
            // In the middle of the slabs that it holds.
            let slabs = &coat.tiles[worn.tile].shells.slabs;
            let [bottom, top] = [shell, shell + 1].map(|shell| slabs.tops()[shell * slabs.count() / shells]);
            let height = 0.5 * (bottom + top);
            for (&node, &own) in nodes.iter().zip(&part.nodes) {
                for Both { name, ours, theirs: moment } in moments.iter().filter(|m| one_target(&m.ours.weights[own])) {
                    let posed = part.posed(asset, ours, own, 1.0);
                    let ours = (0..n).map(|v| {
                        let offset = posed.world_from_offset[base(v)] * worn.offset[v] * height;
                        (posed.positions_m[base(v)] + offset).as_dvec3() + part.centre_units
                    });
                    let places = reading.places(&theirs, node, moment);
                    let off = apart(ours, &places[shell * n..(shell + 1) * n], asset.diagonal_units);
                    check(off < NEAR, &format!("node {node} {name}, {off} of the diagonal off"));
                }
            }
        }
    }
    found
}

/// A file baked with hardly any hair and two plain shells, and its bytes.
pub fn baked(input: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    #[rustfmt::skip]
    let settings = [
        "shells.layers=4", "shells.texture_size=16", "shells.tile_mm=8", "fins.texture_width=16", "fins.texture_height=16",
        "colour.from=preset", "guard.density_per_cm2=40", "undercoat.density_per_cm2=200", "guard.length.mm=4", "undercoat.length.mm=3",
    ];
    let out = folder.path().join("out.glb");
    let request = Request {
        input: input.to_owned(),
        reading: Default::default(),
        out: out.clone(),
        preset: Preset::load("fox").and_then(|p| p.with_settings(&settings.map(str::to_owned))).expect("a preset"),
        presets: vec![],
        materials: vec![],
        units: Units::Auto,
        method: Method::Lapped,
        seed: 1,
        fallback: Fallback::Shells(2),
        judge: false,
        cache: None,
        draft: false,
    };
    bake(&request, &mut |_| ()).expect("it bakes");
    std::fs::read(out).expect("the output")
}

/// What the witness sees otherwise in a file that has a coat and two plain shells.
pub fn output_departures(bytes: &[u8], name: &str) -> Vec<String> {
    let asset = parsed(bytes, name);
    let coat = asset::coat::coat_of(&asset).expect("a coat");
    let mut found = departures(&asset, bytes);
    found.extend(coat_departures(&asset, &coat, &Reading::of(bytes)));
    found.extend(shell_departures(&asset, &coat, bytes, 2));
    found
}

#[test]
fn the_witness_reads_baked_files_as_we_do() {
    let mut inputs = vec!["sample:creature".to_owned()];
    let files = ["hard/morph_targets", "hard/instanced_nodes", "hard/node_scale_nonuniform_negative", "real/Fox"];
    if let Some(shared) = shared() {
        inputs.extend(files.map(|name| shared.join(name).with_extension("glb").to_string_lossy().into_owned()));
    }
    for input in inputs {
        assert_eq!(output_departures(&baked(&input), &input), Vec::<String>::new(), "{input}");
    }
}
