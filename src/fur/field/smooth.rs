//! The smoothest field that follows the wishes.
//!
//! Minimises Σ w_ij |x_j − R_ij x_i|² + Σ λ_i |x_i − d_i|² over tangent vectors x: the connection Laplacian (Singer and
//! Wu 2012; for direction fields Knöppel et al. 2013), with cotangent weights w, transport R along each edge, and
//! wishes d of weight λ. One sparse Cholesky factorisation solves it.

use crate::data::mesh::Mesh;
use crate::math::sparse::Cholesky;
use crate::math::{DVec3, Quat, Vec3, orthonormal_basis};
use std::collections::BTreeMap;

/// How firmly a wish holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Hold {
    /// No wish.
    #[default]
    Free,
    /// A leaning of strength 0 … 1, smoothed over [`REACH`].
    Leaning(f32),
    /// Kept to the letter.
    Kept,
}

/// What a source wants at a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wish {
    /// Tangent unit vector, or zero.
    pub direction: Vec3,
    /// How firmly.
    pub hold: Hold,
}

/// Leanings are smoothed over this share of the mesh's diagonal: wide enough to pass over bumps of the skin.
const REACH: f64 = 0.02;
/// Weight of kept wishes over that of the edges around them.
const FIRM: f64 = 1e6;
/// Weight of the leaning in parts that no source covers, over that of a plain leaning.
const FALLBACK: f64 = 1e-3;
/// Bounds of cotangent weights: obtuse triangles would repel, slivers would tie their ends together for good.
const WEIGHTS: [f64; 2] = [0.05, 20.0];

/// Rotates a tangent vector from the plane of `from` to that of `to` the shortest way; a normal that flips (the skin
/// has one side only, or winding changes) does not turn the vector over.
pub(super) fn transport(vector: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    Quat::from_rotation_arc(from, to) * vector
}

/// A tangent unit vector per vertex; see the head of this file.
pub(super) fn smooth(mesh: &Mesh, normals: &[Vec3], wishes: &[Wish]) -> Vec<Vec3> {
    let class = |v: u32| mesh.position_class[v as usize] as usize;
    // Unknowns are numbered over the places that triangles use.
    let mut number = vec![usize::MAX; normals.len()];
    let mut place = Vec::new();
    for &v in mesh.triangles.iter().flatten() {
        if number[class(v)] == usize::MAX {
            number[class(v)] = place.len();
            place.push(class(v));
        }
    }
    let (edges, areas) = edges(mesh, |v| number[class(v)]);
    let basis: Vec<[Vec3; 2]> = place.iter().map(|&v| orthonormal_basis(normals[v]).into()).collect();

    let mut lower = Vec::new();
    let mut diagonal = vec![0.0; place.len()];
    for (&(i, j), &weight) in &edges {
        diagonal[i] += weight;
        diagonal[j] += weight;
        for (a, axis) in basis[i].iter().enumerate() {
            let carried = transport(*axis, normals[place[i]], normals[place[j]]);
            for (b, other) in basis[j].iter().enumerate() {
                lower.push((2 * j + b, 2 * i + a, -weight * f64::from(carried.dot(*other))));
            }
        }
    }
    let reach_m = REACH * f64::from(mesh.diagonal_m());
    let covered = covered(&edges, place.iter().map(|&v| wishes[v].hold != Hold::Free).collect());
    let mut right = vec![0.0; 2 * place.len()];
    for (i, &v) in place.iter().enumerate() {
        let plain = if reach_m > 0.0 { areas[i] / (reach_m * reach_m) } else { 0.0 };
        let (weight, direction) = match wishes[v].hold {
            Hold::Kept => (FIRM * diagonal[i], wishes[v].direction),
            Hold::Leaning(strength) => (plain * f64::from(strength), wishes[v].direction),
            Hold::Free if covered[i] => (0.0, Vec3::ZERO),
            // Gravity, and a little tailward for what lies flat.
            Hold::Free => (FALLBACK * plain, Vec3::new(0.0, -1.0, -1e-3)),
        };
        // A trace of stiffness keeps the system definite where nothing else says anything.
        let stiff = 1e-9 * diagonal[i] + f64::MIN_POSITIVE;
        for (a, axis) in basis[i].iter().enumerate() {
            lower.push((2 * i + a, 2 * i + a, diagonal[i] + weight + stiff));
            right[2 * i + a] = weight * f64::from(axis.dot(direction));
        }
    }
    if let Some(cholesky) = Cholesky::new(right.len(), &lower) {
        cholesky.solve(&mut right);
    }

    let mut direction = vec![Vec3::ZERO; normals.len()];
    for (i, &v) in place.iter().enumerate() {
        let [x, y] = basis[i].map(Vec3::as_dvec3);
        let solved = (x * right[2 * i] + y * right[2 * i + 1]).normalize_or(x).as_vec3();
        direction[v] = if wishes[v].hold == Hold::Kept { wishes[v].direction } else { solved };
    }
    mesh.position_class.iter().map(|&c| direction[c as usize]).collect()
}

/// Weighted edges between numbered places (lower number first), and the area around each place, m².
fn edges(mesh: &Mesh, number: impl Fn(u32) -> usize) -> (BTreeMap<(usize, usize), f64>, Vec<f64>) {
    let mut edges = BTreeMap::new();
    let count = mesh.triangles.iter().flatten().map(|&v| number(v) + 1).max().unwrap_or(0);
    let mut areas = vec![0.0; count];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners_m(t).map(Vec3::as_dvec3);
        let numbers = triangle.map(&number);
        let double_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        for k in 0..3 {
            let [i, j] = [numbers[(k + 1) % 3], numbers[(k + 2) % 3]];
            let [a, b]: [DVec3; 2] = [corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]];
            areas[numbers[k]] += double_area / 6.0;
            if i != j {
                let cotangent = if double_area > 0.0 { a.dot(b) / double_area } else { 0.0 };
                *edges.entry((i.min(j), i.max(j))).or_insert(0.0) += 0.5 * cotangent.clamp(WEIGHTS[0], WEIGHTS[1]);
            }
        }
    }
    (edges, areas)
}

/// Spreads `marked` over everything that edges connect to it.
fn covered(edges: &BTreeMap<(usize, usize), f64>, marked: Vec<bool>) -> Vec<bool> {
    let mut parent: Vec<usize> = (0..marked.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for &(i, j) in edges.keys() {
        let (i, j) = (root(&mut parent, i), root(&mut parent, j));
        parent[i.max(j)] = i.min(j);
    }
    let mut any = vec![false; marked.len()];
    for (i, &mark) in marked.iter().enumerate() {
        any[root(&mut parent, i)] |= mark;
    }
    (0..marked.len()).map(|i| any[root(&mut parent, i)]).collect()
}
