//! Files that recreate reports, each as the table beside them says.

use super::{bake, close, hair_colour, load, says};
use crate::common::shared;
use furrier::asset::{self, Asset};
use furrier::bake::Baked;
use furrier::data::coat::Coat;
use furrier::error::{Error, Kind};
use std::path::{Path, PathBuf};

const RED: [f32; 3] = [0.5776, 0.0130, 0.0070];
const BROWN: [f32; 3] = [0.35, 0.2, 0.1];

/// A file of the folder, and how baking it ended.
struct Case {
    path: PathBuf,
    result: Result<(Baked, Asset, Coat), Error>,
}

impl Case {
    fn new(path: PathBuf, out: &Path) -> Self {
        let result = bake(&path, out).map(|baked| {
            let (asset, coat) = asset::read_coat(out).unwrap();
            (baked, asset, coat)
        });
        Self { path, result }
    }

    fn baked(&self) -> &(Baked, Asset, Coat) {
        self.result.as_ref().unwrap_or_else(|error| panic!("{}: {error}", self.path.display()))
    }

    fn warns(&self, words: &[&str]) -> bool {
        says(&self.baked().0.warnings, words)
    }

    fn colour(&self, expected: [f32; 3]) -> bool {
        let found = hair_colour(&self.path);
        assert!(close(found, expected), "{}: {found}, not {expected:?}", self.path.display());
        true
    }

    fn refused(&self, field: &str, words: &[&str]) -> bool {
        let Err(error) = &self.result else { panic!("{} was accepted", self.path.display()) };
        let said = [format!("{error}"), error.hint.clone().unwrap_or_default()];
        error.kind == Kind::Input
            && error.field.as_deref() == Some(field)
            && words.iter().all(|word| said.iter().any(|s| s.contains(word)))
    }

    /// Triangles of the skin that wear fur.
    fn triangles(&self) -> usize {
        self.baked().2.primitives.iter().map(|primitive| primitive.triangles.len()).sum()
    }
}

/// Whether a file ended as the table says; none for a file that other tests look at.
fn right(name: &str, case: &Case) -> Option<bool> {
    Some(match name {
        "obj_comment_backslash.obj" => {
            let bom = load(&case.path.with_file_name("obj_bom_mtllib.obj"));
            load(&case.path).parts[0].stored.triangles == bom.parts[0].stored.triangles
        }
        "obj_bom_mtllib.obj" | "obj_mtl_tabs.obj" | "obj_map_backslash.obj" => case.colour(RED),
        "obj_mixed_vt.obj" => case.warns(&["no texture coordinate"]) && case.colour(RED),
        "obj_kd_only.obj" => case.colour([0.05, 0.5, 0.08]),
        "backslash_base.gltf" => case.colour(RED),
        "backslash_normal.gltf" => case.colour([0.4, 0.2, 0.1]),
        "specular_glossiness.glb" => {
            let asset = load(&case.path);
            asset.parts[0].base_colour.factor.x == 0.9 && case.baked().2.primitives[0].colour.is_some()
        }
        "basisu_no_source.glb" => case.warns(&["images[0]", "KTX2 texture that cannot be decoded", "\"Fur\""]),
        "hidden_prop_scale0.glb" => case.baked().0.materials == ["Fur"] && case.warns(&["nodes[1]", "without fur"]),
        "name_not_utf8.glb" => case.warns(&["Latin-1", "PELUCHE"]) && case.colour(BROWN),
        "json_nul_padding.glb" => case.warns(&["padded with", "zeros"]),
        "one_mesh_two_skins.glb" | "mesh_skinned_and_static.glb" => case.baked().1.parts[0].nodes.len() == 2,
        "lods_by_name.glb" => {
            case.warns(&["Beast_LOD0", "Beast_LOD1, Beast_LOD2", "without fur"]) && case.baked().2.primitives.len() == 1
        }
        "msft_lod.glb" => case.warns(&["Beast_LOD0", "Beast_LOD1", "without fur"]),
        "avatar0.vrm" | "avatar1.vrm" => {
            let left = ["FaceMouth", "EyeIris", "FaceBrow", "FaceEyeline"];
            let furred = &case.baked().0.materials;
            !furred.iter().any(|name| left.iter().any(|bare| name.contains(bare)))
                && furred.iter().any(|name| name == "Hat")
        }
        "eye_names.glb" => {
            case.baked().0.materials == ["Fur"] && says(&case.baked().0.notes, &["fur on Fur", "Glasses"])
        }
        "variants.glb" => {
            case.warns(&["\"Fur brown\", #a07c59", "\"Fur white\", #f3f3f1, in winter"]) && case.colour(BROWN)
        }
        "gltf1.gltf" | "gltf1_number.gltf" => case.refused("asset.version", &["glTF 1.0", "gltf-pipeline"]),
        "null_members.glb" => case.refused("animations", &["null", "leave out"]),
        "sixty_meshes_cm.glb" => case.baked().2.primitives.len() == 60 && says(&case.baked().0.notes, &["draw calls"]),
        "with_ground.glb" => case.baked().0.materials.iter().all(|name| name != "Ground"),
        "cube_12_triangles.glb" => case.triangles() == 12,
        "morph_mouth_cubic.glb" => {
            let (_, asset, coat) = case.baked();
            // No holes: every triangle of the skin wears fur.
            coat.primitives.iter().map(|p| p.triangles.len()).sum::<usize>()
                == asset.parts.iter().map(|part| part.stored.triangles.len()).sum::<usize>()
        }
        "ball_in_two_primitives.glb" | "leopard_low.glb" | "ear_double_sided.glb" | "painted.glb" => {
            case.baked();
            return None;
        }
        // Combed by `--up`; told as one that wears a coat.
        "zup.obj" | "roundtrip_keeps_extras.glb" => return None,
        _ => panic!("{name} has no check"),
    })
}

#[test]
fn every_wild_file_ends_as_its_readme_says() {
    let Some(folder) = shared().map(|shared| shared.join("wild")) else { return };
    let out = tempfile::tempdir().unwrap();
    let (mut faults, mut seen) = (Vec::new(), 0);
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    for name in names.iter().filter(|name| [".glb", ".gltf", ".obj", ".vrm"].iter().any(|end| name.ends_with(end))) {
        let case = Case::new(folder.join(name), &out.path().join("out.glb"));
        seen += 1;
        if right(name, &case) == Some(false) {
            let said = case
                .result
                .as_ref()
                .map_or_else(|e| format!("{e}"), |(baked, ..)| format!("{:?} {:?}", baked.notes, baked.warnings));
            faults.push(format!("{name}: {said}"));
        }
    }
    assert!(seen >= 34, "{seen} files");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn chequers_of_a_diffuse_texture_are_those_of_hair() {
    let Some(path) = shared().map(|shared| shared.join("wild/specular_glossiness.glb")) else { return };
    let asset = load(&path);
    let texture = asset.parts[0].base_colour.texture.clone().expect("a texture");
    let image = asset.document.decode_image(texture.image).unwrap().expect("a picture");
    let grown = crate::one_skin::grown(
        &path,
        &crate::one_skin::thin(&["colour.variation=0", "colour.guard=[[1,1,1],[1,1,1],[1,1,1]]"]),
    );
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let uv = &scene.skin.uv_sets[0];
    let mut kinds = std::collections::BTreeSet::new();
    for (root, tint) in strands.roots.iter().zip(&strands.tint) {
        let [p, q, r] = scene.skin.triangles[root.triangle as usize].map(|v| uv[v as usize]);
        let [x, y] = root.barycentric;
        let expected = 0.9 * texture.sample(&image, p * x + q * y + r * (1.0 - x - y)).truncate();
        assert!((*tint - expected).abs().max_element() < 2e-3, "{tint} instead of {expected}");
        kinds.insert((expected.max_element() * 4.0) as i32);
    }
    assert!(kinds.len() > 1, "one colour alone: {kinds:?}");
}
