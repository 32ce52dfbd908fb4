//! Fins as they are baked: one on every edge of the skin, and all together as much hair as the coat.

use crate::witness;
use furrier::asset::{Asset, Document, coat::coat_of};
use furrier::data::coat::Coat;
use furrier::math::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A baked sample: the asset and its coat.
pub fn baked(name: &str) -> (Asset, Coat) {
    let bytes = witness::baked(&format!("sample:{name}"));
    let document = Document::parse(&bytes, Path::new("baked.glb"), &mut Vec::new()).unwrap();
    let asset = Asset::new(document, Vec::new()).unwrap();
    let coat = coat_of(&asset).unwrap();
    (asset, coat)
}

/// What is wrong with the fins of a coat, if anything.
pub fn fault(asset: &Asset, coat: &Coat) -> Option<String> {
    for worn in &coat.primitives {
        let part = asset.parts.iter().find(|part| (part.mesh, part.primitive) == (worn.mesh, worn.primitive)).unwrap();
        let (mesh, texture) = (part.mesh(coat.metres_per_unit).unwrap(), &coat.tiles[worn.tile].fin);
        let point = |v: u32| mesh.position_class[worn.base_vertex[v as usize] as usize];
        let place = |v: u32| -> Vec3 { mesh.positions_m[worn.base_vertex[v as usize] as usize] };
        let edge = |a: u32, b: u32| [point(a).min(point(b)), point(a).max(point(b))];
        // Per edge, the points opposite to it.
        let mut faces: BTreeMap<[u32; 2], BTreeSet<u32>> = BTreeMap::new();
        let mut area_m2 = 0.0;
        for &[a, b, c] in &worn.triangles {
            area_m2 += 0.5 * (place(b) - place(a)).cross(place(c) - place(a)).length();
            for (a, b, c) in [(a, b, c), (b, c, a), (c, a, b)] {
                faces.entry(edge(a, b)).or_default().insert(point(c));
            }
        }
        let mut held_m2 = 0.0;
        let mut met = BTreeSet::new();
        for fin in &worn.fins {
            let [a, b] = fin.ends;
            let length_m = place(a).distance(place(b));
            held_m2 += length_m * fin.thickness * texture.thickness_m;
            if !met.insert(edge(a, b)) {
                return Some(format!("two fins on one edge: {:?}", fin.ends));
            }
            if faces.get(&edge(a, b)) != Some(&fin.opposite.map(point).into()) {
                return Some(format!("a fin on no edge, or beside other faces: {fin:?}"));
            }
            if ((fin.u[1] - fin.u[0]) * texture.width_m / length_m - 1.0).abs() > 1e-3 {
                return Some(format!("a fin {length_m} m long shows {:?} of the texture", fin.u));
            }
        }
        if met.len() != faces.len() {
            return Some(format!("{} fins for {} edges", met.len(), faces.len()));
        }
        if (held_m2 / area_m2 - 1.0).abs() > 1e-3 {
            return Some(format!("fins hold the hair of {held_m2} m² on {area_m2} m²"));
        }
    }
    None
}

#[test]
fn every_edge_has_a_fin_and_all_hold_the_coat_once() {
    for name in ["cylinder", "creature"] {
        let (asset, coat) = baked(name);
        assert!(coat.primitives.iter().any(|worn| worn.fins.len() > 1000));
        assert_eq!(fault(&asset, &coat), None, "{name}");
    }
}
