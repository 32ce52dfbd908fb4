//! Undercoat along a ray in pieces, one behind the other.

use super::point::ShellPoint;

/// A stretch of undercoat, as dense throughout.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// From, m.
    pub from_m: f64,
    /// To, m.
    pub to_m: f64,
    /// Optical depth.
    pub depth: f64,
    /// Share of light that it blocks.
    pub opacity: f64,
    /// Its middle.
    pub place: ShellPoint,
    /// How much of it has been seen.
    pub seen: f64,
}

impl Piece {
    /// Share of light that it blocks between two distances within it.
    pub fn blocks(&self, from_m: f64, to_m: f64) -> f64 {
        if from_m == self.from_m && to_m == self.to_m {
            return self.opacity;
        }
        -libm::expm1(-self.depth * (to_m - from_m) / (self.to_m - self.from_m))
    }
}

/// Sorts the pieces from `first` on by distance; where some lie over each other, as in creases, they become one as deep as
/// all, in the place of the densest.
pub fn put_in_order(pieces: &mut Vec<Piece>, first: usize) {
    pieces[first..].iter_mut().for_each(|piece| piece.opacity = -libm::expm1(-piece.depth));
    pieces[first..].sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
    let apart = |pair: &[Piece]| pair[0].to_m - pair[1].from_m <= ROUNDING * pair[1].to_m;
    if pieces[first..].windows(2).all(apart) {
        return;
    }
    let folded = pieces.split_off(first);
    let mut ends: Vec<f64> = folded.iter().flat_map(|piece| [piece.from_m, piece.to_m]).collect();
    ends.sort_unstable_by(f64::total_cmp);
    let (mut active, mut next): (Vec<&Piece>, usize) = (Vec::new(), 0);
    for pair in ends.windows(2) {
        let (from_m, to_m) = (pair[0], pair[1]);
        if to_m - from_m <= ROUNDING * to_m {
            continue;
        }
        let middle_m = 0.5 * (from_m + to_m);
        active.retain(|piece| piece.to_m > middle_m);
        while let Some(piece) = folded.get(next).filter(|piece| piece.from_m < middle_m) {
            if piece.to_m > middle_m {
                active.push(piece);
            }
            next += 1;
        }
        let density = |piece: &Piece| piece.depth / (piece.to_m - piece.from_m);
        if let Some(densest) = active.iter().max_by(|a, b| density(a).total_cmp(&density(b))) {
            let depth = active.iter().map(|piece| density(piece)).sum::<f64>() * (to_m - from_m);
            pieces.push(Piece { from_m, to_m, depth, opacity: -libm::expm1(-depth), place: densest.place, seen: 0.0 });
        }
    }
}

/// Of a distance: pieces that lie over each other by less only seem to.
const ROUNDING: f64 = 1e-12;
