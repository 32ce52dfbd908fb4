//! Meshes for tests, made in code.

use furrier::data::mesh::{Mesh, position_classes};
use furrier::math::{Vec2, Vec3};

/// A mesh from positions (m) and triangles, with smooth normals and points joined where they are bitwise equal.
pub fn mesh(positions_m: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let position_class = position_classes(&positions_m, 0.0);
    let mut mesh =
        Mesh { normals: vec![Vec3::Y; positions_m.len()], positions_m, triangles, position_class, ..Mesh::default() };
    mesh.normals = mesh.smooth_normals();
    mesh.checked().expect("test meshes are sound")
}

/// A grid of `columns` × `rows` quads over `point(u, v)`, u and v in [0, 1]; `wrap` joins the first and last column
/// and row.
pub fn grid(columns: u32, rows: u32, wrap: [bool; 2], point: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let (w, h) = (columns + u32::from(!wrap[0]), rows + u32::from(!wrap[1]));
    let positions = (0..w * h).map(|i| point((i % w) as f32 / columns as f32, (i / w) as f32 / rows as f32)).collect();
    let at = |x: u32, y: u32| (y % h) * w + x % w;
    let quads = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let triangles = quads
        .flat_map(|(x, y)| {
            let (a, b, c, d) = (at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh(positions, triangles)
}

/// A flat square of side `edge_m` in the plane z = 0, facing +z, with one UV set that covers it once.
pub fn plane(cells: u32, edge_m: f32) -> Mesh {
    let mut mesh = grid(cells, cells, [false; 2], |u, v| Vec3::new(u, v, 0.0) * edge_m);
    mesh.uv_sets = vec![mesh.positions_m.iter().map(|p| Vec2::new(p.x, p.y) / edge_m).collect()];
    mesh
}

/// A sphere of about 8 `cells`² triangles: an octahedron, its faces divided and pushed outwards.
pub fn sphere(cells: u32, radius_m: f32) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let mut index = std::collections::HashMap::new();
    for octant in 0..8_u32 {
        let sign = Vec3::from_array([0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 }));
        let inside_out = octant.count_ones() % 2 == 1;
        let mut at = |i: u32, j: u32| {
            let p = Vec3::new(i as f32, j as f32, (cells - i - j) as f32) * sign + 0.0;
            *index.entry(p.to_array().map(|x| x as i64)).or_insert_with(|| {
                positions.push(p.normalize() * radius_m);
                positions.len() as u32 - 1
            })
        };
        for i in 0..cells {
            for j in 0..cells - i {
                let mut push = |mut t: [u32; 3]| {
                    if inside_out {
                        t.swap(1, 2);
                    }
                    triangles.push(t);
                };
                push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < cells {
                    push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    mesh(positions, triangles)
}

/// A torus about the y axis.
pub fn torus(cells: u32, radii_m: [f32; 2]) -> Mesh {
    grid(2 * cells, cells, [true; 2], |u, v| {
        let (a, b) = (u * std::f32::consts::TAU, v * std::f32::consts::TAU);
        let ring = radii_m[0] + radii_m[1] * b.cos();
        Vec3::new(-ring * a.cos(), radii_m[1] * b.sin(), ring * a.sin())
    })
}

/// A band with a half twist: it has one side, so some edge joins triangles that run round it the same way.
pub fn moebius(cells: u32) -> Mesh {
    let band = grid(cells, 4, [false; 2], |u, v| {
        let (a, w) = (u * std::f32::consts::TAU, (v - 0.5) * 0.6);
        let ring = 1.0 + w * (a / 2.0).cos();
        Vec3::new(ring * a.cos(), w * (a / 2.0).sin(), ring * a.sin())
    });
    let position_class = position_classes(&band.positions_m, 1e-4);
    Mesh { position_class, ..band }
}

/// `direction` made tangent to the skin and of unit length at each vertex, zero where that fails.
pub fn tangent(mesh: &Mesh, direction: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
    let tangent = |(&p, &n): (&Vec3, &Vec3)| {
        let d = direction(p);
        let flat = d - n * d.dot(n);
        if flat.length() > 1e-3 * d.length() { flat.normalize() } else { Vec3::ZERO }
    };
    mesh.positions_m.iter().zip(&mesh.normals).map(tangent).collect()
}
