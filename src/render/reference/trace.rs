//! One ray: where what a uniform number chooses is met, hair and undercoat in exact order.

use super::bvh::Ray;
use super::guard::{Crossing, Guard};
use super::medium::{Counted, Medium};
use super::quadrature::gauss;
use super::shell::{Place, Span};
use super::skin::Skin;

/// What a ray meets.
#[derive(Clone, Copy, Debug)]
pub enum Met {
    /// A guard hair.
    Guard(Crossing),
    /// Undercoat, at a distance in m.
    Undercoat(f64, Place),
    /// Skin, at a distance in m.
    Skin(f64, Place),
}

/// Lists that a thread keeps for their memory.
#[derive(Debug, Default)]
pub struct Scratch {
    crossings: Vec<Crossing>,
    spans: Vec<Span>,
}

/// What rays may meet.
#[derive(Debug)]
pub struct Tracer<'a> {
    /// Skin.
    pub skin: &'a Skin,
    /// Guard hair.
    pub guard: Option<&'a Guard<'a>>,
    /// Undercoat.
    pub medium: Option<&'a Medium<'a>>,
}

/// Halvings by which the place in undercoat is found: a 32nd of a clump pattern's detail.
const HALVINGS: usize = 5;

impl Tracer<'_> {
    /// Follows a ray until the share of it that has been blocked passes `chosen` in [0, 1): what is met is then chosen in
    /// proportion to how much of it is seen.
    pub fn meet(&self, ray: &Ray, chosen: f64, scratch: &mut Scratch) -> Option<Met> {
        let left = 1.0 - chosen;
        let skin = self.skin.meet(ray, 0.0);
        let far_m = skin.map_or(f64::INFINITY, |(at_m, _)| at_m);
        let mut through = 1.0_f64;
        let mut at_m = 0.0_f64;
        // Boxes are looked for only where the last stretch was empty.
        let mut empty = true;
        loop {
            let Scratch { crossings, spans } = &mut *scratch;
            if empty {
                let hair_m = self.guard.map_or(f64::INFINITY, |guard| guard.first(ray, at_m));
                let undercoat_m = self.medium.map_or(f64::INFINITY, |medium| medium.slabs.first(ray, at_m));
                at_m = at_m.max(hair_m.min(undercoat_m));
            }
            if at_m >= far_m || at_m == f64::INFINITY {
                break;
            }
            let stride_m = self.medium.map_or(0.01, Medium::stride_m);
            let end_m = (at_m + stride_m).min(far_m);
            match self.guard {
                Some(guard) => guard.crossings(ray, at_m, end_m, crossings),
                None => crossings.clear(),
            }
            match self.medium {
                Some(medium) => medium.spans(ray, at_m, end_m, Counted::Undercoat, spans),
                None => spans.clear(),
            }
            empty = crossings.is_empty() && spans.is_empty();
            for next in crossings.iter().map(Some).chain([None]) {
                let to_m = next.map_or(end_m, |crossing| crossing.enter_m);
                if let Some(met) = self.in_undercoat(ray, spans, [at_m, to_m], left, &mut through) {
                    return Some(met);
                }
                at_m = to_m;
                if let (Some(crossing), Some(guard)) = (next, self.guard) {
                    through *= 1.0 - guard.opacity(crossing);
                    if through < left {
                        return Some(Met::Guard(*crossing));
                    }
                }
            }
        }
        skin.map(|(at_m, place)| Met::Skin(at_m, place))
    }

    /// Lowers `through` by the undercoat between two distances; where it passes `left`, says what is met.
    fn in_undercoat(
        &self,
        ray: &Ray,
        spans: &[Span],
        [from_m, to_m]: [f64; 2],
        left: f64,
        through: &mut f64,
    ) -> Option<Met> {
        let medium = self.medium?;
        let mut found = None;
        medium.pieces(ray, spans, [from_m, to_m], Counted::Undercoat, |piece, depth| {
            let after = *through * libm::exp(-depth);
            if after < left {
                found = Some((piece, libm::log(*through / left)));
            }
            *through = after;
            found.is_none()
        });
        let ([mut low, mut high], mut depth) = found?;
        let here = |at_m: f64| spans.iter().filter(move |span| span.from_m <= at_m && span.to_m >= at_m);
        let at = |at_m: f64| -> f64 {
            here(at_m).map(|span| medium.extinction_at(ray, span, at_m, Counted::Undercoat)).sum()
        };
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let before = gauss(low, middle, at);
            if before >= depth {
                high = middle;
            } else {
                (low, depth) = (middle, depth - before);
            }
        }
        let at_m = 0.5 * (low + high);
        let dense = |span: &&Span| medium.extinction_at(ray, span, at_m, Counted::Undercoat);
        let span = here(at_m).max_by(|a, b| dense(a).total_cmp(&dense(b)))?;
        medium.place(ray, span, at_m).map(|place| Met::Undercoat(at_m, place))
    }
}
