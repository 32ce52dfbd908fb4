//! The prisms that marches side by side are in, corner by corner.

use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Row, Vec3Row, Vec3s};

/// A vertex of the skin and the shell over it.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// On the skin, m.
    pub foot_m: Vec3,
    /// Skin to top, m.
    pub offset_m: Vec3,
    /// Smooth normal of the skin.
    pub normal: Vec3,
    /// Hair colour under the root.
    pub tint: Vec3,
    /// Hair density over the preset's.
    pub density: f32,
    /// Hair length over the preset's.
    pub length: f32,
}

/// Points in prisms: x = Σ bᵢ (pᵢ + t oᵢ).
#[derive(Clone, Copy, Debug)]
pub struct ShellPoints<I: Isa> {
    /// Barycentric coordinates of corners 1 and 2; corner 0 has the rest.
    pub b: [F32s<I>; 2],
    /// Heights, 0 on the skin to 1 at the top.
    pub t: F32s<I>,
}

impl<I: Isa> ShellPoints<I> {
    /// All three barycentric coordinates.
    #[inline(always)]
    pub fn barycentric(&self) -> Vec3s<I> {
        Vec3s::new(F32s::splat(1.0) - self.b[0] - self.b[1], self.b[0], self.b[1])
    }

    /// The nearest points inside: a march that rounding or a folded prism has led astray must not read beyond the corners.
    #[inline(always)]
    pub fn inside(&self) -> Self {
        let zero = F32s::splat(0.0);
        let b = self.barycentric();
        let (x, y, z) = (b.x.max(zero), b.y.max(zero), b.z.max(zero));
        let scale = F32s::splat(1.0) / (x + y + z);
        Self { b: [y * scale, z * scale], t: self.t.within(0.0, 1.0) }
    }

    /// Moved by rates times distances.
    #[inline(always)]
    pub fn moved(&self, rates: Vec3s<I>, by: F32s<I>) -> Self {
        Self { b: [self.b[0] + rates.x * by, self.b[1] + rates.y * by], t: self.t + rates.z * by }
    }
}

/// One corner of the prisms, and what the skin's fields say there.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    foot_m: Vec3Row,
    offset_m: Vec3Row,
    normal: Vec3Row,
    tint: Vec3Row,
    density: Row,
    length: Row,
}

/// Prisms, one per lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prisms {
    corners: [Corner; 3],
    twice_area_m2: Row,
}

/// How points change with position.
#[derive(Clone, Copy, Debug)]
pub struct Jacobians<I: Isa> {
    /// Positions of the points, m.
    pub at_m: Vec3s<I>,
    /// Skin to top, m.
    pub up_m: Vec3s<I>,
    /// Determinants of ∂x/∂(b₁, b₂, t), m³.
    pub determinant: F32s<I>,
    gradients: [Vec3s<I>; 3],
}

impl<I: Isa> Jacobians<I> {
    /// How b₁, b₂ and t change along vectors.
    #[inline(always)]
    pub fn rates(&self, along: Vec3s<I>) -> Vec3s<I> {
        Vec3s::new(self.gradients[0].dot(along), self.gradients[1].dot(along), self.gradients[2].dot(along))
    }
}

impl Prisms {
    /// Puts lane `i` into the prism with these corners.
    #[inline(always)]
    pub fn set(&mut self, i: usize, corners: [&Vertex; 3], twice_area_m2: f32) {
        self.twice_area_m2.0[i] = twice_area_m2;
        for (corner, vertex) in self.corners.iter_mut().zip(corners) {
            corner.foot_m.set(i, vertex.foot_m);
            corner.offset_m.set(i, vertex.offset_m);
            corner.normal.set(i, vertex.normal);
            corner.tint.set(i, vertex.tint);
            corner.density.0[i] = vertex.density;
            corner.length.0[i] = vertex.length;
        }
    }

    /// Positions, directions of the hair and gradients at points.
    #[inline(always)]
    pub fn jacobians<I: Isa>(&self, points: &ShellPoints<I>) -> Jacobians<I> {
        let [a, b, c] = &self.corners;
        let q = at(a, points.t);
        let (e1, e2) = (at(b, points.t) - q, at(c, points.t) - q);
        let offset_m = [Vec3s::of(&a.offset_m), Vec3s::of(&b.offset_m), Vec3s::of(&c.offset_m)];
        let up_m = mix(offset_m, points.barycentric());
        let cross = [e2.cross(up_m), up_m.cross(e1), e1.cross(e2)];
        let determinant = e1.dot(cross[0]);
        // A flat prism has no volume: rates of zero keep a march from leaving for infinity.
        let solid = determinant.abs().gt(F32s::splat(f32::MIN_POSITIVE));
        let inverse = solid.keep(F32s::splat(1.0) / determinant);
        Jacobians {
            at_m: q + e1 * points.b[0] + e2 * points.b[1],
            up_m,
            determinant,
            gradients: [cross[0] * inverse, cross[1] * inverse, cross[2] * inverse],
        }
    }

    /// Twice the triangles' areas in the rest pose, m².
    #[inline(always)]
    pub fn twice_area_m2<I: Isa>(&self) -> F32s<I> {
        F32s::of(&self.twice_area_m2)
    }

    /// Hair density over the preset's.
    #[inline(always)]
    pub fn density<I: Isa>(&self, b: Vec3s<I>) -> F32s<I> {
        let [p, q, r] = &self.corners;
        F32s::of(&p.density) * b.x + F32s::of(&q.density) * b.y + F32s::of(&r.density) * b.z
    }

    /// Hair length over the preset's.
    #[inline(always)]
    pub fn length<I: Isa>(&self, b: Vec3s<I>) -> F32s<I> {
        let [p, q, r] = &self.corners;
        F32s::of(&p.length) * b.x + F32s::of(&q.length) * b.y + F32s::of(&r.length) * b.z
    }

    /// Unit normals of the skin.
    #[inline(always)]
    pub fn normal<I: Isa>(&self, b: Vec3s<I>) -> Vec3s<I> {
        let [p, q, r] = &self.corners;
        let normals = [Vec3s::of(&p.normal), Vec3s::of(&q.normal), Vec3s::of(&r.normal)];
        mix(normals, b).normalized_or(Vec3s::splat(Vec3::Y))
    }

    /// Hair colours under the roots.
    #[inline(always)]
    pub fn tint<I: Isa>(&self, b: Vec3s<I>) -> Vec3s<I> {
        let [p, q, r] = &self.corners;
        mix([Vec3s::of(&p.tint), Vec3s::of(&q.tint), Vec3s::of(&r.tint)], b)
    }
}

/// A corner's position at heights t.
#[inline(always)]
fn at<I: Isa>(corner: &Corner, t: F32s<I>) -> Vec3s<I> {
    Vec3s::of(&corner.foot_m) + Vec3s::of(&corner.offset_m) * t
}

#[inline(always)]
fn mix<I: Isa>([p, q, r]: [Vec3s<I>; 3], b: Vec3s<I>) -> Vec3s<I> {
    p * b.x + q * b.y + r * b.z
}
