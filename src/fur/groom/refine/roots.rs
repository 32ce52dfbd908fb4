//! Roots of hair that grew before the skin was cut.

use super::{Cut, Refined};
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
            let (mut at, mut b) = (root.triangle as usize, Vec3::new(x, y, 1.0 - x - y));
            while let Some((piece, inner)) = self.piece_at(at, b) {
                (at, b) = (piece, inner);
            }
            *root = Root { triangle: number[at], barycentric: [b.x, b.y] };
        });
    }

    /// The piece of a triangle that a point of it lies on, and where; `None` where it is whole.
    fn piece_at(&self, t: usize, b: Vec3) -> Option<(usize, Vec3)> {
        let whole = &self.cuts[t];
        let inside = |piece: &u32| {
            let corners = self.cuts[*piece as usize].corners;
            // Corners of pieces are corners of the whole, or lie in the middle of its edges.
            let of = corners.map(|v| self.within(whole, v));
            (*piece as usize, barycentric(of, b))
        };
        let least = |(_, b): &(usize, Vec3)| b.min_element();
        let found = whole.pieces.iter().map(inside).max_by(|a, b| least(a).total_cmp(&least(b)))?;
        let clamped = found.1.max(Vec3::ZERO);
        Some((found.0, clamped / clamped.element_sum().max(f32::MIN_POSITIVE)))
    }

    /// A vertex of a triangle's pieces in its barycentric coordinates.
    fn within(&self, whole: &Cut, v: u32) -> Vec3 {
        let mut b = Vec3::ZERO;
        if let Some(k) = whole.corners.iter().position(|&corner| corner == v) {
            b[k] = 1.0;
            return b;
        }
        for k in 0..3 {
            let [p, q] = [whole.corners[k], whole.corners[(k + 1) % 3]];
            if self.middle_of(p, q) == Some(v) {
                (b[k], b[(k + 1) % 3]) = (0.5, 0.5);
            }
        }
        b
    }

    fn middle_of(&self, p: u32, q: u32) -> Option<u32> {
        self.middles.get(&[p.min(q), p.max(q)]).copied()
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
