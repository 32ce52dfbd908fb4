//! What a parameterisation does to the skin: stretch, angle to the comb, texel density.

use super::face::{self, Face};
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Spread, Stats};
use crate::data::topology::{NO_NEIGHBOUR, Topology};
use crate::math::{DVec2, Vec3};

/// Singular values that pass for unstretched (the bounds that `Stats::within` counts).
pub(super) const WITHIN: [f64; 2] = [0.7, 1.4];

/// Measures any patches of a mesh: those of a file, say. `direction` is the comb, one per vertex, zero where there is none;
/// the patches' triangles must be the mesh's, in its order.
pub fn of(mesh: &Mesh, direction: &[Vec3], tile_edge_m: f32, patches: &Patches) -> Stats {
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    measure(mesh, &topology, &Face::all(mesh), direction, f64::from(tile_edge_m), patches)
}

/// The singular values of the map from skin to texture over the tile scale, larger first, per triangle; `None` without
/// area. The patches' triangles must be the mesh's, in its order.
pub fn singular_values(mesh: &Mesh, tile_edge_m: f64, patches: &Patches) -> Vec<Option<[f64; 2]>> {
    let of = |(face, triangle): (Face, &[u32; 3])| {
        Some(face::singular_values(face.jacobian(triangle.map(|v| patches.uv[v as usize].as_dvec2() * tile_edge_m))?))
    };
    Face::all(mesh).into_iter().zip(&patches.triangles).map(of).collect()
}

/// The edges across which the texture does not go on, as coat vertices of their one side. The patches' triangles must be the
/// mesh's, in its order.
pub fn seam_edges(mesh: &Mesh, patches: &Patches) -> Vec<[u32; 2]> {
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    seams(&topology, patches).map(|edge| edge.ends[0].map(|v| v as u32)).collect()
}

/// Measures `patches` of `mesh` against the comb `direction`, for tiles of `tile_edge_m`.
pub(super) fn measure(
    mesh: &Mesh,
    topology: &Topology,
    faces: &[Face],
    direction: &[Vec3],
    tile_edge_m: f64,
    patches: &Patches,
) -> Stats {
    let mut stats = Stats {
        patches: patches.patch.iter().max().map_or(0, |&p| p as usize + 1),
        faces: patches.triangles.len(),
        ..Stats::default()
    };
    let (mut values, mut densities) = (Vec::new(), Vec::new());
    let (mut angle, mut combed) = (0.0, 0.0);
    for (t, face) in faces.iter().enumerate() {
        let corners = patches.triangles[t].map(|v| patches.uv[v as usize].as_dvec2() * tile_edge_m);
        let Some(jacobian) = face.jacobian(corners) else { continue };
        let [large, small] = face::singular_values(jacobian);
        stats.area_m2 += face.area_m2;
        values.extend([(large, face.area_m2), (small, face.area_m2)]);
        densities.push(((large * small).sqrt() / tile_edge_m, face.area_m2));
        if small >= WITHIN[0] && large <= WITHIN[1] {
            stats.within += face.area_m2;
        }
        if jacobian[0].perp_dot(jacobian[1]) < 0.0 {
            stats.mirrored_m2 += face.area_m2;
        }
        let comb = face.comb(mesh.triangles[t].map(|v| direction[v as usize]));
        if comb != DVec2::ZERO {
            let seen = jacobian[0] * comb.x + jacobian[1] * comb.y;
            angle += face.area_m2 * libm::atan2(seen.y, seen.x).abs();
            combed += face.area_m2;
        }
    }
    stats.seams_m = seams(topology, patches)
        .map(|seam| {
            let [a, b] = seam.ends[0].map(|v| mesh.positions_m[patches.base_vertex[v] as usize]);
            f64::from(a.distance(b))
        })
        .fold(0.0, |sum, length| sum + length);
    stats.within /= stats.area_m2.max(f64::MIN_POSITIVE);
    stats.field_angle_rad = angle / f64::max(combed, f64::MIN_POSITIVE);
    stats.singular_values = spread(values);
    stats.tiles_per_m = spread(densities);
    stats
}

/// An edge between two triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// The edge as `3 t + k` of its two triangles.
    pub edges: [usize; 2],
    /// Coat vertices of its ends on both sides, in the same order.
    pub ends: [[usize; 2]; 2],
}

/// Shifts nearer than this to a whole number of tiles cannot be seen, in tiles.
const WHOLE: f32 = 1e-4;

impl Edge {
    /// Whether both sides are the same coat vertices, or have the same coordinates on vertices that the skin itself keeps
    /// apart.
    pub fn joined(&self, patches: &Patches) -> bool {
        (0..2).map(|k| [self.ends[0][k], self.ends[1][k]]).all(|[a, b]| {
            a == b || (patches.base_vertex[a] != patches.base_vertex[b] && patches.uv[a] == patches.uv[b])
        })
    }

    /// Whether the texture goes on across it: the sides' coordinates differ by the same whole number of tiles at both ends.
    pub fn continued(&self, patches: &Patches) -> bool {
        let [a, b] = [0, 1].map(|k| patches.uv[self.ends[0][k]] - patches.uv[self.ends[1][k]]);
        (a - b).abs().max_element() < WHOLE && (a - a.round()).abs().max_element() < WHOLE
    }
}

/// All edges that have one clear neighbour, each once.
pub(super) fn edges<'a>(topology: &'a Topology, patches: &'a Patches) -> impl Iterator<Item = Edge> + 'a {
    let vertex = |e: usize| patches.triangles[e / 3][e % 3] as usize;
    let next = |e: usize| e - e % 3 + (e + 1) % 3;
    (0..topology.across.len()).filter_map(move |e| {
        let across = topology.across[e];
        let other = across as usize;
        // Each edge once, from its lower side.
        (across != NO_NEIGHBOUR && e < other).then(|| Edge {
            edges: [e, other],
            ends: [[vertex(e), vertex(next(e))], [vertex(next(other)), vertex(other)]],
        })
    })
}

/// The edges whose sides have coordinates of their own: borders between patches, and cuts within them.
pub(super) fn borders<'a>(topology: &'a Topology, patches: &'a Patches) -> impl Iterator<Item = Edge> + 'a {
    edges(topology, patches).filter(|edge| !edge.joined(patches))
}

/// The edges across which the texture does not go on.
pub(super) fn seams<'a>(topology: &'a Topology, patches: &'a Patches) -> impl Iterator<Item = Edge> + 'a {
    edges(topology, patches).filter(|edge| !edge.continued(patches))
}

/// Mean and percentiles of (value, weight) pairs; zeros for none.
pub(super) fn spread(mut values: Vec<(f64, f64)>) -> Spread {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|v| v.1).sum();
    let percentile = |share: f64| {
        let mut below = 0.0;
        values
            .iter()
            .find(|v| {
                below += v.1;
                below >= share * total
            })
            .map_or(0.0, |v| v.0)
    };
    let mean = values.iter().map(|v| v.0 * v.1).sum::<f64>() / total.max(f64::MIN_POSITIVE);
    Spread { mean, p5: percentile(0.05), p95: percentile(0.95) }
}
