//! Triangles out of polygons.

use crate::math::{DVec3, Vec3};

/// Triangles that fill a polygon, as corner indices: by ears in the plane of its area, which concave ones need.
pub fn fill(points: &[Vec3]) -> Vec<usize> {
    let n = points.len();
    let wide: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let normal: DVec3 = (0..n).map(|i| (wide[i] - wide[0]).cross(wide[(i + 1) % n] - wide[0])).sum();
    let Some(normal) = normal.try_normalize().filter(|_| n > 3) else {
        return (1..n - 1).flat_map(|i| [0, i, i + 1]).collect();
    };
    let (x, y) = normal.any_orthonormal_pair();
    let flat: Vec<[f64; 2]> = wide.iter().map(|p| [(*p - wide[0]).dot(x), (*p - wide[0]).dot(y)]).collect();
    let mut indices: Vec<usize> = Vec::new();
    earcut::Earcut::new().earcut(flat.iter().copied(), &[], &mut indices);
    // Earcut leaves the orientation of its triangles open; all must wind as the polygon does.
    for t in indices.chunks_exact_mut(3) {
        let [a, b, c] = [wide[t[0]], wide[t[1]], wide[t[2]]];
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            t.swap(1, 2);
        }
    }
    indices
}
