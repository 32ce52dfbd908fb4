//! Hair at the rim of sheets and blades.

use crate::data::mesh::Mesh;
use crate::data::topology::Topology;
use crate::math::Vec3;
use std::collections::{HashMap, HashSet};

/// Turns normals half way out where both sides of a sheet or a blade end in one edge, so that hair of the two meets over it. `stored` says which part's
/// which vertex each of the mesh's is.
pub(super) fn fan(mesh: &Mesh, stored: &[(u32, u32)], normals: &mut [Vec3]) {
    let class = |v: u32| mesh.position_class[v as usize];
    let mut first: HashMap<(u32, u32), u32> = HashMap::new();
    let mut twofold: HashSet<(u32, u32)> = HashSet::new();
    for (v, &of) in stored.iter().enumerate() {
        if *first.entry(of).or_insert(class(v as u32)) != class(v as u32) {
            twofold.insert(of);
        }
    }
    if twofold.is_empty() {
        return;
    }
    let topology = Topology::new(&mesh.triangles, class);
    let mut out = vec![Vec3::ZERO; normals.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for k in (0..3).filter(|&k| topology.neighbour(t, k).is_none()) {
            let [a, b, c] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
            if [a, b].iter().all(|&v| twofold.contains(&stored[v as usize])) {
                let [p, q, r] = [a, b, c].map(|v| mesh.positions_m[v as usize]);
                let away = (p - r).reject_from((q - p).normalize_or_zero()).normalize_or_zero();
                [a, b].into_iter().for_each(|v| out[class(v) as usize] += away);
            }
        }
    }
    for (v, normal) in normals.iter_mut().enumerate() {
        *normal = (*normal + out[class(v as u32) as usize].normalize_or_zero()).normalize_or(*normal);
    }
}
