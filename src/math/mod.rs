//! Floor 0: vectors (glam), hashing, sampling. Nothing here knows of fur.

pub mod fast;
pub mod hash;
pub mod lanes;
pub mod noise;
pub mod radix;
pub mod sampling;
pub mod solve;
pub mod sparse;
pub mod split;
pub mod table;

pub use glam::{
    DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4, I64Vec3, IVec2, Mat2, Mat3, Mat4, Quat, UVec2, UVec3, Vec2,
    Vec3, Vec3A, Vec4,
};

/// Any unit vector at a right angle to the unit vector `n`, and the third axis: (t, b) with t × b = n.
/// Continuous but at n.z = 0⁻ (Duff et al. 2017, "Building an orthonormal basis, revisited").
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}
