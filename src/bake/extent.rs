//! How large things are in the rest pose: what is furred, and the figure that it is a part of.

use crate::asset::scene_graph::SceneGraph;
use crate::asset::{Asset, Part};
use crate::math::DVec3;
use std::collections::BTreeSet;

/// Share of the area, at either end of an axis, that lies far off where the rest is small without it.
const SPECKS: f64 = 1e-3;
/// From this many times as large on as without them, specks are left out.
const FAR: f64 = 2.0;

/// The box around triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Its edges, file units, without specks far off.
    pub size_units: DVec3,
    /// Its diagonal with the specks that were left out, file units.
    pub with_specks_units: Option<f64>,
}

impl Extent {
    /// Of all triangles of `parts`. Vertices that no triangle uses do not count, nor do specks: where all but a thousandth of
    /// the area to either side fits into half the diagonal, the rest is left out. No limb or tail has so little skin.
    pub fn of(parts: &[&Part]) -> Self {
        let whole = size_units(parts, |_| true);
        let [x, y, z] = [0, 1, 2].map(|axis| middle(parts, axis));
        let (low, high) = (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1));
        let kept = size_units(parts, |c| c.cmpge(low).all() && c.cmple(high).all());
        if kept.length() > 0.0 && FAR * kept.length() < whole.length() {
            return Self { size_units: kept, with_specks_units: Some(whole.length()) };
        }
        Self { size_units: whole, with_specks_units: None }
    }

    /// Length of the box's diagonal, file units.
    pub fn diagonal_units(&self) -> f64 {
        self.size_units.length()
    }
}

/// Corners of a part's triangles, file units.
fn triangles(part: &Part) -> impl Iterator<Item = [DVec3; 3]> {
    part.stored.triangles.iter().map(|triangle| triangle.map(|v| part.world_units(v as usize)))
}

fn centroid([a, b, c]: [DVec3; 3]) -> DVec3 {
    (a + b + c) / 3.0
}

/// Edges of the box around the triangles whose centroid is `wanted`; zero where none is.
fn size_units(parts: &[&Part], wanted: impl Fn(DVec3) -> bool) -> DVec3 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corners in parts.iter().flat_map(|part| triangles(part)).filter(|corners| wanted(centroid(*corners))) {
        low = corners.iter().fold(low, |low, &p| low.min(p));
        high = corners.iter().fold(high, |high, &p| high.max(p));
    }
    if low.cmple(high).all() { high - low } else { DVec3::ZERO }
}

/// Between which coordinates the centroids of all triangles lie but those at either end that have [`SPECKS`] of the area.
fn middle(parts: &[&Part], axis: usize) -> (f64, f64) {
    let mut list: Vec<(f64, f64)> = parts
        .iter()
        .flat_map(|part| triangles(part))
        .map(|[a, b, c]| (centroid([a, b, c])[axis], (b - a).cross(c - a).length()))
        .collect();
    list.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let most = SPECKS * list.iter().map(|(_, area)| area).sum::<f64>();
    let low = first_beyond(most, list.iter()).unwrap_or(f64::NEG_INFINITY);
    (low, first_beyond(most, list.iter().rev()).unwrap_or(f64::INFINITY))
}

/// The first coordinate where the areas that go with them have come to more than `most`.
fn first_beyond<'a>(most: f64, mut ordered: impl Iterator<Item = &'a (f64, f64)>) -> Option<f64> {
    let mut passed = 0.0;
    let beyond = |(_, area): &&(f64, f64)| {
        passed += area;
        passed > most
    };
    ordered.find(beyond).map(|(at, _)| *at)
}

/// The figures that the `chosen` parts belong to: all parts of the same meshes, and all on the same skeletons.
pub fn figure<'a>(asset: &'a Asset, chosen: &[usize]) -> Vec<&'a Part> {
    let scene = &asset.scene;
    let joints: BTreeSet<usize> =
        scene.skins.iter().flat_map(|skin| skin.joints.iter().map(|&(node, _)| node)).collect();
    let root = |part: &Part| skeleton(scene, &joints, part);
    let furred = || chosen.iter().map(|&i| &asset.parts[i]);
    let meshes: BTreeSet<usize> = furred().map(|part| part.mesh).collect();
    let skeletons: BTreeSet<usize> = furred().filter_map(root).collect();
    let levels: BTreeSet<u32> = furred().map(|part| part.level).collect();
    let belongs = |part: &&Part| {
        let joined = meshes.contains(&part.mesh) || root(part).is_some_and(|r| skeletons.contains(&r));
        joined && levels.contains(&part.level)
    };
    asset.parts.iter().filter(belongs).collect()
}

/// The uppermost joint above a part: above its skin's joints, or above the node that it hangs on.
fn skeleton(scene: &SceneGraph, joints: &BTreeSet<usize>, part: &Part) -> Option<usize> {
    let joint = part.skins.iter().flatten().next().and_then(|&skin| scene.skins[skin].joints.first());
    let from = joint.map_or(part.nodes[0], |&(node, _)| node);
    std::iter::successors(Some(from), |&node| scene.parent[node]).filter(|node| joints.contains(node)).last()
}

/// The material that looks like the ground under all else of the `chosen` parts, and how many times as large it is: flat,
/// in meshes of its own without a skin, and more than `times` as large as the rest together.
pub fn ground<'a>(asset: &'a Asset, chosen: &[usize], times: f64) -> Option<(&'a str, f64)> {
    let furred = || chosen.iter().map(|&i| &asset.parts[i]);
    let names: BTreeSet<&str> = furred().map(|part| part.material_name.as_str()).collect();
    names.into_iter().find_map(|name| {
        let (flat, rest): (Vec<&Part>, Vec<&Part>) = furred().partition(|part| part.material_name == name);
        let size = size_units(&flat, |_| true);
        let apart =
            |part: &&Part| part.skins.iter().all(Option::is_none) && rest.iter().all(|other| other.mesh != part.mesh);
        if rest.is_empty() || size.min_element() > FLAT * size.length() || !flat.iter().all(apart) {
            return None;
        }
        let ratio = size.length() / Extent::of(&rest).diagonal_units();
        (ratio.is_finite() && ratio > times).then_some((name, ratio))
    })
}

/// What is thinner than this, in diagonals, is flat.
const FLAT: f64 = 0.01;
