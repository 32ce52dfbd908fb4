//! The terms of the law: products of up to four of what a place is told by, picked one by one for what they add to the
//! likelihood of what was counted in slabs of the default fibre, four colours together.

use super::Place;
use crate::shade::Real;

/// Terms for light from one direction.
pub const TERMS: usize = 22;
/// Terms for the sky.
pub const SKY_TERMS: usize = 12;
/// Factors of a term: of a cubic in the colour's logit.
pub const COLOUR_TERMS: usize = 4;

/// Deepest hair area that the slab was followed for.
pub const DEEPEST: f64 = 16.0;
/// ln of the least and greatest depth that it was, over that of hair at a right angle to the light.
pub const SLANTS: [f64; 2] = [-2.0, 0.2];
/// Hair area above at which depth counts half for how much the light's way is on a slant.
pub const THIN: f64 = 0.03;
/// Depth per hair area at a right angle that stands in where there is none above.
pub const USUAL: f64 = 0.8;
/// Least cosine of light to the normal that it was.
pub const LOWEST_LIGHT: f64 = 0.06;
/// Least cosine of an eye.
pub const LOWEST_EYE: f64 = -0.3;

#[inline(always)]
fn within<R: Real>(x: R, low: f64, high: f64) -> R {
    x.max(R::of(low)).min(R::of(high))
}

/// √ of the hair area above, as far as it was followed.
#[inline(always)]
fn root_of<R: Real>(above: R) -> R {
    within(above, 1e-4, DEEPEST).sqrt()
}

/// For light from one direction.
#[inline(always)]
pub(super) fn light<R: Real>(place: &Place<R>) -> [R; TERMS] {
    let x = root_of(place.above);
    let (p, q) = (place.light_hair, place.eye_hair);
    let k = place.light_eye - p * q;
    let ct = place.hair_normal;
    let cv = within(place.eye_normal, LOWEST_EYE, 1.0);
    let cl = within(place.light_normal, LOWEST_LIGHT, 1.0);
    // Where next to nothing lies above, its quotients say nothing.
    let (thin, usual) = (R::of(THIN), R::of(THIN * USUAL));
    let across = (place.depth * cl + usual) / (place.above.max(R::of(0.0)) + thin);
    let slant = within(across.max(R::of(1e-3)).ln(), SLANTS[0], SLANTS[1]) - cl.ln();
    let (pq, qq, x2) = (p * q, q * q, x * x);
    let slanted = slant * cl;
    [
        R::of(1.0),
        x,
        cl,
        x2,
        x2 * slant,
        slanted,
        pq,
        x * slant,
        slant * cv,
        slanted * cl,
        x2 * x,
        slant * qq,
        k,
        x * slant * slanted,
        ct * ct,
        x * q * ct,
        pq * pq,
        qq * ct * cl,
        p * p,
        x2 * slant * slant,
        cl * cl,
        q * ct * cl,
    ]
}

/// For the sky.
#[inline(always)]
pub(super) fn sky<R: Real>(place: &Place<R>) -> [R; SKY_TERMS] {
    let x = root_of(place.above);
    let q = place.eye_hair;
    let ct = place.hair_normal;
    let cv = within(place.eye_normal, LOWEST_EYE, 1.0);
    let x2 = x * x;
    let (qc, cc) = (q * ct, ct * cv);
    [R::of(1.0), x, qc, x2, cv, ct, x2 * x * ct, cc * cv, x * ct * ct, x * q * q * q, x * qc * cv, cc]
}
