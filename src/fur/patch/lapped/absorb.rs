//! Crumbs left between patches join a neighbour, at a little more stretch than growth allows.

use super::Surface;
use super::flatten::{Effort, flatten};
use super::patch::{Limits, Patch, fits};
use std::collections::BTreeSet;

/// Patches of at most this share of the mean patch's area count as crumbs: the mean is far above the median.
const CRUMB: f64 = 1.0;
/// How much more skin without comb a patch may have than growth gave it.
const ROOM: f64 = 2.0;
/// What a crumb's triangle must keep to in its new patch.
const LIMITS: Limits = Limits { least: 0.45, most: 2.2, angle_rad: 0.3 };

/// Dissolves crumbs as far as their neighbours take them; emptied patches stay in the list without triangles.
pub(super) fn absorb(surface: &Surface, patches: &mut [Patch], owner: &mut [u32]) {
    let area = |patch: &Patch| patch.faces.iter().map(|&f| surface.faces[f as usize].area_m2).sum::<f64>();
    let areas: Vec<f64> = patches.iter().map(area).collect();
    let limit = CRUMB * areas.iter().sum::<f64>() / patches.len().max(1) as f64;
    let mut crumbs: Vec<usize> = (0..patches.len()).filter(|&p| areas[p] <= limit).collect();
    crumbs.sort_by(|&a, &b| areas[a].total_cmp(&areas[b]).then(a.cmp(&b)));
    let mut changed = BTreeSet::new();
    for crumb in crumbs {
        // All or nothing would keep crumbs that touch several patches; so triangle by triangle, until none moves.
        loop {
            let before = patches[crumb].faces.len();
            let mut keep = vec![true; before];
            for (slot, kept) in keep.iter_mut().enumerate() {
                let t = patches[crumb].faces[slot] as usize;
                let takers = (0..3).filter_map(|k| surface.topology.neighbour(t, k).map(|n| (k, owner[n] as usize)));
                for (k, taker) in takers.filter(|&(_, taker)| taker != crumb) {
                    let Some(joining) = patches[taker].joining(surface, t, k) else { continue };
                    if fits(surface, t, joining.uv, LIMITS) && patches[taker].has_room(surface, t, ROOM) {
                        patches[taker].join(surface, t, &joining);
                        owner[t] = taker as u32;
                        *kept = false;
                        changed.insert(taker);
                        break;
                    }
                }
            }
            patches[crumb].retain(surface, &keep);
            if patches[crumb].faces.len() == before || patches[crumb].faces.is_empty() {
                break;
            }
            changed.insert(crumb);
        }
    }
    for patch in changed {
        if !patches[patch].faces.is_empty() {
            flatten(surface, &mut patches[patch], Effort::Final);
        }
    }
}
