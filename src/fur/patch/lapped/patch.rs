//! A patch: triangles laid flat, and the rule by which one more may join.

use super::Surface;
use crate::data::topology::NO_NEIGHBOUR;
use crate::fur::patch::face::singular_values;
use crate::math::DVec2;
use std::collections::HashMap;

/// Owner of a triangle that no patch has yet.
pub(super) const FREE: u32 = u32::MAX;

/// How much a triangle may be stretched and turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Least singular value.
    pub least: f64,
    /// Greatest singular value.
    pub most: f64,
    /// Greatest angle between comb and +u, rad.
    pub angle_rad: f64,
}

/// How a triangle is to lie: rotations from its own axes to (u, v), as unit complex numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchFrame {
    /// The rotation that brings the comb to +u; without comb, the one that continues the neighbour's.
    pub combed: DVec2,
    /// How far the comb is to be believed, 0 … 1.
    pub trust: f64,
    /// The rotation aimed at.
    pub turn: DVec2,
}

/// A patch in the making. Vertices are numbered within it; one place may have several, on both sides of a cut.
#[derive(Clone, Debug, Default)]
pub(super) struct Patch {
    /// Triangles in the order of growth; the first is the seed.
    pub faces: Vec<u32>,
    /// Their vertices.
    pub corners: Vec<[u32; 3]>,
    /// How they are to lie.
    pub frames: Vec<PatchFrame>,
    /// Per vertex: flat position, m. Vertex 0 stays at the origin.
    pub uv: Vec<DVec2>,
    /// Per vertex: its place on the skin.
    places: Vec<u32>,
    /// Per vertex: the previous one at the same place, plus one, or 0.
    previous: Vec<u32>,
    /// The latest vertex at a place.
    latest: HashMap<u32, u32>,
    /// Where a triangle is in `faces`.
    slots: HashMap<u32, u32>,
    /// Its skin without comb, m².
    free_m2: f64,
}

/// How a triangle would join.
pub(super) struct Joining {
    /// Its vertices; the count of vertices for a new one.
    pub corners: [u32; 3],
    /// Flat positions, m.
    pub uv: [DVec2; 3],
    /// How it is to lie.
    pub frame: PatchFrame,
}

/// Two ways to a place are one vertex when they meet within this share of the triangle's edges there.
const MEETING: f64 = 0.5;

impl Patch {
    /// The patch of `seed` alone.
    ///
    /// `turn` is how it lies where there is no comb.
    pub fn new(surface: &Surface, seed: usize, turn: DVec2) -> Self {
        let mut patch = Self::default();
        let frame = frame(surface, seed, turn, DVec2::X);
        let uv = surface.faces[seed].corners_m().map(|p| frame.turn.rotate(p));
        for (k, uv) in uv.into_iter().enumerate() {
            patch.push_vertex(surface.place(seed, k), uv);
        }
        patch.push_face(surface, seed, [0, 1, 2], frame);
        patch
    }

    /// How triangle `t` would join across its edge `k`; `None` where the triangle there is not in the patch.
    pub fn joining(&self, surface: &Surface, t: usize, k: usize) -> Option<Joining> {
        let across = surface.topology.across[3 * t + k];
        if across == NO_NEIGHBOUR {
            return None;
        }
        let (other, j) = (across / 3, across as usize % 3);
        let slot = *self.slots.get(&other)? as usize;
        let [a, b] = [self.corners[slot][(j + 1) % 3], self.corners[slot][j]];

        let flat = surface.faces[t].corners_m();
        let there = surface.faces[other as usize].corners_m();
        let beyond = self.frames[slot];
        // Unfolding over the edge: both rotations send it to the same direction.
        let edge_here = (flat[(k + 1) % 3] - flat[k]).normalize_or(DVec2::X);
        let edge_there = (there[j] - there[(j + 1) % 3]).normalize_or(DVec2::X);
        let unfolded = beyond.turn.rotate(edge_there).rotate(conjugate(edge_here));
        let deviation =
            if surface.is_free(other as usize) { DVec2::X } else { beyond.turn.rotate(conjugate(beyond.combed)) };
        let frame = frame(surface, t, unfolded, deviation);

        let far = (k + 2) % 3;
        let reach = [k, (k + 1) % 3].map(|c| flat[far] - flat[c]);
        let guess = 0.5
            * (self.uv[a as usize] + frame.turn.rotate(reach[0]) + self.uv[b as usize] + frame.turn.rotate(reach[1]));
        let near = MEETING * reach[0].length().min(reach[1].length());
        let third = self
            .shared(surface, t, [(k + 1) % 3, far], b)
            .or_else(|| self.shared(surface, t, [far, k], a))
            .or_else(|| self.nearest(surface.place(t, far), guess, near));
        let mut corners = [0; 3];
        let mut uv = [DVec2::ZERO; 3];
        for (corner, vertex) in [(k, Some(a)), ((k + 1) % 3, Some(b)), (far, third)] {
            corners[corner] = vertex.unwrap_or(self.uv.len() as u32);
            uv[corner] = vertex.map_or(guess, |v| self.uv[v as usize]);
        }
        Some(Joining { corners, uv, frame })
    }

    /// The vertex at the far end of edge `ends[0]` of triangle `t`, where the triangle across that edge is in the patch
    /// and its near end is vertex `near`.
    fn shared(&self, surface: &Surface, t: usize, ends: [usize; 2], near: u32) -> Option<u32> {
        let across = surface.topology.across[3 * t + ends[0]];
        if across == NO_NEIGHBOUR {
            return None;
        }
        let slot = *self.slots.get(&(across / 3))? as usize;
        let j = across as usize % 3;
        // Across an edge the corners run the other way: its start here is its end there.
        let [start, end] = [self.corners[slot][(j + 1) % 3], self.corners[slot][j]];
        match (start == near, end == near) {
            (true, _) => Some(end),
            (_, true) => Some(start),
            _ => None,
        }
    }

    /// The vertex at `place` nearest to `guess`, within `reach`.
    fn nearest(&self, place: u32, guess: DVec2, reach: f64) -> Option<u32> {
        let mut best = None;
        let mut within = reach;
        let mut at = self.latest.get(&place).map_or(0, |&v| v + 1);
        while at != 0 {
            let distance = self.uv[at as usize - 1].distance(guess);
            if distance < within {
                (best, within) = (Some(at - 1), distance);
            }
            at = self.previous[at as usize - 1];
        }
        best
    }

    /// Takes triangle `t` in.
    pub fn join(&mut self, surface: &Surface, t: usize, joining: &Joining) {
        for k in 0..3 {
            if joining.corners[k] as usize == self.uv.len() {
                self.push_vertex(surface.place(t, k), joining.uv[k]);
            }
        }
        self.push_face(surface, t, joining.corners, joining.frame);
    }

    fn push_vertex(&mut self, place: u32, uv: DVec2) {
        let new = self.uv.len() as u32;
        self.previous.push(self.latest.insert(place, new).map_or(0, |v| v + 1));
        self.places.push(place);
        self.uv.push(uv);
    }

    /// Whether triangle `t` is not too much skin without comb for one patch, or `factor` times as much.
    pub fn has_room(&self, surface: &Surface, t: usize, factor: f64) -> bool {
        !surface.is_free(t) || self.free_m2 + surface.faces[t].area_m2 <= factor * surface.most_free_m2
    }

    fn push_face(&mut self, surface: &Surface, t: usize, corners: [u32; 3], frame: PatchFrame) {
        self.slots.insert(t as u32, self.faces.len() as u32);
        if surface.is_free(t) {
            self.free_m2 += surface.faces[t].area_m2;
        }
        self.faces.push(t as u32);
        self.corners.push(corners);
        self.frames.push(frame);
    }

    /// Keeps the triangles with a true entry and the vertices they use.
    pub fn retain(&mut self, surface: &Surface, keep: &[bool]) {
        let old = std::mem::take(self);
        let mut number = vec![u32::MAX; old.uv.len()];
        for (slot, &face) in old.faces.iter().enumerate().filter(|(slot, _)| keep[*slot]) {
            let corners = old.corners[slot].map(|v| {
                if number[v as usize] == u32::MAX {
                    number[v as usize] = self.uv.len() as u32;
                    self.push_vertex(old.places[v as usize], old.uv[v as usize]);
                }
                number[v as usize]
            });
            self.push_face(surface, face as usize, corners, old.frames[slot]);
        }
    }

    /// The slot across edge `k` of the triangle in `slot`, where both have that edge's vertices in common.
    pub fn beside(&self, surface: &Surface, slot: usize, k: usize) -> Option<usize> {
        let across = surface.topology.across[3 * self.faces[slot] as usize + k];
        if across == NO_NEIGHBOUR {
            return None;
        }
        let other = *self.slots.get(&(across / 3))? as usize;
        let j = across as usize % 3;
        let here = [self.corners[slot][k], self.corners[slot][(k + 1) % 3]];
        (here == [self.corners[other][(j + 1) % 3], self.corners[other][j]]).then_some(other)
    }

    /// Flat positions of the triangle in `slot`, m.
    pub fn flat(&self, slot: usize) -> [DVec2; 3] {
        self.corners[slot].map(|v| self.uv[v as usize])
    }
}

/// How triangle `t` is to lie beside a neighbour that unfolds to `unfolded` and deviates from its comb by `deviation`.
fn frame(surface: &Surface, t: usize, unfolded: DVec2, deviation: DVec2) -> PatchFrame {
    let comb = surface.comb[t];
    let trust = comb.length();
    if surface.is_free(t) {
        return PatchFrame { combed: unfolded, trust: 0.0, turn: unfolded };
    }
    let combed = conjugate(comb / trust);
    PatchFrame { combed, trust, turn: combed.rotate(deviation) }
}

/// Whether triangle `t` laid at `uv` (m) keeps within `limits`; triangles without area always do.
pub(super) fn fits(surface: &Surface, t: usize, uv: [DVec2; 3], limits: Limits) -> bool {
    let Some([x, y]) = surface.faces[t].jacobian(uv) else { return true };
    let [large, small] = singular_values([x, y]);
    if x.perp_dot(y) <= 0.0 || large > limits.most || small < limits.least {
        return false;
    }
    let comb = surface.comb[t];
    let seen = x * comb.x + y * comb.y;
    surface.is_free(t) || libm::atan2(seen.y, seen.x).abs() <= limits.angle_rad
}

pub(super) fn conjugate(z: DVec2) -> DVec2 {
    DVec2::new(z.x, -z.y)
}
