//! One triangle primitive as stored, in its own space.

use crate::math::{Vec2, Vec3, Vec4};

/// Joint influences of a vertex: joint and weight; weights sum to 1.
pub type Influences = [(u16, f32); 8];

/// What a morph target adds.
#[derive(Clone, Debug, Default)]
pub struct Morph {
    /// Position changes, one per vertex, or none.
    pub positions: Vec<Vec3>,
    /// Normal changes, one per vertex, or none.
    pub normals: Vec<Vec3>,
}

/// Vertex data in the primitive's own space and units, one entry per vertex that a triangle uses, and its triangles.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Which vertex of the file's accessors each is; several primitives may share a pool of them. Ascending.
    pub source: Vec<u32>,
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals: stored ones, repaired where they were missing or not unit.
    pub normals: Vec<Vec3>,
    /// `TEXCOORD_n` in order.
    pub uv_sets: Vec<Vec<Vec2>>,
    /// `COLOR_0`, alpha 1 where it has none.
    pub colour: Option<Vec<Vec4>>,
    /// `_FUR_LENGTH`.
    pub fur_length: Option<Vec<f32>>,
    /// `_FUR_REGION`.
    pub fur_region: Option<Vec<f32>>,
    /// `_FUR_DIRECTION`.
    pub fur_direction: Option<Vec<Vec3>>,
    /// Joints and weights of skinned primitives.
    pub influences: Option<Vec<Influences>>,
    /// Morph targets.
    pub morphs: Vec<Morph>,
    /// Triangles that have an area, counter-clockwise from where the normals point.
    pub triangles: Vec<[u32; 3]>,
    /// Smallest index of a vertex at the same place, one per vertex.
    pub position_class: Vec<u32>,
}

impl Primitive {
    /// Forgets vertices that no triangle uses: what is kept of a pool hangs on the primitive, not on the pool.
    pub fn compact(&mut self) {
        let mut used = vec![false; self.positions.len()];
        self.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        self.source = (0..self.positions.len() as u32).filter(|&v| used[v as usize]).collect();
        if self.source.len() == self.positions.len() {
            return;
        }
        let mut new = vec![u32::MAX; used.len()];
        self.source.iter().zip(0..).for_each(|(&old, v)| new[old as usize] = v);
        // The first used vertex at a place stands for it now.
        let mut first = vec![u32::MAX; used.len()];
        let class = |v: u32, first: &mut Vec<u32>| {
            let slot = &mut first[self.position_class[v as usize] as usize];
            if *slot == u32::MAX {
                *slot = new[v as usize];
            }
            *slot
        };
        let position_class = self.source.iter().map(|&v| class(v, &mut first)).collect();
        let source = &self.source;
        fn keep<T: Copy>(list: &mut Vec<T>, source: &[u32]) {
            // Absent lists stay absent.
            if !list.is_empty() {
                *list = source.iter().map(|&v| list[v as usize]).collect();
            }
        }
        keep(&mut self.positions, source);
        keep(&mut self.normals, source);
        self.uv_sets.iter_mut().for_each(|set| keep(set, source));
        self.colour.iter_mut().for_each(|list| keep(list, source));
        self.fur_length.iter_mut().for_each(|list| keep(list, source));
        self.fur_region.iter_mut().for_each(|list| keep(list, source));
        self.fur_direction.iter_mut().for_each(|list| keep(list, source));
        self.influences.iter_mut().for_each(|list| keep(list, source));
        for morph in &mut self.morphs {
            keep(&mut morph.positions, source);
            keep(&mut morph.normals, source);
        }
        self.triangles.iter_mut().for_each(|t| *t = t.map(|v| new[v as usize]));
        self.position_class = position_class;
    }
}
