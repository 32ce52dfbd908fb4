//! Lays a patch flat: least squares between the gradients of (u, v) and the rotation each triangle aims at.
//!
//! Minimises Σ_f A_f |∇(u, v) − M_f|². For M_f that bring the comb to +u this is Praun et al. 2000's fit of texture to
//! field, and its normal equations are a cotangent Laplacian with the divergence of M on the right. Where the field
//! turns, no map follows it without stretch; so M_f is then moved part of the way towards the rotation that the
//! triangle took, as in as-rigid-as-possible flattening (Liu et al. 2008), and the same factorisation solves again.

use super::Surface;
use super::patch::{Patch, conjugate};
use crate::math::DVec2;
use crate::math::sparse::Cholesky;

/// How far a triangle's aim follows the rotation it took rather than its comb: 0 keeps to the comb at any stretch, 1
/// forgets it.
const YIELD: f64 = 0.2;
/// Weight of a plain spring along each edge, against cotangents: holds triangles without area, and slivers.
const SPRING: f64 = 1e-4;

/// How often aims move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// Once: enough to see how far a growing patch may go.
    Sketch,
    /// Until more changes nothing that counts.
    Final,
}

/// Solves for the flat positions of `patch`, then scales them so that its singular values are 1 on average.
pub(super) fn flatten(surface: &Surface, patch: &mut Patch, effort: Effort) {
    let rounds = if effort == Effort::Sketch { 1 } else { 3 };
    let unknowns = patch.uv.len() - 1;
    let springs: Vec<[f64; 3]> = patch.faces.iter().map(|&f| weights(surface.faces[f as usize].corners_m())).collect();
    let mut lower = Vec::with_capacity(12 * patch.faces.len());
    for (corners, weights) in patch.corners.iter().zip(&springs) {
        for (k, &weight) in weights.iter().enumerate() {
            let [i, j] = [corners[k] as usize, corners[(k + 1) % 3] as usize];
            // Vertex 0 is held at the origin, so that it has no row.
            for v in [i, j] {
                if v > 0 {
                    lower.push((v - 1, v - 1, weight));
                }
            }
            if i.min(j) > 0 && i != j {
                lower.push((i.max(j) - 1, i.min(j) - 1, -weight));
            }
        }
    }
    let Some(cholesky) = Cholesky::new(unknowns, &lower) else { return };
    for round in 0..=rounds {
        let mut sides = vec![0.0; 2 * unknowns];
        for (slot, corners) in patch.corners.iter().enumerate() {
            let flat = surface.faces[patch.faces[slot] as usize].corners_m();
            for k in 0..3 {
                let pull = patch.frames[slot].turn.rotate(flat[(k + 1) % 3] - flat[k]) * springs[slot][k];
                for (v, sign) in [(corners[k] as usize, -1.0), (corners[(k + 1) % 3] as usize, 1.0)] {
                    if v > 0 {
                        sides[v - 1] += sign * pull.x;
                        sides[unknowns + v - 1] += sign * pull.y;
                    }
                }
            }
        }
        cholesky.solve(&mut sides);
        patch.uv[0] = DVec2::ZERO;
        for v in 0..unknowns {
            patch.uv[v + 1] = DVec2::new(sides[v], sides[unknowns + v]);
        }
        if round < rounds {
            aim(surface, patch);
        }
    }
    rescale(surface, patch);
}

/// Weight of each edge (k to k + 1): half the cotangent of the angle opposite, and a spring.
fn weights(corners: [DVec2; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let far = corners[(k + 2) % 3];
        let (a, b) = (corners[k] - far, corners[(k + 1) % 3] - far);
        let double_area = a.perp_dot(b);
        SPRING + if double_area > 0.0 { 0.5 * a.dot(b) / double_area } else { 0.0 }
    })
}

/// Moves each triangle's aim towards the rotation nearest to what it took.
fn aim(surface: &Surface, patch: &mut Patch) {
    for slot in 0..patch.faces.len() {
        let Some([x, y]) = surface.faces[patch.faces[slot] as usize].jacobian(patch.flat(slot)) else { continue };
        let taken = DVec2::new(x.x + y.y, x.y - y.x).normalize_or_zero();
        if taken != DVec2::ZERO {
            let frame = &mut patch.frames[slot];
            let off = taken.rotate(conjugate(frame.combed));
            let angle = libm::atan2(off.y, off.x) * (1.0 - (1.0 - YIELD) * frame.trust);
            frame.turn = frame.combed.rotate(DVec2::new(libm::cos(angle), libm::sin(angle)));
        }
    }
}

/// Least squares leave gradients a little short; brings their mean back to 1.
fn rescale(surface: &Surface, patch: &mut Patch) {
    let (mut sum, mut area) = (0.0, 0.0);
    for slot in 0..patch.faces.len() {
        let face = &surface.faces[patch.faces[slot] as usize];
        if let Some([x, y]) = face.jacobian(patch.flat(slot)) {
            // The larger singular value plus the smaller, with the sign of the orientation.
            sum += face.area_m2 * DVec2::new(x.x + y.y, x.y - y.x).length();
            area += face.area_m2;
        }
    }
    if sum > 0.0 {
        let scale = 2.0 * area / sum;
        patch.uv.iter_mut().for_each(|uv| *uv *= scale);
    }
}
