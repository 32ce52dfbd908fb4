//! Columns of stored shadow that several prisms have in common.

use crate::math::Vec3;
use crate::volume::shell::Shell;
use std::sync::OnceLock;

/// Columns of depths by level that several prisms share: over vertices and over the middles of edges, where every prism's
/// lattice has corners. Filled by whichever prism is first to need one, from the prism that lies first in space.
#[derive(Debug)]
pub(super) struct SharedColumns {
    /// By position class.
    vertices: Vec<OnceLock<Box<[u8]>>>,
    /// The first triangle around each position class, and which of its corners that is.
    first: Vec<Option<(u32, usize)>>,
    /// By triangle and the corner opposite to the edge.
    edges: Vec<[OnceLock<Box<[u8]>>; 3]>,
}

/// Where a column of depths stands.
pub(super) struct Site<'c> {
    pub(super) triangle: u32,
    pub(super) b: Vec3,
    /// Where it is kept for other prisms.
    pub(super) shared: Option<&'c OnceLock<Box<[u8]>>>,
}

impl Site<'_> {
    pub(super) fn stored(&self) -> Option<&[u8]> {
        self.shared.and_then(OnceLock::get).map(|codes| &**codes)
    }
}

impl SharedColumns {
    pub(super) fn new(shell: &Shell<'_>) -> Self {
        let order = |t: u32| shell.skin.order_in_space(t as usize);
        let classes = &shell.skin.position_class;
        let mut first: Vec<Option<(u32, usize)>> = vec![None; classes.len()];
        for (t, triangle) in shell.skin.triangles.iter().enumerate() {
            // Beside borders depths are followed further, and each prism's are its own.
            if !shell.neighbours.at_border(t as u32) {
                for (corner, &v) in triangle.iter().enumerate() {
                    let first = &mut first[classes[v as usize] as usize];
                    if first.is_none_or(|(other, _)| order(t as u32) < order(other)) {
                        *first = Some((t as u32, corner));
                    }
                }
            }
        }
        Self {
            vertices: std::iter::repeat_with(OnceLock::new).take(classes.len()).collect(),
            first,
            edges: std::iter::repeat_with(Default::default).take(shell.skin.triangles.len()).collect(),
        }
    }

    /// Of a corner of a prism's lattice.
    pub(super) fn site(&self, shell: &Shell<'_>, triangle: u32, b: Vec3) -> Site<'_> {
        let own = Site { triangle, b, shared: None };
        if shell.neighbours.at_border(triangle) {
            return own;
        }
        let parts = b.to_array();
        let corner_of = |value: f32| parts.iter().position(|&part| part == value);
        if let Some(corner) = corner_of(1.0) {
            let class = shell.skin.position_class[shell.skin.triangles[triangle as usize][corner] as usize] as usize;
            return match self.first[class] {
                Some((triangle, corner)) => {
                    Site { triangle, b: Vec3::AXES[corner], shared: Some(&self.vertices[class]) }
                }
                None => own,
            };
        }
        let opposite = corner_of(0.0).filter(|&corner| parts[(corner + 1) % 3] == 0.5);
        let Some(corner) = opposite else { return own };
        let there_and_back = shell.neighbours.beyond(triangle, corner).filter(|other| {
            let back = shell.neighbours.beyond(other.triangle, usize::from(other.corner));
            back.is_some_and(|back| (back.triangle, usize::from(back.corner)) == (triangle, corner))
        });
        let Some(other) = there_and_back.filter(|other| !shell.neighbours.at_border(other.triangle)) else {
            return own;
        };
        let order = |t: u32| shell.skin.order_in_space(t as usize);
        let (triangle, corner) = if order(other.triangle) < order(triangle) {
            (other.triangle, usize::from(other.corner))
        } else {
            (triangle, corner)
        };
        let b = (Vec3::ONE - Vec3::AXES[corner]) * 0.5;
        Site { triangle, b, shared: Some(&self.edges[triangle as usize][corner]) }
    }
}
