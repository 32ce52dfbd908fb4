//! Which triangle lies beyond each edge (Andersen et al. 2016 §3.2, Fig. 7).

use crate::data::mesh::Mesh;
use std::collections::HashMap;

/// The other side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beyond {
    /// Neighbouring triangle.
    pub triangle: u32,
    /// Its corner opposite to the shared edge.
    pub corner: u8,
}

/// Neighbours across the edges opposite to corners 0, 1 and 2 of every triangle; none at borders.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    sides: Vec<[Option<Beyond>; 3]>,
}

impl Neighbours {
    /// Of a mesh, across UV and normal seams.
    ///
    /// An edge's key is its two 32-bit position classes in one 64-bit number, in the order in which the triangle runs
    /// through them; the neighbour has the reversed key. Where more than two triangles share an edge, or run through
    /// it the same way, the one with the lowest index is taken: a march goes on there, if into one sheet of several.
    pub fn new(mesh: &Mesh) -> Self {
        let key = |from: u32, to: u32| u64::from(from) << 32 | u64::from(to);
        let classes = |t: usize| mesh.triangles[t].map(|v| mesh.position_class[v as usize]);
        let mut edges: HashMap<u64, Beyond> = HashMap::with_capacity(3 * mesh.triangles.len());
        for t in 0..mesh.triangles.len() {
            let c = classes(t);
            for corner in 0..3_u8 {
                let (from, to) = (c[(usize::from(corner) + 1) % 3], c[(usize::from(corner) + 2) % 3]);
                edges.entry(key(from, to)).or_insert(Beyond { triangle: t as u32, corner });
            }
        }
        let sides = (0..mesh.triangles.len())
            .map(|t| {
                let c = classes(t);
                [0, 1, 2].map(|corner| {
                    let beyond = edges.get(&key(c[(corner + 2) % 3], c[(corner + 1) % 3])).copied();
                    beyond.filter(|b| b.triangle != t as u32)
                })
            })
            .collect();
        Self { sides }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.sides.len() * size_of::<[Option<Beyond>; 3]>()
    }

    /// Whether a triangle has an open edge.
    pub fn at_border(&self, triangle: u32) -> bool {
        self.sides[triangle as usize].contains(&None)
    }

    /// Beyond the edge of `triangle` opposite to `corner`.
    pub fn beyond(&self, triangle: u32, corner: usize) -> Option<Beyond> {
        self.sides[triangle as usize][corner]
    }
}
