//! Which triangle lies across each edge.

use std::collections::HashMap;

/// Marks an edge without one clear neighbour: a border, an edge of three and more triangles, or one whose two
/// triangles run round it the same way.
pub const NO_NEIGHBOUR: u32 = u32::MAX;

/// Neighbours across edges.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// `3 t + k` for edge k of triangle t, from its corner k to corner k + 1: the neighbour's edge, numbered alike,
    /// or [`NO_NEIGHBOUR`].
    pub across: Vec<u32>,
}

impl Topology {
    /// Joins triangles whose edges have the same two `point`s, run through in opposite order.
    ///
    /// Linear in the number of triangles. Triangles with two corners in one point have no neighbours and do not stand
    /// between others.
    pub fn new(triangles: &[[u32; 3]], point: impl Fn(u32) -> u32) -> Self {
        let mut across = vec![NO_NEIGHBOUR; 3 * triangles.len()];
        let mut edges: HashMap<(u32, u32), (u32, u32), Mixed> = HashMap::with_capacity_and_hasher(across.len(), Mixed);
        let ends = |e: u32| {
            let t = triangles[e as usize / 3];
            (point(t[e as usize % 3]), point(t[(e as usize + 1) % 3]))
        };
        let whole = |e: u32| {
            let [a, b, c] = triangles[e as usize / 3].map(&point);
            a != b && b != c && c != a
        };
        for e in 0..across.len() as u32 {
            if whole(e) {
                let (a, b) = ends(e);
                let entry = edges.entry((a.min(b), a.max(b))).or_insert((e, 0));
                entry.1 += 1;
                if entry.1 == 2 && ends(entry.0) == (b, a) {
                    across[e as usize] = entry.0;
                    across[entry.0 as usize] = e;
                }
            }
        }
        for e in 0..across.len() as u32 {
            let (a, b) = ends(e);
            if edges.get(&(a.min(b), a.max(b))).is_some_and(|entry| entry.1 > 2) {
                across[e as usize] = NO_NEIGHBOUR;
            }
        }
        Self { across }
    }

    /// The triangle across edge `k` of triangle `t`.
    pub fn neighbour(&self, t: usize, k: usize) -> Option<usize> {
        let e = self.across[3 * t + k];
        (e != NO_NEIGHBOUR).then_some(e as usize / 3)
    }
}

/// A hasher for pairs of vertex numbers: as good as needed and several times faster than the standard one.
#[derive(Clone, Copy, Default)]
struct Mixed;

struct MixedState(u64);

impl std::hash::BuildHasher for Mixed {
    type Hasher = MixedState;

    fn build_hasher(&self) -> MixedState {
        MixedState(0)
    }
}

impl std::hash::Hasher for MixedState {
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(u32::from(byte));
        }
    }

    fn write_u32(&mut self, value: u32) {
        self.0 = (self.0.rotate_left(32) ^ u64::from(value)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }

    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 29)
    }
}
