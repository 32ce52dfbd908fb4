//! Which triangle lies beyond each edge (Andersen et al. 2016 §3.2, Fig. 7).

use crate::data::mesh::Mesh;

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
    /// Of each triangle.
    at_border: Vec<bool>,
}

impl Neighbours {
    /// Of a mesh, across UV and normal seams.
    ///
    /// An edge is known by its two position classes, in the order in which the triangle runs through them; the neighbour has
    /// the reversed one. Where more than two triangles share an edge, or run through
    /// it the same way, the one with the lowest index is taken: a march goes on there, if into one sheet of several.
    pub fn new(mesh: &Mesh) -> Self {
        let classes = |t: usize| mesh.triangles[t].map(|v| mesh.position_class[v as usize]);
        let ends = |c: [u32; 3], corner: usize| [c[(corner + 1) % 3], c[(corner + 2) % 3]];
        // The edges that begin at each class, in the order of the triangles.
        let mut starts = vec![0_u32; mesh.positions_m.len() + 1];
        for t in 0..mesh.triangles.len() {
            classes(t).into_iter().for_each(|from| starts[from as usize + 1] += 1);
        }
        for class in 1..starts.len() {
            starts[class] += starts[class - 1];
        }
        let mut next = starts.clone();
        let mut edges = vec![(0_u32, Beyond { triangle: 0, corner: 0 }); 3 * mesh.triangles.len()];
        for t in 0..mesh.triangles.len() {
            let c = classes(t);
            for corner in 0..3 {
                let [from, to] = ends(c, corner);
                let next = &mut next[from as usize];
                edges[*next as usize] = (to, Beyond { triangle: t as u32, corner: corner as u8 });
                *next += 1;
            }
        }
        let edge = |from: u32, to: u32| {
            let [begin, end] = [starts[from as usize], starts[from as usize + 1]].map(|at| at as usize);
            edges[begin..end].iter().find(|(other, _)| *other == to).map(|&(_, beyond)| beyond)
        };
        let mut open = vec![false; mesh.positions_m.len()];
        let mut side = |t: usize, [from, to]: [u32; 2]| {
            let beyond = edge(to, from).filter(|b| b.triangle != t as u32);
            if beyond.is_none() {
                open[from as usize] = true;
                open[to as usize] = true;
            }
            beyond
        };
        let sides =
            (0..mesh.triangles.len()).map(|t| [0, 1, 2].map(|corner| side(t, ends(classes(t), corner)))).collect();
        let at_border =
            (0..mesh.triangles.len()).map(|t| classes(t).iter().any(|&class| open[class as usize])).collect();
        Self { sides, at_border }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.sides[..]) + size_of_val(&self.at_border[..])
    }

    /// Whether a triangle reaches an open edge, be it with a corner alone.
    pub fn at_border(&self, triangle: u32) -> bool {
        self.at_border[triangle as usize]
    }

    /// Beyond the edge of `triangle` opposite to `corner`.
    pub fn beyond(&self, triangle: u32, corner: usize) -> Option<Beyond> {
        self.sides[triangle as usize][corner]
    }
}
