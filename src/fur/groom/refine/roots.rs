//! Roots of hair that grew before the skin was cut.

use super::Refined;
use crate::data::strands::Root;
use crate::math::{Vec2, Vec3};
use rayon::prelude::*;

impl Refined {
    /// Takes roots on the skin before to the pieces that they lie on.
    pub fn move_roots(&self, roots: &mut [Root]) {
        let mut number = vec![0; self.cuts.len()];
        self.cuts
            .iter()
            .enumerate()
            .filter(|(_, cut)| cut.pieces.is_empty())
            .zip(0..)
            .for_each(|((t, _), n)| number[t] = n);
        roots.par_iter_mut().for_each(|root| {
            let [x, y] = root.barycentric;
            let point = Vec3::new(x, y, 1.0 - x - y);
            let mut at = root.triangle as usize;
            while let Some(piece) = self.piece_at(at, point) {
                at = piece;
            }
            let inside = barycentric(self.cuts[at].within, point).max(Vec3::ZERO);
            let inside = inside / inside.element_sum().max(f32::MIN_POSITIVE);
            *root = Root { triangle: number[at], barycentric: [inside.x, inside.y] };
        });
    }

    /// The piece of a triangle that a point of the skin's triangle lies on; `None` where it is whole.
    fn piece_at(&self, t: usize, point: Vec3) -> Option<usize> {
        let least = |piece: &u32| barycentric(self.cuts[*piece as usize].within, point).min_element();
        let pieces = self.cuts[t].pieces.iter();
        pieces.max_by(|a, b| least(a).total_cmp(&least(b))).map(|&piece| piece as usize)
    }
}

/// A point's coordinates in the triangle between three others, all in coordinates of one triangle.
fn barycentric([p, q, r]: [Vec3; 3], at: Vec3) -> Vec3 {
    let flat = |v: Vec3| Vec2::new(v.x, v.y);
    let (a, b, c) = (flat(q - p), flat(r - p), flat(at - p));
    let area = a.perp_dot(b);
    let (v, w) = (c.perp_dot(b) / area, a.perp_dot(c) / area);
    Vec3::new(1.0 - v - w, v, w)
}
