//! A colour for each patch.

use super::CoveredPart;
use super::colours::DISTINCT;
use super::shapes::Shapes;
use crate::data::coat::Coat;
use crate::data::image::Image8;
use crate::data::texture::Wrap;
use crate::error::Result;
use crate::fur::patch;
use crate::math::Vec3;
use crate::runtime::SkinMesh;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Width of a seam's line over the skin's diagonal.
const LINE: f32 = 0.002;

/// See [`super::draw`].
pub(super) fn draw<'a>(
    all: &[CoveredPart<'_>],
    coat: &Coat,
    tile: &'a Image8,
) -> Result<(Vec<SkinMesh<'a>>, Vec<String>)> {
    let mut skins = Vec::with_capacity(all.len());
    let (mut patches, mut seams_m) = (0, 0.0);
    let mut lines = Shapes::default();
    for covered in all {
        let colours = colours(covered);
        patches += colours.len();
        let of_triangle = |t: usize| colours[&covered.primitive.patch[covered.primitive.triangles[t][0] as usize]];
        let uv = covered.primitive.triangles.iter().flatten().map(|&v| covered.primitive.uv[v as usize]).collect();
        skins.push(SkinMesh { uv, texture: Some((tile, [Wrap::Repeat; 2])), ..covered.facets(of_triangle) });
        let (mesh, laid) = covered.laid(coat)?;
        for ends in patch::seam_edges(&mesh, &laid) {
            let base = ends.map(|v| covered.primitive.base_vertex[v as usize] as usize);
            let [a, b] = base.map(|v| covered.posed.positions_m[v]);
            let normal = base.iter().map(|&v| covered.posed.normals[v]).sum::<Vec3>().normalize_or(Vec3::Y);
            lines.line([a, b], normal, LINE * mesh.diagonal_m());
            seams_m += a.distance(b);
        }
    }
    skins.push(lines.0);
    let legend = format!(
        "{patches} patches, neighbours in different colours; thick lines are the {:.1} cm of seams, where the texture does not \
         go on; thin ones outline the tile, and the hair's direction runs from its dark side to its bright one",
        1e2 * seams_m
    );
    Ok((skins, vec![legend]))
}

/// A colour per patch: the one least used so far that no neighbour has.
fn colours(covered: &CoveredPart<'_>) -> BTreeMap<u32, Vec3> {
    let w = covered.primitive;
    let class = |v: u32| covered.part.stored.position_class[w.base_vertex[v as usize] as usize];
    let mut beside: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    let mut at_edge: HashMap<(u32, u32), u32> = HashMap::new();
    for triangle in &w.triangles {
        let patch = w.patch[triangle[0] as usize];
        beside.entry(patch).or_default();
        for k in 0..3 {
            let (a, b) = (class(triangle[k]), class(triangle[(k + 1) % 3]));
            let other = *at_edge.entry((a.min(b), a.max(b))).or_insert(patch);
            if other != patch {
                beside.entry(patch).or_default().insert(other);
                beside.entry(other).or_default().insert(patch);
            }
        }
    }
    let mut used = [0; DISTINCT.len()];
    let mut chosen: BTreeMap<u32, usize> = BTreeMap::new();
    for (&patch, neighbours) in &beside {
        let taken: BTreeSet<usize> = neighbours.iter().filter_map(|n| chosen.get(n).copied()).collect();
        let free = (0..DISTINCT.len()).filter(|c| !taken.contains(c)).min_by_key(|&c| used[c]);
        let colour = free.unwrap_or(patch as usize % DISTINCT.len());
        used[colour] += 1;
        chosen.insert(patch, colour);
    }
    chosen.into_iter().map(|(patch, colour)| (patch, DISTINCT[colour])).collect()
}
