//! Coat vertices of primitives that share a pool of vertices: written once for all of them.

use super::parts::part_of;
use crate::asset::Asset;
use crate::data::coat::CoatPrimitive;
use crate::error::Result;
use serde_json::Value;
use std::collections::HashMap;

/// Coat vertices as they are written, and the coat primitives that use them.
pub struct Pool {
    /// One primitive's vertices, or those of several; base vertices are those of the file. Triangles and fins mean nothing.
    pub vertices: CoatPrimitive,
    /// Index of a coat primitive, and its vertices' numbers here.
    pub members: Vec<(usize, Vec<u32>)>,
}

/// All that tells two coat vertices of a pool apart.
type Key = [u32; 20];

/// The pools of a coat's primitives, in the order of their first members.
///
/// # Errors
/// When a primitive belongs to no part of the asset.
pub fn pools(asset: &Asset, primitives: &[CoatPrimitive]) -> Result<Vec<Pool>> {
    let root = asset.document.root();
    let mut pools: Vec<(Value, Pool)> = Vec::new();
    for (index, primitive) in primitives.iter().enumerate() {
        let source = &part_of(asset, primitive)?.stored.source;
        let base_vertex = primitive.base_vertex.iter().map(|&v| source[v as usize]).collect();
        let own = CoatPrimitive { base_vertex, ..primitive.clone() };
        let at = root.entry("meshes", primitive.mesh)?.entry("primitives", primitive.primitive)?;
        let accessors = at.need("attributes")?.value.clone();
        let alike = |pool: &&mut (Value, Pool)| {
            pool.0 == accessors
                && pool.1.vertices.blend.is_none()
                && own.blend.is_none()
                && painted_alike(&pool.1.vertices, &own)
        };
        let numbers: Vec<u32> = (0..own.base_vertex.len() as u32).collect();
        match pools.iter_mut().find(alike) {
            Some((_, pool)) => pool.members.push((index, numbers)),
            None => pools.push((accessors, Pool { vertices: own, members: vec![(index, numbers)] })),
        }
    }
    let merged =
        |(_, pool): (Value, Pool)| if pool.members.len() > 1 { merge(asset, primitives, pool) } else { Ok(pool) };
    pools.into_iter().map(merged).collect()
}

fn painted_alike(a: &CoatPrimitive, b: &CoatPrimitive) -> bool {
    a.longest.is_empty() == b.longest.is_empty() && a.normal.is_empty() == b.normal.is_empty()
}

/// Joins the vertices of a pool's members; equal ones are one.
fn merge(asset: &Asset, primitives: &[CoatPrimitive], pool: Pool) -> Result<Pool> {
    let mut joined = CoatPrimitive { blend: None, ..CoatPrimitive::default() };
    let mut known: HashMap<Key, u32> = HashMap::new();
    let mut members = Vec::new();
    for (index, _) in pool.members {
        let primitive = &primitives[index];
        let source = &part_of(asset, primitive)?.stored.source;
        let mut numbers = Vec::with_capacity(primitive.base_vertex.len());
        for v in 0..primitive.base_vertex.len() {
            let base = source[primitive.base_vertex[v] as usize];
            let number = *known.entry(key(primitive, v, base)).or_insert_with(|| {
                joined.base_vertex.push(base);
                joined.uv.push(primitive.uv[v]);
                joined.patch.push(primitive.patch[v]);
                joined.offset.push(primitive.offset[v]);
                joined.axis.push(primitive.axis[v]);
                joined.normal.extend(primitive.normal.get(v));
                joined.tint.push(primitive.tint[v]);
                joined.longest.extend(primitive.longest.get(v));
                joined.base_vertex.len() as u32 - 1
            });
            numbers.push(number);
        }
        members.push((index, numbers));
    }
    Ok(Pool { vertices: joined, members })
}

fn key(primitive: &CoatPrimitive, v: usize, base: u32) -> Key {
    let mut key = Key::default();
    let values = (primitive.uv[v].to_array().into_iter())
        .chain(primitive.offset[v].to_array())
        .chain(primitive.axis[v].to_array())
        .chain(primitive.normal.get(v).copied().unwrap_or_default().to_array())
        .chain(primitive.tint[v].to_array())
        .chain([primitive.longest.get(v).copied().unwrap_or(0.0)]);
    let bits = [base, primitive.patch[v], primitive.tile as u32].into_iter().chain(values.map(f32::to_bits));
    key.iter_mut().zip(bits).for_each(|(slot, bits)| *slot = bits);
    key
}
