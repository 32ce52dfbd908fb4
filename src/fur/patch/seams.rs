//! Whether seams show: what a tile looks like on both sides of them, against the same inside patches.
//!
//! Strips 16 texels wide lie along an edge on either side, in windows 16 texels long. Across a seam the two show
//! different parts of the tile. A *fake* border is an edge inside a patch, with its far side moved by a random offset. If
//! seams can only be seen as much as the randomness of the tile makes them, the mean squared difference between the
//! windows' means is the same for both. As blurring would pass this, the variance within windows along seams is set
//! against that along edges inside.

use super::face::Face;
use super::measure::{Edge, edges};
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Seams};
use crate::data::topology::Topology;
use crate::math::hash::{combine, unit_f32, unit_f64};
use crate::math::{DVec2, DVec3, Quat, Vec2, Vec3};
use rayon::prelude::*;

/// Texels along each side of a window.
const WINDOW: usize = 16;
/// Texels along each side of a sample: windows are seen in pixels of this size, so that none of their texels is missed.
pub const PIXEL: usize = 4;
/// Windows laid along each kind of edge, spread evenly over their length, where nothing else is asked for. They leave an
/// error of ± 0.04 on the difference, four times as many one of ± 0.02.
pub const WINDOWS: usize = 2000;

/// Where a window lies and from where it is seen. Both sides of an edge share normal, azimuth and the skin's vertices.
#[derive(Clone, Debug)]
pub struct SeamPoint {
    /// Skin vertices of the edge, and how far along it the window's middle is, 0 … 1.
    pub edge: ([u32; 2], f32),
    /// How the skin runs as u and as v grow, as it lies around `normal`, over the tile's edge: unit vectors at right angles
    /// where nothing is stretched.
    pub axes: [Vec3; 2],
    /// Mean normal of the two triangles at the edge.
    pub normal: Vec3,
    /// Unit tangent that slanting views lean towards.
    pub azimuth: Vec3,
    /// What is looked at: the middles of pixels of 4 × 4 texels, in tiles.
    pub uv: Vec<Vec2>,
}

/// Measures the seams of several `sets` of patches on `mesh` that differ in their coordinates only, each against fake borders
/// of its own, for tiles of `tile_edge_m` with `texels` along an edge.
///
/// `seen` gives what is seen at each coordinate of a place in one of the sets, in three views (say luminance at 0, 45 and 75°
/// to the normal). So many `windows` lie along seams, and as many along fake borders.
pub fn compare_seams<const N: usize>(
    mesh: &Mesh,
    sets: [&Patches; N],
    tile_edge_m: f32,
    texels: u32,
    windows: usize,
    seen: impl Fn(usize, &SeamPoint) -> Vec<[f32; 3]> + Sync,
) -> [Seams; N] {
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    let faces = Face::all(mesh);
    let texel_m = f64::from(tile_edge_m) / f64::from(texels.max(1));
    let usable = |edge: &Edge| edge.edges.iter().all(|&e| faces[e / 3].area_m2 > 0.0);
    let seen = |set: usize, edges: &[Edge], fake: bool| {
        let patches = sets[set];
        let strips = Strips { mesh, faces: &faces, patches, texel_m, edge_m: f64::from(tile_edge_m) };
        let sides = |(i, (edge, along)): (usize, (&Edge, f64))| {
            let chance = combine(0x5ea3, i as u64);
            let moved = Vec2::new(unit_f32(combine(chance, 0)), unit_f32(combine(chance, 1)));
            let turn = unit_f32(combine(chance, 2)) * std::f32::consts::TAU;
            let window = |side, moved| Window::of(&seen(set, &strips.place(edge, side, along, turn, moved)));
            [window(0, Vec2::ZERO), window(1, if fake { moved } else { Vec2::ZERO })]
        };
        let seen: Vec<[Window; 2]> = strips.spread(edges, windows).into_par_iter().enumerate().map(sides).collect();
        let mean = |of: &dyn Fn(&[Window; 2]) -> f64| seen.iter().map(of).sum::<f64>() / seen.len().max(1) as f64;
        [0, 1, 2].map(|v| {
            let difference = mean(&|[a, b]| (a.mean[v] - b.mean[v]).powi(2));
            [difference, mean(&|[a, b]| 0.5 * (a.variance[v] + b.variance[v]))]
        })
    };
    let split = |patches| -> (Vec<Edge>, Vec<Edge>) {
        edges(&topology, patches).filter(usable).partition(|edge| edge.joined(patches))
    };
    std::array::from_fn(|set| {
        let (inside, seams) = split(sets[set]);
        let inside = seen(set, &inside, true);
        let found = seen(set, &seams, false);
        let ratio = |v: usize, what: usize| {
            let comparable = !seams.is_empty() && inside[v][what] > 0.0;
            if comparable { found[v][what] / inside[v][what] } else { 1.0 }
        };
        let by_view = [0, 1, 2].map(|v| [ratio(v, 0), ratio(v, 1)]);
        let mean = |what: usize| by_view.iter().map(|view| view[what]).sum::<f64>() / 3.0;
        Seams { edges: seams.len(), difference: mean(0), variance: mean(1), by_view }
    })
}

/// Mean and variance over a window, per view.
struct Window {
    mean: [f64; 3],
    variance: [f64; 3],
}

impl Window {
    fn of(seen: &[[f32; 3]]) -> Self {
        let count = seen.len().max(1) as f64;
        let mean = [0, 1, 2].map(|v| seen.iter().map(|s| f64::from(s[v])).sum::<f64>() / count);
        let off = |v: usize| seen.iter().map(|s| (f64::from(s[v]) - mean[v]).powi(2)).sum::<f64>() / count;
        Self { mean, variance: [0, 1, 2].map(off) }
    }
}

struct Strips<'a> {
    mesh: &'a Mesh,
    faces: &'a [Face],
    patches: &'a Patches,
    texel_m: f64,
    edge_m: f64,
}

impl Strips<'_> {
    /// The edges that windows lie on, and how far along each, evenly over their common length.
    fn spread<'e>(&self, edges: &'e [Edge], windows: usize) -> Vec<(&'e Edge, f64)> {
        let length = |edge: &Edge| {
            let [a, b] = edge.ends[0].map(|v| self.mesh.positions_m[self.patches.base_vertex[v] as usize]);
            f64::from(a.distance(b))
        };
        let total: f64 = edges.iter().map(length).sum();
        let step = total / windows as f64;
        let (mut passed, mut placed) = (0.0, Vec::with_capacity(windows));
        for edge in edges {
            let long = length(edge);
            // Somewhere in each step, so that windows do not keep time with the mesh.
            while placed.len() < windows && long > 0.0 {
                let at = (placed.len() as f64 + unit_f64(combine(0x57e9, placed.len() as u64))) * step;
                if at > passed + long {
                    break;
                }
                placed.push((edge, ((at - passed) / long).clamp(0.0, 1.0)));
            }
            passed += long;
        }
        placed
    }

    /// The window on `side` of `edge` inside that triangle's plane; where the triangle is narrower, its map goes on.
    fn place(&self, edge: &Edge, side: usize, along: f64, turn: f32, moved: Vec2) -> SeamPoint {
        let (t, k) = (edge.edges[side] / 3, edge.edges[side] % 3);
        let face = &self.faces[t];
        let flat = face.corners_m();
        let uv = self.patches.triangles[t].map(|v| self.patches.uv[v as usize].as_dvec2());
        let [x, y] = face.jacobian(uv).unwrap_or_default();
        let (start, end) = (flat[k], flat[(k + 1) % 3]);
        let forwards = (end - start).normalize_or(DVec2::X);
        let inwards = DVec2::new(-forwards.y, forwards.x);
        // The far side runs along the edge the other way.
        let middle = start.lerp(end, if side == 0 { along } else { 1.0 - along });
        let pixels = (0..(WINDOW / PIXEL).pow(2)).map(|i| {
            let [column, row] = [i % (WINDOW / PIXEL), i / (WINDOW / PIXEL)];
            let off = |n: usize| (n as f64 + 0.5) * PIXEL as f64;
            let p = middle + (forwards * (off(column) - 0.5 * WINDOW as f64) + inwards * off(row)) * self.texel_m;
            (uv[0] + x * p.x + y * p.y).as_vec2() + moved
        });
        let [here, there] = edge.edges.map(|e| self.normal(e / 3));
        let normal = (here + there).normalize_or(here).as_vec3();
        let ends = edge.ends[0].map(|v| self.patches.base_vertex[v]);
        let line = ends.map(|v| self.mesh.positions_m[v as usize]);
        let tangent = (line[1] - line[0]).reject_from_normalized(normal).normalize_or_zero();
        // Rows of the inverse map: where the skin runs as u or v alone grows.
        let scale = x.perp_dot(y) * self.edge_m;
        let lie = |d: DVec2| {
            let world = if scale == 0.0 { DVec3::ZERO } else { (face.axes[0] * d.x + face.axes[1] * d.y) / scale };
            Quat::from_rotation_arc(self.normal(t).as_vec3(), normal) * world.as_vec3()
        };
        SeamPoint {
            edge: (ends, along as f32),
            axes: [lie(DVec2::new(y.y, -x.y)), lie(DVec2::new(-y.x, x.x))],
            normal,
            azimuth: tangent * libm::cosf(turn) + normal.cross(tangent) * libm::sinf(turn),
            uv: pixels.collect(),
        }
    }

    fn normal(&self, t: usize) -> DVec3 {
        let [x, y] = self.faces[t].axes;
        x.cross(y)
    }
}
