//! Shells as plain glTF, for viewers that do not know the extension.

use super::flatten;
use super::parts::{part_of, set_extension};
use super::place::place;
use super::vrm::{self, Added};
use crate::asset::accessor::AccessorLayout;
use crate::asset::document::Document;
use crate::asset::encode::Use;
use crate::asset::image::png;
use crate::asset::json::At;
use crate::asset::pose::turn;
use crate::asset::stored::Influences;
use crate::asset::{Asset, Part};
use crate::data::coat::{Blend, Coat, CoatPrimitive, Cut, Sampled};
use crate::error::Result;
use crate::math::{Vec3, Vec4};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr;

/// What viewers without the extension get to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fallback {
    /// The skin alone.
    None,
    /// This many shells of plain glTF over the skin, at most one per slab.
    Shells(u32),
}

impl FromStr for Fallback {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text.split_once(':') {
            None if text == "none" => Ok(Self::None),
            Some(("shells", count)) => match count.parse() {
                Ok(count @ 1..=255) => Ok(Self::Shells(count)),
                _ => Err(format!("`{count}` is not a number of shells from 1 to 255")),
            },
            _ => Err("expected `none` or `shells:N`".to_owned()),
        }
    }
}

/// Adds `count` shells for every coat primitive, inner to outer, in one mesh per base mesh.
///
/// All shells of a primitive share their vertex accessors and differ in their range of indices: viewers sort
/// transparent meshes by the middle of their bounds, and so keep them in this order. Gives the shells' materials, by tile.
///
/// # Errors
/// When the coat does not fit the asset.
pub fn add(document: &mut Document, asset: &Asset, coat: &Coat, count: u32) -> Result<Vec<Vec<usize>>> {
    let mut added = Added { materials: document.count("materials"), ..Added::default() };
    let materials = materials(document, asset, coat, count)?;
    let nearest: Vec<CoatPrimitive> = coat.primitives.iter().flat_map(|p| nearest(p, coat)).collect();
    let meshes: BTreeSet<usize> = nearest.iter().map(|p| p.mesh).collect();
    for mesh in meshes {
        let carried: Vec<&CoatPrimitive> = nearest.iter().filter(|p| p.mesh == mesh).collect();
        let mut stacks = Vec::new();
        for primitive in &carried {
            let part = part_of(asset, primitive)?;
            let tinted = coat.tiles[primitive.tile].sampled == Sampled::Square;
            stacks.push(stack(document, asset, part, primitive, &materials[primitive.tile], tinted)?);
        }
        let most = stacks.iter().map(Vec::len).max().unwrap_or(0);
        let primitives: Vec<Value> =
            (0..most).flat_map(|shell| stacks.iter().filter_map(move |stack| stack.get(shell).cloned())).collect();
        let base = &document.json["meshes"][mesh];
        let name = base["name"].as_str().unwrap_or("mesh").to_owned();
        let mut shells = json!({"name": format!("{name} fur shells"), "primitives": primitives});
        // Morph weights and the names that tools show for them.
        let names = &base["extras"]["targetNames"];
        if names.is_array() {
            shells["extras"] = json!({"targetNames": names});
        }
        if base["weights"].is_array() {
            shells["weights"] = base["weights"].clone();
        }
        set_extension(&mut shells, json!({"fallback": true}));
        let shells = document.push("meshes", shells);
        added.meshes.push((mesh, shells));
        let nodes: BTreeSet<usize> =
            part_of(asset, carried[0])?.nodes.iter().map(|&n| asset.scene.of_document(n)).collect();
        for node in nodes {
            added.nodes.push((node, place(document, &asset.scene, node, shells, &name)?));
        }
    }
    vrm::follow(document, &added);
    Ok(materials.iter().map(|shells| shells.iter().map(|(_, material)| *material).collect()).collect())
}

/// A coat primitive without passages: every triangle of one carries the tile that it has most of.
fn nearest(coat_primitive: &CoatPrimitive, coat: &Coat) -> Vec<CoatPrimitive> {
    let Some(blend) = &coat_primitive.blend else { return vec![coat_primitive.clone()] };
    let second = |t: usize| coat_primitive.triangles[t].iter().map(|&v| blend.weight[v as usize]).sum::<f32>() > 1.5;
    let scale = coat.tiles[coat_primitive.tile].edge_m / coat.tiles[blend.tile].edge_m;
    if let Some(cut) = &coat_primitive.cut {
        return nearest_cut(coat_primitive, cut, blend, scale);
    }
    let mut parts = [coat_primitive.part(|t| !second(t)), coat_primitive.part(second)];
    parts[1].tile = blend.tile;
    parts[1].uv.iter_mut().for_each(|uv| *uv *= scale);
    parts.into_iter().filter(|part| !part.triangles.is_empty()).collect()
}

/// The same of one that is cut.
fn nearest_cut(coat_primitive: &CoatPrimitive, cut: &Cut, blend: &Blend, scale: f32) -> Vec<CoatPrimitive> {
    let weight = |v: u32| -> f32 {
        let (corners, shares) = cut.inside[v as usize];
        corners.into_iter().zip(shares).map(|(corner, share)| blend.weight[corner as usize] * share).sum()
    };
    let (second, first): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
        cut.triangles.iter().partition(|t| t.iter().map(|&v| weight(v)).sum::<f32>() > 1.5);
    let of = |triangles: Vec<[u32; 3]>| CoatPrimitive {
        cut: Some(Cut { triangles, ..cut.clone() }),
        blend: None,
        ..coat_primitive.clone()
    };
    let mut into = CoatPrimitive { tile: blend.tile, ..of(second) };
    into.uv.iter_mut().for_each(|uv| *uv *= scale);
    let any = |part: &CoatPrimitive| part.cut.as_ref().is_some_and(|cut| !cut.triangles.is_empty());
    [of(first), into].into_iter().filter(any).collect()
}

/// Per tile, per shell: its height over the stack's, and a material with its texture.
fn materials(document: &mut Document, asset: &Asset, coat: &Coat, count: u32) -> Result<Vec<Vec<(f32, usize)>>> {
    let sampler =
        document.push("samplers", json!({"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}));
    let mut all = Vec::new();
    for (index, tile) in coat.tiles.iter().enumerate() {
        // Over skin that light does not change, shells that it does would be of another colour.
        let tiled = |p: &&CoatPrimitive| p.tile == index || p.blend.as_ref().is_some_and(|blend| blend.tile == index);
        let worn: Vec<&Part> =
            coat.primitives.iter().filter(tiled).map(|p| part_of(asset, p)).collect::<Result<_>>()?;
        let unlit = !worn.is_empty() && worn.iter().all(|part| part.unlit);
        let mut of_tile = Vec::new();
        for (shell, (height, image)) in flatten::shells(&tile.shells, tile.height_m, count).iter().enumerate() {
            let view = document.push_view(&png(image)?, None);
            let name = format!("{} fur shell {}", tile.preset, shell + 1);
            let image = document.push("images", json!({"name": name, "mimeType": "image/png", "bufferView": view}));
            let texture = document.push("textures", json!({"sampler": sampler, "source": image}));
            // Blended, not masked: a mask at one half erases sparse outer shells. Where limbs cross, the skin still
            // hides what is behind it; only fringes may be drawn in the wrong order.
            let mut material = json!({
                "name": name,
                "alphaMode": "BLEND",
                "pbrMetallicRoughness": {"baseColorTexture": {"index": texture}, "metallicFactor": 0.0, "roughnessFactor": 1.0},
            });
            if unlit {
                material["extensions"] = json!({"KHR_materials_unlit": {}});
            }
            of_tile.push((*height, document.push("materials", material)));
        }
        all.push(of_tile);
    }
    Ok(all)
}

/// The shells of one coat primitive as glTF primitives, inner to outer; `tinted` where their colours are still to be
/// multiplied by the coat's.
fn stack(
    document: &mut Document,
    asset: &Asset,
    part: &Part,
    coat_primitive: &CoatPrimitive,
    materials: &[(f32, usize)],
    tinted: bool,
) -> Result<Vec<Value>> {
    let whole = || Cut {
        inside: (0..coat_primitive.base_vertex.len() as u32).map(|v| ([v; 3], [1.0, 0.0, 0.0])).collect(),
        tint: coat_primitive.tint.clone(),
        triangles: coat_primitive.triangles.clone(),
        coarse: false,
    };
    let cut = coat_primitive.cut.clone().unwrap_or_else(whole);
    let n = cut.inside.len();
    let vertices = || materials.iter().flat_map(|&(height, _)| (0..n).map(move |v| (height, v)));
    let base = |v: u32| coat_primitive.base_vertex[v as usize] as usize;
    let mixed = |v: usize, of: &dyn Fn(u32) -> Vec3| -> Vec3 {
        let (corners, shares) = cut.inside[v];
        corners
            .into_iter()
            .zip(shares)
            .filter(|(_, share)| *share > 0.0)
            .map(|(corner, share)| of(corner) * share)
            .sum()
    };
    let normal = |v: u32| coat_primitive.normal.get(v as usize).copied().unwrap_or(part.stored.normals[base(v)]);
    let place = |h: f32, v: u32| part.stored.positions[base(v)] + h * coat_primitive.offset[v as usize];
    let positions: Vec<Vec3> = vertices().map(|(h, v)| mixed(v, &|corner| place(h, corner))).collect();
    let normals: Vec<Vec3> = vertices().map(|(_, v)| mixed(v, &normal).normalize_or(Vec3::Y)).collect();
    let uv = |v: usize| mixed(v, &|corner| coat_primitive.uv[corner as usize].extend(0.0)).truncate();
    let uvs: Vec<_> = vertices().map(|(_, v)| uv(v)).collect();
    let mut attributes = json!({
        "POSITION": document.push_positions(&positions, Use::Vertices),
        "NORMAL": document.push_vec3(&normals, Use::Vertices),
        "TEXCOORD_0": document.push_vec2(&uvs, Use::Vertices),
    });
    if tinted && cut.tint.iter().any(|tint| *tint != Vec4::ONE) {
        let tints: Vec<Vec4> = vertices().map(|(_, v)| cut.tint[v]).collect();
        attributes["COLOR_0"] = json!(document.push_unorm16(&tints, Use::Vertices));
    }
    if part.skins.iter().any(Option::is_some) {
        match (&coat_primitive.cut, &part.stored.influences) {
            (Some(_), Some(influences)) => {
                let of = |v: usize| mixed_influences(cut.inside[v], |corner| &influences[base(corner)]);
                let all: Vec<[(u16, f32); 4]> = vertices().map(|(_, v)| of(v)).collect();
                let joints: Vec<u8> = all.iter().flatten().flat_map(|(joint, _)| joint.to_le_bytes()).collect();
                let weights: Vec<f32> = all.iter().flatten().map(|(_, weight)| *weight).collect();
                attributes["JOINTS_0"] = json!(document.push_accessor(&joints, "VEC4", 5123, all.len(), Use::Vertices));
                attributes["WEIGHTS_0"] = json!(document.push_floats(&weights, 4, Use::Vertices));
            }
            _ => {
                let stored: Vec<usize> =
                    vertices().map(|(_, v)| part.stored.source[base(cut.inside[v].0[0])] as usize).collect();
                let primitive =
                    asset.document.root().entry("meshes", part.mesh)?.entry("primitives", part.primitive)?;
                for (name, at) in primitive.need("attributes")?.members()? {
                    if name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") {
                        attributes[name] = json!(copy_elements(document, &asset.document, &at, &stored)?);
                    }
                }
            }
        }
    }
    let mut targets = Vec::new();
    for morph in &part.stored.morphs {
        let change = |list: &[Vec3], v: usize| list.get(v).copied().unwrap_or(Vec3::ZERO);
        let mut target = json!({});
        let moved = |h: f32, v: u32| {
            let rest = part.stored.normals[base(v)].as_dvec3();
            let morphed = (rest + change(&morph.normals, base(v)).as_dvec3()).try_normalize().unwrap_or(rest);
            let offset = coat_primitive.offset[v as usize].as_dvec3();
            change(&morph.positions, base(v)) + h * (turn(rest, morphed) * offset - offset).as_vec3()
        };
        let all: Vec<Vec3> = vertices().map(|(h, v)| mixed(v, &|corner| moved(h, corner))).collect();
        target["POSITION"] = json!(document.push_positions(&all, Use::Vertices));
        if !morph.normals.is_empty() {
            let turned: Vec<Vec3> = vertices().map(|(_, v)| mixed(v, &|corner| morph.normals[base(corner)])).collect();
            target["NORMAL"] = json!(document.push_vec3(&turned, Use::Vertices));
        }
        targets.push(target);
    }
    let mirrored = part.mirrored();
    let mut primitives = Vec::new();
    for (shell, (_, material)) in materials.iter().enumerate() {
        let corner = |v: u32| v + (shell * n) as u32;
        let turned = |t: &[u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { *t };
        let indices: Vec<u32> = cut.triangles.iter().flat_map(turned).map(corner).collect();
        let mut primitive = json!({
            "attributes": attributes,
            "indices": document.push_integers(&indices, 1, Use::Indices),
            "material": material,
        });
        if !targets.is_empty() {
            primitive["targets"] = json!(targets);
        }
        primitives.push(primitive);
    }
    Ok(primitives)
}

/// Joints and weights between three vertices: the four that count most, their weights scaled to sum to 1.
fn mixed_influences<'a>(
    (corners, shares): ([u32; 3], [f32; 3]),
    of: impl Fn(u32) -> &'a Influences,
) -> [(u16, f32); 4] {
    let mut sums: BTreeMap<u16, f32> = BTreeMap::new();
    for (corner, share) in corners.into_iter().zip(shares).filter(|(_, share)| *share > 0.0) {
        for &(joint, weight) in of(corner).iter().filter(|(_, weight)| *weight > 0.0) {
            *sums.entry(joint).or_default() += share * weight;
        }
    }
    let mut most: Vec<(u16, f32)> = sums.into_iter().collect();
    most.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    most.truncate(4);
    let total: f32 = most.iter().map(|(_, weight)| weight).sum();
    let mut mixed = [(0, 0.0); 4];
    most.into_iter().zip(&mut mixed).for_each(|((joint, weight), slot)| *slot = (joint, weight / total));
    mixed
}

/// An accessor with the elements `of` another document's accessor, in their stored form.
fn copy_elements(to: &mut Document, from: &Document, at: &At<'_>, of: &[usize]) -> Result<usize> {
    let accessor = from.root().entry("accessors", at.size()?)?;
    let layout = AccessorLayout::of(from, at.size()?)?;
    let (bytes, element) = (layout.bytes(from), layout.element());
    let picked: Vec<u8> = of.iter().flat_map(|&v| &bytes[v * element..(v + 1) * element]).copied().collect();
    let kind = accessor.need("type")?.text()?;
    let component = accessor.need("componentType")?.size()? as u32;
    let index = to.push_accessor(&picked, kind, component, of.len(), Use::Vertices);
    if layout.normalised {
        to.json["accessors"][index]["normalized"] = json!(true);
    }
    Ok(index)
}
