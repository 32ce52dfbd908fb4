//! The skin that fur grows on.

use super::spread::{LEAST_RISE, widest};
use crate::error::{Error, Result};
use crate::math::{DVec3, I64Vec3, Mat3, Vec2, Vec3, Vec4};
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// What an angle of 1 rad counts when angles are summed in whole numbers: 2²¹ triangles around a vertex still fit.
const WHOLE: f64 = (1_u64 << 40) as f64;

/// A triangle mesh in metres, world axes (+Y up), relative to `origin_m`.
///
/// Vertex arrays have one entry per vertex; optional ones are absent or just as long.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Mesh {
    /// Where (0, 0, 0) of `positions_m` lies in the world, so that f32 stays precise far from it.
    pub origin_m: DVec3,
    /// Vertex positions, m.
    pub positions_m: Vec<Vec3>,
    /// Where the vertices are in the rest pose, m, where `positions_m` are in another: how many hairs there are and how
    /// they clump is decided there, so that every pose carries the same hair.
    pub rest_m: Option<Vec<Vec3>>,
    /// Unit vertex normals as the asset shades its skin with: flat or split ones are no way for hair to stand.
    pub normals: Vec<Vec3>,
    /// [`Self::smooth_normals`] of the surface that this mesh was cut out of; none where it is whole.
    pub hair_normals: Option<Vec<Vec3>>,
    /// Vertex indices, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Which vertices are one point: the smallest index of a vertex at the same place, across UV and normal seams.
    pub position_class: Vec<u32>,
    /// What all chance on a triangle is drawn from: made of where its corners lie, so that it does not hang on the order in a
    /// file. Empty for triangles by their number.
    pub face_seeds: Vec<u64>,
    /// Texture coordinate sets, in the asset's order.
    pub uv_sets: Vec<Vec<Vec2>>,
    /// `COLOR_0`, linear RGBA.
    pub colour: Option<Vec<Vec4>>,
    /// `_FUR_LENGTH`: multiplies the preset's hair length.
    pub fur_length: Option<Vec<f32>>,
    /// `_FUR_REGION`: how much a preset's region without a map counts, in [0, 1].
    pub fur_region: Option<Vec<f32>>,
    /// `_FUR_DIRECTION`: comb direction in world axes; need be neither unit nor tangent.
    pub fur_direction: Option<Vec<Vec3>>,
}

impl Mesh {
    /// Checks lengths, index ranges and finiteness of what every later step relies on.
    ///
    /// # Errors
    /// Names the array and the index of the first fault.
    pub fn checked(self) -> Result<Self> {
        let vertices = self.positions_m.len();
        let fault = |field: &str, found: String, expected: &str| {
            Err(Error::input("the mesh is not consistent").with_field(field).with_found(found).with_expected(expected))
        };
        if self.normals.len() != vertices || self.position_class.len() != vertices {
            return fault("normals", format!("{} entries", self.normals.len()), "one entry per vertex");
        }
        if self.rest_m.as_ref().is_some_and(|rest| rest.len() != vertices) {
            return fault("rest positions", "another number of entries".into(), "one entry per vertex");
        }
        if let Some(i) = self.positions_m.iter().position(|p| !p.is_finite()) {
            return fault(&format!("positions[{i}]"), self.positions_m[i].to_string(), "finite numbers");
        }
        if let Some(i) = self
            .normals
            .iter()
            .position(|n| (n.length_squared() - 1.0).abs().partial_cmp(&1e-3) != Some(std::cmp::Ordering::Less))
        {
            return fault(&format!("normals[{i}]"), self.normals[i].to_string(), "unit length");
        }
        if let Some(i) = self.triangles.iter().flatten().position(|&v| v as usize >= vertices) {
            return fault(
                &format!("triangles[{}]", i / 3),
                "an index past the last vertex".into(),
                "indices below the vertex count",
            );
        }
        Ok(self)
    }

    /// The three corners of triangle `t`, m.
    pub fn corners_m(&self, t: usize) -> [Vec3; 3] {
        self.triangles[t].map(|v| self.positions_m[v as usize])
    }

    /// Where triangle `t` lies, thrice, m: which of several triangles comes first must not depend on their order in the mesh.
    pub fn order_in_space(&self, t: usize) -> [f32; 3] {
        let [p, q, r] = self.corners_m(t);
        (p + q + r).to_array()
    }

    /// Mean length of triangle `t`'s edges, m.
    pub fn mean_edge_m(&self, t: usize) -> f32 {
        let corners = self.corners_m(t);
        (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).sum::<f32>() / 3.0
    }

    /// The three corners of triangle `t` in the rest pose, m.
    pub fn rest_corners_m(&self, t: usize) -> [Vec3; 3] {
        let positions = self.rest_m.as_ref().unwrap_or(&self.positions_m);
        self.triangles[t].map(|v| positions[v as usize])
    }

    /// Area of triangle `t` in the rest pose, m².
    pub fn rest_area_m2(&self, t: usize) -> f32 {
        let [a, b, c] = self.rest_corners_m(t);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Takes directions at triangle `t` from the rest pose to where the mesh is: along the skin as the triangle is
    /// stretched, off it along its normal.
    pub fn posed_from_rest(&self, t: usize) -> Mat3 {
        if self.rest_m.is_none() {
            return Mat3::IDENTITY;
        }
        let frame = |[a, b, c]: [Vec3; 3]| Mat3::from_cols(b - a, c - a, (b - a).cross(c - a).normalize_or_zero());
        let rest = frame(self.rest_corners_m(t));
        let map = frame(self.corners_m(t)) * rest.inverse();
        if rest.determinant() != 0.0 && map.is_finite() { map } else { Mat3::IDENTITY }
    }

    /// The mesh in its rest pose.
    pub fn at_rest(&self) -> Self {
        let positions_m = self.rest_m.clone().unwrap_or_else(|| self.positions_m.clone());
        Self { positions_m, rest_m: None, hair_normals: None, ..self.clone() }
    }

    /// Twice the area of triangle `t` times its unit normal, m².
    pub fn area_vector_m2(&self, t: usize) -> Vec3 {
        let [a, b, c] = self.corners_m(t);
        (b - a).cross(c - a)
    }

    /// Area of triangle `t`, m².
    pub fn area_m2(&self, t: usize) -> f32 {
        0.5 * self.area_vector_m2(t).length()
    }

    /// What all chance on triangle `t` is drawn from.
    pub fn face_seed(&self, t: usize) -> u64 {
        self.face_seeds.get(t).copied().unwrap_or(t as u64)
    }

    /// Unit normals summed over the triangles around each vertex, weighted by the angle there, so that it does not matter how
    /// a flat face is cut into triangles (Thürmer and Wüthrich 1998); one per vertex, shared across its position class, so that
    /// what is extruded along them does not crack at seams.
    pub fn smooth_normals(&self) -> Vec<Vec3> {
        if let Some(normals) = &self.hair_normals {
            return normals.clone();
        }
        // Whole numbers add up to the same whatever the triangles' order.
        let mut sums = vec![I64Vec3::ZERO; self.positions_m.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            let corners = self.corners_m(t).map(Vec3::as_dvec3);
            let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else {
                continue;
            };
            for (k, &v) in triangle.iter().enumerate() {
                let [a, b] = [corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]];
                let angle = libm::atan2(a.cross(b).length(), a.dot(b));
                sums[self.position_class[v as usize] as usize] += (normal * (angle * WHOLE)).as_i64vec3();
            }
        }
        let of = |(v, &class): (usize, &u32)| {
            sums[class as usize].as_dvec3().try_normalize().map_or(self.normals[v], |normal| normal.as_vec3())
        };
        let mut normals: Vec<Vec3> = self.position_class.iter().enumerate().map(of).collect();
        self.leave_every_face(&mut normals);
        normals
    }

    /// Turns normals that do not stand on every face around their vertex to where they do, if they can.
    fn leave_every_face(&self, normals: &mut [Vec3]) {
        let mut hidden: BTreeMap<u32, Vec<Vec3>> = BTreeMap::new();
        let corners = || {
            self.triangles.iter().enumerate().flat_map(|(t, triangle)| {
                let normal = self.area_vector_m2(t).normalize_or_zero();
                triangle.map(|v| (self.position_class[v as usize], normal))
            })
        };
        for (class, normal) in corners().filter(|(_, normal)| *normal != Vec3::ZERO) {
            if normals[class as usize].dot(normal) < LEAST_RISE {
                hidden.entry(class).or_default();
            }
        }
        if hidden.is_empty() {
            return;
        }
        for (class, normal) in corners().filter(|(_, normal)| *normal != Vec3::ZERO) {
            if let Some(faces) = hidden.get_mut(&class) {
                faces.push(normal);
            }
        }
        let turned: BTreeMap<u32, Vec3> = hidden
            .into_iter()
            .map(|(class, mut faces)| {
                // Sums do not add up to the same in another order.
                faces.sort_unstable_by_key(|normal| normal.to_array().map(f32::to_bits));
                (class, widest(&faces).0)
            })
            .collect();
        for (normal, class) in normals.iter_mut().zip(&self.position_class) {
            *normal = turned.get(class).copied().unwrap_or(*normal);
        }
    }

    /// Length of the bounding box's diagonal, m; 0 for an empty mesh.
    pub fn diagonal_m(&self) -> f32 {
        let (low, high) = self.bounds_m();
        if self.positions_m.is_empty() { 0.0 } else { (high - low).length() }
    }

    /// Lowest and highest corner of the bounding box, m.
    pub fn bounds_m(&self) -> (Vec3, Vec3) {
        self.positions_m.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
    }
}

/// Groups vertices closer than about `tolerance` into classes: the smallest index of each group.
///
/// Vertices are snapped to a grid and joined with the groups of the neighbouring cells, so two points just either
/// side of a cell wall still meet. With `tolerance` 0 only bitwise equal points (and ±0) meet.
pub fn position_classes(positions: &[Vec3], tolerance: f32) -> Vec<u32> {
    let cell_size = f64::from(tolerance) * 2.0;
    let cell = |p: Vec3| -> [i64; 3] {
        if tolerance > 0.0 {
            (p.as_dvec3() / cell_size).floor().to_array().map(|c| c as i64)
        } else {
            (p + Vec3::ZERO).to_array().map(|c| i64::from(c.to_bits()))
        }
    };
    let mut first_in_cell: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut classes = Vec::with_capacity(positions.len());
    for (i, &p) in positions.iter().enumerate() {
        let home = cell(p);
        let mut class = i as u32;
        let reach = i64::from(tolerance > 0.0);
        'search: for dx in -reach..=reach {
            for dy in -reach..=reach {
                for dz in -reach..=reach {
                    let Some(members) = first_in_cell.get(&[
                        home[0].saturating_add(dx),
                        home[1].saturating_add(dy),
                        home[2].saturating_add(dz),
                    ]) else {
                        continue;
                    };
                    if let Some(&found) =
                        members.iter().find(|&&m| positions[m as usize].distance_squared(p) <= tolerance * tolerance)
                    {
                        class = classes[found as usize];
                        break 'search;
                    }
                }
            }
        }
        classes.push(class);
        if class == i as u32 {
            first_in_cell.entry(home).or_default().push(class);
        }
    }
    classes
}
