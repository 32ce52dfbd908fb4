//! Several presets on one part: which tile each triangle carries, and where one passes into another.

use super::skin::{Groomed, OF_PRESET};
use super::steps::Steps;
use super::wear::subset;
use super::{Task, names};
use crate::asset::{Asset, image};
use crate::coat::axes::axes;
use crate::data::coat::{Blend, CoatPrimitive, Tile};
use crate::data::distance::along_edges;
use crate::data::fields::Fields;
use crate::data::maps::sample;
use crate::data::mesh::Mesh;
use crate::data::paint::Paint;
use crate::data::patches::Patches;
use crate::data::texture::Texture;
use crate::error::{Error, Result};
use crate::fur::groom::Length;
use crate::math::Vec3;
use crate::preset::{Preset, Region};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Shares below this are none: eight bits of a map tell no less.
const LEAST: f32 = 1.0 / 255.0;

/// The presets of the task's regions, with as many layers and texels as the task's own: a passage needs equal stacks.
pub(super) fn presets(preset: &Preset) -> Result<Vec<Preset>> {
    let load = |region: &Region| {
        let mut other = Preset::load(&region.preset)?;
        if !other.regions.is_empty() {
            return Err(Error::usage("a region's preset has regions itself")
                .with_field("regions.preset")
                .with_found(&region.preset)
                .with_expected("a preset without regions"));
        }
        (other.shells.layers, other.shells.texture_size) = (preset.shells.layers, preset.shells.texture_size);
        Ok(other.checked()?.wetted())
    };
    preset.regions.iter().map(load).collect()
}

/// Looks for the files that a preset names, before any work.
///
/// # Errors
/// Where one is not there, or of another kind.
pub(super) fn check_files(preset: &Preset) -> Result<()> {
    let maps = &preset.maps;
    let maps = [&maps.density, &maps.length, &maps.comb, &maps.colour, &maps.clump];
    let all = maps.into_iter().chain(preset.regions.iter().map(|region| &region.map));
    all.flatten().try_for_each(|map| image::check(map))?;
    presets(preset).map(|_| ())
}

/// Whether the regions of a preset have a place on the `parts` that it furs, as [`shares`] needs it: before hair lies.
///
/// # Errors
/// Names the region that has none.
pub(super) fn check_places(asset: &Asset, parts: &[usize], preset: &Preset) -> Result<()> {
    let parts = || parts.iter().map(|&part| &asset.parts[part]);
    for (i, region) in preset.regions.iter().enumerate() {
        let has_uv = asset.parts.iter().any(|part| !part.stored.uv_sets.is_empty());
        let has_region = asset.parts.iter().any(|part| part.stored.fur_region.is_some());
        match (&region.material, &region.map) {
            (Some(material), _) if !parts().any(|part| part.material_name == *material) => {
                return Err(no_material(i, material, &names(parts()).join(", ")));
            }
            (None, Some(_)) if !has_uv => return Err(no_place(i, region, NO_UV)),
            (None, None) if !has_region => return Err(no_place(i, region, NOWHERE)),
            _ => {}
        }
    }
    Ok(())
}

/// What is wrong with a region's place, and what would do.
const NO_UV: [&str; 2] = ["a region's map needs texture coordinates", "a mesh with a UV set"];
const NOWHERE: [&str; 2] =
    ["a region has no place", "a map, a material, or a mesh with the vertex attribute _FUR_REGION"];

fn no_place(i: usize, region: &Region, [what, expected]: [&str; 2]) -> Error {
    let found = region.map.as_ref().map_or("none".into(), |map| map.display().to_string());
    Error::usage(what).with_field(format!("regions[{i}].map")).with_found(found).with_expected(expected)
}

fn no_material(i: usize, material: &str, known: &str) -> Error {
    Error::usage("a region's material is not among those that its preset furs")
        .with_field(format!("regions[{i}].material"))
        .with_found(material)
        .with_expected(format!("one of: {known}"))
}

/// What some `parts` of a task carry: one coat primitive for each tile that some triangle of a part carries alone, and one for each pair that share
/// triangles. `tiles` are the task's own and those of `presets`, `shares` what [`shares`] gives.
pub(super) fn wear_all(
    (task, parts): (&Task<'_>, &[usize]),
    own: &Groomed,
    patches: &Patches,
    (presets, tiles, shares): (&[Preset], &[Tile], &[Vec<f32>]),
    steps: &mut Steps<'_>,
) -> Result<Vec<(usize, CoatPrimitive)>> {
    let mut fields = vec![own.fields.clone()];
    for preset in presets {
        let groomed = task.groom(preset, steps)?;
        fields.push(groomed.cut(|part| parts.contains(&(part as usize))).fields);
    }
    let axes = axes(own.mesh(), &own.fields.direction, patches);
    let mixed = Mixed::new(own.mesh(), &fields, tiles, shares);
    // Triangles by their part and what they carry.
    let mut groups: BTreeMap<(u32, usize, Option<usize>), Vec<usize>> = BTreeMap::new();
    for (t, triangle) in own.mesh().triangles.iter().enumerate() {
        let mut carried: Vec<(usize, f32)> = (0..tiles.len())
            .map(|tile| (tile, triangle.iter().map(|&v| shares[v as usize][tile]).sum()))
            .filter(|&(_, share)| share > 0.0)
            .collect();
        // Where three meet, the two there is most of.
        carried.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        carried.truncate(2);
        carried.sort_by_key(|&(tile, _)| tile);
        let key = (own.skin.part_of[t], carried[0].0, carried.get(1).map(|w| w.0));
        groups.entry(key).or_default().push(t);
    }
    let coated = |((part, tile, into), triangles): (&(u32, usize, Option<usize>), &Vec<usize>)| {
        let fields = mixed.for_tile(&tiles[*tile]);
        let subset = subset(patches, triangles, tiles[0].edge_m / tiles[*tile].edge_m);
        let carried = task.coat_primitive(*part as usize, own, &fields, &axes, &subset, &tiles[*tile]);
        let weight = |second: usize, v: u32| {
            let share = &shares[v as usize];
            let both = share[*tile] + share[second];
            if both > 0.0 { share[second] / both } else { 0.5 }
        };
        let blend = into.map(|second| Blend {
            tile: second,
            weight: subset.base_vertex.iter().map(|&v| weight(second, v)).collect(),
        });
        (*part as usize, CoatPrimitive { tile: *tile, blend, ..carried })
    };
    Ok(steps.run("coat primitives", || {
        groups.iter().map(coated).filter(|(_, carried)| !carried.triangles.is_empty()).collect()
    }))
}

/// Per vertex, the share of the preset's own tile and of each region's; they sum to 1.
pub(super) fn shares(task: &Task<'_>, own: &Groomed) -> Result<Vec<Vec<f32>>> {
    let mesh = own.mesh();
    let mut shares = vec![vec![1.0]; mesh.positions_m.len()];
    for (i, region) in task.preset.regions.iter().enumerate() {
        let of: Vec<f32> = match (&region.material, &region.map, mesh.uv_sets.first(), &mesh.fur_region) {
            (Some(material), ..) => beside(task, own, material, region.reach, i)?,
            (_, Some(map), Some(uv), _) => {
                let image = image::load(map)?;
                // Parts without coordinates have nothing of it.
                let told = |v: usize| !task.asset.parts[own.skin.stored[v].0 as usize].stored.uv_sets.is_empty();
                uv.iter().enumerate().map(|(v, &uv)| if told(v) { sample(&image, uv).x } else { 0.0 }).collect()
            }
            (_, Some(_), None, _) => return Err(no_place(i, region, NO_UV)),
            (_, None, _, Some(attribute)) => attribute.clone(),
            (_, None, _, None) => return Err(no_place(i, region, NOWHERE)),
        };
        // Vertices at one point have one share, or shells would crack where texture coordinates do.
        let mut sums = vec![(0.0, 0.0); of.len()];
        for (&class, share) in mesh.position_class.iter().zip(of) {
            let sum = &mut sums[class as usize];
            *sum = (sum.0 + share, sum.1 + 1.0);
        }
        let of = mesh.position_class.iter().map(|&class| sums[class as usize].0 / sums[class as usize].1);
        for (shares, share) in shares.iter_mut().zip(of) {
            let share = if share < LEAST { 0.0 } else { share.min(1.0) };
            let share = if share > 1.0 - LEAST { 1.0 } else { share };
            shares.iter_mut().for_each(|s| *s *= 1.0 - share);
            shares.push(share);
        }
    }
    Ok(shares)
}

/// Per vertex, 1 on a material and its border, falling to 0 over `reach` along the edges of what lies beside it.
fn beside(task: &Task<'_>, own: &Groomed, material: &str, reach: Option<Length>, i: usize) -> Result<Vec<f32>> {
    let mesh = own.mesh();
    let class = |v: u32| mesh.position_class[v as usize] as usize;
    let of_material = |(_, part): &(&[u32; 3], &u32)| task.asset.parts[**part as usize].material_name == material;
    let covered: Vec<usize> = (mesh.triangles.iter().zip(&own.skin.part_of))
        .filter(of_material)
        .flat_map(|(triangle, _)| triangle.map(class))
        .collect();
    // A coarser level of detail may lack it.
    let named = |&part: &usize| task.asset.parts[part].material_name == material;
    if covered.is_empty() && task.parts.iter().any(named) {
        return Ok(vec![0.0; mesh.positions_m.len()]);
    }
    if covered.is_empty() {
        return Err(no_material(i, material, &task.materials(task.parts)));
    }
    let edges = mesh.triangles.iter().map(|t| t.map(class)).flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let away_m = along_edges(&mesh.positions_m, edges, covered);
    let reach_m = reach.unwrap_or(Length::Mm(20.0)).metres(task.scale.diagonal_m as f32);
    let share = |&class: &u32| {
        let x = (1.0 - away_m[class as usize] / reach_m).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    Ok(mesh.position_class.iter().map(share).collect())
}

/// The colours that all presets take from the same textures; none where one has another. Lengths and densities are the
/// vertices', as they are mixed.
fn common(fields: &[Fields]) -> Option<Arc<Paint>> {
    let first = fields[0].paint.as_ref()?;
    let colours = |paint: &Paint| -> Vec<Option<Texture>> {
        paint.parts.iter().map(|part| part.colour.as_ref().map(|(texture, _)| texture.clone())).collect()
    };
    let own = colours(first);
    let of_asset = own.iter().flatten().all(|texture| texture.index != OF_PRESET);
    let alike = |fields: &Fields| fields.paint.as_ref().is_some_and(|paint| colours(paint) == own);
    if !of_asset || !fields.iter().all(alike) {
        return None;
    }
    let mut paint = Paint::clone(first);
    paint.parts.iter_mut().for_each(|part| part.maps = None);
    paint.longest.fill(1.0);
    Some(Arc::new(paint))
}

/// Fields in which every tile has its share, so that what lies side by side goes on.
struct Mixed {
    /// Lengths here are those of the offsets, m.
    fields: Fields,
}

impl Mixed {
    fn new(mesh: &Mesh, fields: &[Fields], tiles: &[Tile], shares: &[Vec<f32>]) -> Self {
        let count = shares.len();
        // What is painted counts at the vertices: the longest around them would be another preset's too.
        let length = |fields: &Fields, v: usize| {
            let Some(paint) = &fields.paint else { return fields.length[v] };
            let longest = paint.longest[v];
            if longest > 0.0 { fields.length[v] * (paint.at_vertex(mesh, v).length / longest).min(1.0) } else { 0.0 }
        };
        let sum = |v: usize, of: &dyn Fn(usize) -> f32| -> f32 {
            (0..tiles.len()).map(|tile| shares[v][tile] * of(tile)).sum()
        };
        let sum3 = |v: usize, of: &dyn Fn(usize) -> Vec3| -> Vec3 {
            (0..tiles.len()).map(|tile| shares[v][tile] * of(tile)).sum()
        };
        Self {
            fields: Fields {
                length: (0..count).map(|v| sum(v, &|t| tiles[t].height_m * length(&fields[t], v))).collect(),
                density: (0..count).map(|v| sum(v, &|t| fields[t].density[v])).collect(),
                direction: fields[0].direction.clone(),
                lean: (0..count).map(|v| sum3(v, &|t| fields[t].lean[v]).normalize_or(fields[0].lean[v])).collect(),
                clump: fields[0].clump.clone(),
                tint: (0..count).map(|v| sum3(v, &|t| fields[t].tint[v])).collect(),
                paint: common(fields),
                partings: fields[0].partings.clone(),
            },
        }
    }

    /// With lengths over a tile's height, as a coat of it needs them.
    fn for_tile(&self, tile: &Tile) -> Fields {
        let mut fields = self.fields.clone();
        fields.length.iter_mut().for_each(|length| *length /= tile.height_m);
        fields
    }
}
