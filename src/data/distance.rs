//! How far places of a surface are apart along its edges.

use crate::math::Vec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The distance of each place at `positions_m` from the nearest of `sources` along edges, m; infinite where none leads
/// (Dijkstra 1959). Edges may be named more than once.
pub fn along_edges(
    positions_m: &[Vec3],
    edges: impl IntoIterator<Item = [usize; 2]>,
    sources: impl IntoIterator<Item = usize>,
) -> Vec<f32> {
    let mut around = vec![Vec::new(); positions_m.len()];
    for [a, b] in edges {
        around[a].push(b);
        around[b].push(a);
    }
    let mut away_m = vec![f32::INFINITY; positions_m.len()];
    let mut waiting = BinaryHeap::new();
    for place in sources {
        away_m[place] = 0.0;
        waiting.push((Reverse(0), place));
    }
    // Distances are not negative, so their bits are in their order.
    while let Some((Reverse(bits), place)) = waiting.pop() {
        if bits > away_m[place].to_bits() {
            continue;
        }
        for &next in &around[place] {
            let next_m = away_m[place] + positions_m[place].distance(positions_m[next]);
            if next_m < away_m[next] {
                away_m[next] = next_m;
                waiting.push((Reverse(next_m.to_bits()), next));
            }
        }
    }
    away_m
}
