//! The mean direction of hair, from comb and gravity.

use super::Groom;
use crate::data::mesh::Mesh;
use crate::data::spread::LEAST_RISE;
use crate::math::Vec3;

/// Steps in which a lean is turned up until it leaves every face.
const STEPS: u32 = 12;

/// How hair may stand on a skin: along its normals, and off every face that meets at a vertex.
pub struct Standing {
    /// Smooth unit normals, one per vertex.
    pub normals: Vec<Vec3>,
    /// Per position class, where its faces begin.
    starts: Vec<u32>,
    /// Unit normals of the faces around each class.
    faces: Vec<Vec3>,
}

impl Standing {
    /// On `mesh`.
    pub fn new(mesh: &Mesh) -> Self {
        let count = mesh.positions_m.len();
        let class = |v: u32| mesh.position_class[v as usize] as usize;
        let mut starts = vec![0_u32; count + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[class(v) + 1] += 1);
        for v in 0..count {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut faces = vec![Vec3::ZERO; 3 * mesh.triangles.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let normal = mesh.area_vector_m2(t).normalize_or_zero();
            for &v in triangle {
                faces[next[class(v)] as usize] = normal;
                next[class(v)] += 1;
            }
        }
        Self { normals: mesh.smooth_normals(), starts, faces }
    }

    /// A lean at vertex `v` of position class `class`, turned up until it has the least angle with the skin and with every face
    /// there.
    pub fn raised(&self, v: usize, class: usize, lean: Vec3) -> Vec3 {
        let normal = self.normals[v];
        let lean = raised(lean, normal);
        let faces = &self.faces[self.starts[class] as usize..self.starts[class + 1] as usize];
        // With room for rounding; a face without area has no say.
        let leaves = |lean: Vec3| faces.iter().all(|face| face.dot(lean) >= LEAST_RISE * 0.999 || *face == Vec3::ZERO);
        if leaves(lean) {
            return lean;
        }
        let turned = |share: f32| normal.lerp(lean, share).normalize_or(normal);
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            if leaves(turned(middle)) { low = middle } else { high = middle }
        }
        turned(low)
    }
}

/// Root to tip of the mean hair, unit: leaned along the comb and pulled to the ground.
pub(super) fn lean(groom: &Groom, normal: Vec3, comb: Vec3) -> Vec3 {
    let (sin, cos) = libm::sincosf(groom.lean_deg.to_radians());
    let combed = if comb == Vec3::ZERO { normal } else { normal * cos + comb * sin };
    (combed + Vec3::NEG_Y * groom.gravity).normalize_or(normal)
}

/// A lean turned up to the least angle with the skin.
fn raised(lean: Vec3, normal: Vec3) -> Vec3 {
    let rise = lean.dot(normal);
    if rise >= LEAST_RISE {
        return lean;
    }
    let flat = (lean - normal * rise).normalize_or_zero();
    flat * (1.0 - LEAST_RISE * LEAST_RISE).sqrt() + normal * LEAST_RISE
}
