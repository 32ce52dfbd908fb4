//! Where the next patch begins: on the uncovered triangle with most uncovered triangles between it and the covered.

use super::patch::FREE;
use crate::data::topology::Topology;
use crate::math::hash::combine;
use std::collections::{BinaryHeap, VecDeque};

/// Uncovered triangles by their distance from the covered ones, in triangles; chance (a hash) decides among equals.
pub(super) struct Seeds {
    hops: Vec<u32>,
    queue: BinaryHeap<(u32, u64, u32)>,
}

impl Seeds {
    /// All of `count` triangles uncovered and far from anything.
    pub fn new(count: usize, seed: u64) -> Self {
        let queue = (0..count as u32).map(|t| (u32::MAX, combine(seed, u64::from(t)), t)).collect();
        Self { hops: vec![u32::MAX; count], queue }
    }

    /// The next seed, `None` when all is covered.
    pub fn next(&mut self, owner: &[u32]) -> Option<usize> {
        while let Some((hops, chance, t)) = self.queue.pop() {
            let now = self.hops[t as usize];
            if owner[t as usize] != FREE {
                continue;
            }
            if now == hops {
                return Some(t as usize);
            }
            // Distances only shrink: the entry was too high in the queue.
            self.queue.push((now, chance, t));
        }
        None
    }

    /// Notes that `faces` are covered now.
    pub fn cover(&mut self, topology: &Topology, faces: &[u32], owner: &[u32]) {
        let mut waiting: VecDeque<u32> = faces.iter().copied().collect();
        for &face in faces {
            self.hops[face as usize] = 0;
        }
        while let Some(face) = waiting.pop_front() {
            let next = self.hops[face as usize] + 1;
            for k in 0..3 {
                if let Some(other) = topology.neighbour(face as usize, k)
                    && owner[other] == FREE
                    && self.hops[other] > next
                {
                    self.hops[other] = next;
                    waiting.push_back(other as u32);
                }
            }
        }
    }
}
