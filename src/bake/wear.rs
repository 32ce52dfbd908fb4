//! What parts carry: coat primitives from the skin that was groomed as a whole.

use super::Task;
use super::cut;
use super::skin::Groomed;
use crate::asset::Fallback;
use crate::coat::axes::axes;
use crate::coat::primitive::{Local, coat_primitive};
use crate::data::coat::{CoatPrimitive, Sampled, Tile};
use crate::data::fields::Fields;
use crate::data::patches::Patches;
use crate::math::{Vec2, Vec3};
use std::collections::{BTreeMap, HashMap};

impl Task<'_> {
    /// What each part of `groomed` carries of `patches`, which lie on all of it.
    pub(super) fn coat_primitives(
        &self,
        groomed: &Groomed,
        patches: &Patches,
        tile: &Tile,
    ) -> Vec<(usize, CoatPrimitive)> {
        let axes = axes(groomed.mesh(), &groomed.fields.direction, patches);
        let mut triangles: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        groomed.skin.part_of.iter().enumerate().for_each(|(t, &part)| triangles.entry(part).or_default().push(t));
        let carried = |(&part, triangles): (&u32, &Vec<usize>)| {
            let own =
                if triangles.len() == patches.triangles.len() { None } else { Some(subset(patches, triangles, 1.0)) };
            let own = own.as_ref().unwrap_or(patches);
            (part as usize, self.coat_primitive(part as usize, groomed, &groomed.fields, &axes, own, tile))
        };
        triangles.iter().map(carried).filter(|(_, primitive)| !primitive.triangles.is_empty()).collect()
    }

    /// What a part carries of `patches`, which lie on it alone.
    pub(super) fn coat_primitive(
        &self,
        part: usize,
        groomed: &Groomed,
        fields: &Fields,
        axes: &[Vec3],
        patches: &Patches,
        tile: &Tile,
    ) -> CoatPrimitive {
        let at = &self.asset.parts[part];
        let stored = |v: usize| groomed.skin.stored[v].1 as usize;
        let local = Local {
            offset: &|v, offset_m| at.local_offset(stored(v), offset_m, self.scale.metres_per_unit),
            normal: &|v, normal: Vec3| {
                let turned = at.world_from_local(stored(v)).transpose() * normal.as_dvec3();
                turned.normalize_or(normal.as_dvec3()).as_vec3()
            },
        };
        let carried = coat_primitive(groomed.mesh(), fields, axes, patches, tile, self.request.seed, &local);
        let base_vertex = carried.base_vertex.iter().map(|&v| stored(v as usize) as u32).collect();
        let whole = CoatPrimitive { mesh: at.mesh, primitive: at.primitive, base_vertex, ..carried };
        match &fields.paint {
            Some(paint) => {
                let vertices = &patches.base_vertex;
                let painted = self.textures.painted(whole, paint, part, vertices);
                let wanted = self.request.fallback != Fallback::None && tile.sampled == Sampled::Square;
                let (diagonal_m, unit_m) = (self.scale.diagonal_m as f32, self.scale.metres_per_unit);
                let cut = wanted.then(|| cut::cut(at, part, &painted, paint, vertices, diagonal_m, unit_m)).flatten();
                CoatPrimitive { cut, ..painted }
            }
            None => whole,
        }
    }
}

/// Some triangles of patches on the vertices that they need, with coordinates `scale` times as large.
pub(super) fn subset(patches: &Patches, triangles: &[usize], scale: f32) -> Patches {
    let mut new: HashMap<u32, u32> = HashMap::new();
    let mut part = Patches { extent: Vec2::ZERO, ..Patches::default() };
    for &t in triangles {
        let triangle = patches.triangles[t].map(|old| {
            *new.entry(old).or_insert_with(|| {
                part.base_vertex.push(patches.base_vertex[old as usize]);
                part.uv.push(patches.uv[old as usize] * scale);
                part.patch.push(patches.patch[old as usize]);
                part.uv.len() as u32 - 1
            })
        });
        part.triangles.push(triangle);
    }
    part
}
