//! Expressions of an avatar (VRM 0 and 1) that change the colour of furred skin: shells of the fallback follow where they can.

use super::worn::is_shells;
use crate::asset::Asset;
use crate::asset::document::Document;
use crate::asset::encode::numbers;
use crate::asset::vrm;
use crate::data::coat::Coat;
use crate::data::image::srgb_from_linear;
use crate::math::{Vec3, Vec4};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A furred material.
struct Furred {
    name: String,
    /// Its colour, linear RGBA.
    colour: Vec4,
    /// The materials of the shells over it; none where they lie over other materials too, or there are none.
    shells: Option<Vec<usize>>,
}

/// What an expression does to a furred material.
enum Change {
    /// Gives it this colour, linear RGBA.
    Colour(Vec4),
    /// Moves its texture.
    Moved,
}

/// Writes into the avatar's expressions what the shells need to change as the skin below them does; `shells` are their
/// materials, by tile. Gives what becomes of each expression that changes a colour, one sentence each.
pub fn follow(document: &mut Document, asset: &Asset, coat: &Coat, shells: &[Vec<usize>]) -> Vec<String> {
    let furred = furred(asset, coat, shells);
    let mut notes = Vec::new();
    let name =
        |&shell: &usize| (shell, document.json["materials"][shell]["name"].as_str().unwrap_or_default().to_owned());
    let names: BTreeMap<usize, String> = shells.iter().flatten().map(name).collect();
    if let Some(avatar) = document.json.pointer_mut("/extensions/VRMC_vrm") {
        for kind in ["preset", "custom"] {
            let expressions = avatar.pointer_mut(&format!("/expressions/{kind}")).and_then(Value::as_object_mut);
            for (name, expression) in expressions.into_iter().flatten() {
                newer(name, expression, &furred, &mut notes);
            }
        }
    }
    let groups = document.json.pointer_mut("/extensions/VRM/blendShapeMaster/blendShapeGroups");
    for group in groups.and_then(Value::as_array_mut).into_iter().flatten() {
        older(group, &furred, &names, &mut notes);
    }
    notes
}

/// Furred materials, by number.
fn furred(asset: &Asset, coat: &Coat, shells: &[Vec<usize>]) -> BTreeMap<usize, Furred> {
    let mut tiles: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    let mut over: Vec<BTreeSet<Option<usize>>> = vec![BTreeSet::new(); coat.tiles.len()];
    for carried in &coat.primitives {
        let primitive = &asset.document.json["meshes"][carried.mesh]["primitives"][carried.primitive];
        let material = primitive["material"].as_u64().map(|index| index as usize);
        for tile in std::iter::once(carried.tile).chain(carried.blend.as_ref().map(|blend| blend.tile)) {
            over[tile].insert(material);
            if let Some(material) = material {
                tiles.entry(material).or_default().insert(tile);
            }
        }
    }
    let of = |(material, tiles): (usize, BTreeSet<usize>)| {
        let own = &asset.document.json["materials"][material];
        let factor = vrm::numbers(&own["pbrMetallicRoughness"]["baseColorFactor"]).unwrap_or(Vec4::ONE);
        let alone = !shells.is_empty() && tiles.iter().all(|&tile| over[tile].len() == 1);
        let furred = Furred {
            name: own["name"].as_str().map_or_else(|| format!("material_{material}"), str::to_owned),
            colour: vrm::colour(&asset.document, material).factor.unwrap_or(factor),
            shells: alone.then(|| tiles.iter().flat_map(|&tile| &shells[tile]).copied().collect()),
        };
        (material, furred)
    };
    tiles.into_iter().map(of).collect()
}

impl Furred {
    /// What the shells' colour, white, becomes where the skin's changes; or why it cannot be told.
    fn factor(&self, change: &Change) -> Result<(&[usize], Vec3), &'static str> {
        let Change::Colour(target) = change else { return Err("it moves the texture") };
        let Some(shells) = &self.shells else { return Err("no shells lie over this material alone") };
        let (own, target) = (self.colour.truncate(), target.truncate());
        // Black stays black, whatever it is multiplied by.
        if own.to_array().iter().zip(target.to_array()).any(|(own, target)| *own == 0.0 && target != 0.0) {
            return Err("its own colour has nothing of it");
        }
        Ok((shells, target / own.max(Vec3::splat(f32::MIN_POSITIVE))))
    }

    fn told(&self, expression: &str, followed: Result<(), &'static str>) -> String {
        let name = &self.name;
        match followed {
            Ok(()) => format!(
                "the expression {expression:?} changes the colour of material {name:?}: the shells of the fallback follow it, \
                 the coat keeps its own"
            ),
            Err(why) => format!(
                "fur keeps its colour in the expression {expression:?}, which changes that of material {name:?}: {why}"
            ),
        }
    }
}

/// An expression of VRM 1.
fn newer(name: &str, expression: &mut Value, furred: &BTreeMap<usize, Furred>, notes: &mut Vec<String>) {
    let of = |bind: &Value| furred.get(&(bind["material"].as_u64()? as usize));
    let mut more = Vec::new();
    for bind in expression["materialColorBinds"].as_array().into_iter().flatten() {
        let target = vrm::numbers(&bind["targetValue"]).filter(|_| bind["type"] == "color");
        let (Some(material), Some(target)) = (of(bind), target) else { continue };
        let factor = material.factor(&Change::Colour(target));
        if let Ok((shells, factor)) = factor {
            let value = numbers(&factor.extend(1.0).to_array());
            let bind = |shell: &usize| json!({"material": shell, "type": "color", "targetValue": value});
            more.extend(shells.iter().map(bind));
        }
        tell(notes, material.told(name, factor.map(|_| ())));
    }
    let still = |bind: &Value| {
        let pair =
            |key: &str, default: f64| [0, 1].iter().all(|&i| bind[key][i].as_f64().unwrap_or(default) == default);
        pair("scale", 1.0) && pair("offset", 0.0)
    };
    for bind in expression["textureTransformBinds"].as_array().into_iter().flatten().filter(|bind| !still(bind)) {
        if let Some(material) = of(bind) {
            tell(notes, material.told(name, material.factor(&Change::Moved).map(|_| ())));
        }
    }
    if let Some(binds) = expression.get_mut("materialColorBinds").and_then(Value::as_array_mut) {
        binds.extend(more);
    }
}

/// An expression of VRM 0, which knows materials by their names; `names` are those of the shells' materials, by number.
fn older(
    group: &mut Value,
    furred: &BTreeMap<usize, Furred>,
    names: &BTreeMap<usize, String>,
    notes: &mut Vec<String>,
) {
    let name = group["name"].as_str().or(group["presetName"].as_str()).unwrap_or_default().to_owned();
    let mut more = Vec::new();
    for bind in group["materialValues"].as_array().into_iter().flatten() {
        let Some(material) = furred.values().find(|furred| bind["materialName"] == furred.name.as_str()) else {
            continue;
        };
        let property = bind["propertyName"].as_str().unwrap_or_default();
        let change = match (property, vrm::numbers(&bind["targetValue"])) {
            ("_Color", Some(target)) => Change::Colour(vrm::linear(target)),
            ("_MainTex_ST" | "_MainTex_ST_S" | "_MainTex_ST_T", _) => Change::Moved,
            _ => continue,
        };
        let factor = material.factor(&change);
        if let Ok((shells, factor)) = factor {
            let value =
                numbers(&factor.to_array().map(srgb_from_linear).into_iter().chain([1.0]).collect::<Vec<f32>>());
            let bind = |name: &String| json!({"materialName": name, "propertyName": "_Color", "targetValue": value});
            more.extend(shells.iter().filter_map(|shell| names.get(shell)).map(bind));
        }
        tell(notes, material.told(&name, factor.map(|_| ())));
    }
    if let Some(binds) = group.get_mut("materialValues").and_then(Value::as_array_mut) {
        binds.extend(more);
    }
}

fn tell(notes: &mut Vec<String>, sentence: String) {
    if !notes.contains(&sentence) {
        notes.push(sentence);
    }
}

/// Takes what expressions do to materials called as shells are out of them.
pub fn forget(json: &mut Value) {
    let materials = json["materials"].as_array().map(Vec::as_slice).unwrap_or_default();
    let shells: BTreeSet<u64> = (0..).zip(materials).filter(|(_, m)| is_shells(m)).map(|(index, _)| index).collect();
    for kind in ["preset", "custom"] {
        let expressions = json.pointer_mut(&format!("/extensions/VRMC_vrm/expressions/{kind}"));
        let expressions = expressions.and_then(Value::as_object_mut);
        for expression in expressions.into_iter().flat_map(|all| all.values_mut()) {
            if let Some(binds) = expression.get_mut("materialColorBinds").and_then(Value::as_array_mut) {
                binds.retain(|bind| !bind["material"].as_u64().is_some_and(|index| shells.contains(&index)));
            }
        }
    }
    let groups = json.pointer_mut("/extensions/VRM/blendShapeMaster/blendShapeGroups").and_then(Value::as_array_mut);
    for group in groups.into_iter().flatten() {
        if let Some(values) = group.get_mut("materialValues").and_then(Value::as_array_mut) {
            values.retain(|value| !is_shells(&json!({"name": value["materialName"]})));
        }
    }
}
