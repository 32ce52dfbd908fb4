//! One prism: from points in space to points in the shell and back.

use crate::math::Vec3;

/// A triangle and where its corners are extruded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// Corners on the skin, m.
    pub foot_m: [Vec3; 3],
    /// Skin to the top, m.
    pub offset_m: [Vec3; 3],
}

/// A point in a prism: x = Σ bᵢ (pᵢ + t oᵢ).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShellPoint {
    /// Barycentric coordinates of corners 1 and 2; corner 0 has the rest.
    pub b: [f32; 2],
    /// Height, 0 on the skin to 1 at the top.
    pub t: f32,
}

/// How points change with position, at one point.
#[derive(Clone, Copy, Debug)]
pub struct Jacobian {
    /// The point's position, m.
    pub at_m: Vec3,
    /// Skin to top at the point, m.
    pub up_m: Vec3,
    /// Determinant of ∂x/∂(b₁, b₂, t), m³; negative where the prism is turned inside out.
    pub determinant: f32,
    /// Rows of the inverse: gradients of b₁, b₂ and t, 1/m.
    pub gradients: [Vec3; 3],
}

impl ShellPoint {
    /// All three barycentric coordinates.
    pub fn barycentric(&self) -> Vec3 {
        Vec3::new(1.0 - self.b[0] - self.b[1], self.b[0], self.b[1])
    }

    /// Moved by rates times a distance.
    pub fn moved(&self, rates: Vec3, by: f32) -> Self {
        Self { b: [self.b[0] + rates.x * by, self.b[1] + rates.y * by], t: self.t + rates.z * by }
    }
}

impl Prism {
    /// Position, direction of the hair and gradients at a point.
    pub fn jacobian(&self, point: &ShellPoint) -> Jacobian {
        let q = [0, 1, 2].map(|i| self.foot_m[i] + self.offset_m[i] * point.t);
        let (e1, e2) = (q[1] - q[0], q[2] - q[0]);
        let b = point.barycentric();
        let up_m = self.offset_m[0] * b.x + self.offset_m[1] * b.y + self.offset_m[2] * b.z;
        let cross = [e2.cross(up_m), up_m.cross(e1), e1.cross(e2)];
        let determinant = e1.dot(cross[0]);
        // A flat prism has no volume: rates of zero keep a march from leaving for infinity.
        let inverse = if determinant.abs() > f32::MIN_POSITIVE { 1.0 / determinant } else { 0.0 };
        Jacobian {
            at_m: q[0] + e1 * point.b[0] + e2 * point.b[1],
            up_m,
            determinant,
            gradients: cross.map(|c| c * inverse),
        }
    }

    /// The point of the shell at a point of space, by Newton's method from `guess`; none where it does not settle.
    pub fn locate(&self, point_m: Vec3, guess: ShellPoint) -> Option<ShellPoint> {
        let mut point = guess;
        for _ in 0..16 {
            let j = self.jacobian(&point);
            let step = j.rates(point_m - j.at_m);
            point = point.moved(step, 1.0);
            if !step.is_finite() {
                return None;
            }
            if step.abs().max_element() < 1e-5 {
                return (j.determinant != 0.0).then_some(point);
            }
        }
        None
    }

    /// How far along a unit direction from a point, whose point is about `guess`, the side opposite to `corner` lies, m; nothing
    /// where it is farther than half as far as the prism is high.
    pub fn to_side_m(&self, corner: usize, point_m: Vec3, direction: Vec3, guess: ShellPoint) -> f32 {
        let (mut point, mut along_m, mut up_m) = (guess, 0.0, 0.0);
        for _ in 0..3 {
            let j = self.jacobian(&point);
            point = point.moved(j.rates(point_m + direction * along_m - j.at_m), 1.0);
            let rates = j.rates(direction);
            let by_m = -point.barycentric()[corner] / [-rates.x - rates.y, rates.x, rates.y][corner];
            point = point.moved(rates, by_m);
            along_m += by_m;
            up_m = j.up_m.length();
        }
        if along_m.abs() < 0.5 * up_m { along_m } else { 0.0 }
    }

    /// Lowest and highest corner, m.
    pub fn bounds_m(&self) -> (Vec3, Vec3) {
        let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for i in 0..3 {
            for p in [self.foot_m[i], self.foot_m[i] + self.offset_m[i]] {
                bounds = (bounds.0.min(p), bounds.1.max(p));
            }
        }
        bounds
    }
}

impl Jacobian {
    /// How b₁, b₂ and t change along a vector.
    pub fn rates(&self, along: Vec3) -> Vec3 {
        Vec3::new(self.gradients[0].dot(along), self.gradients[1].dot(along), self.gradients[2].dot(along))
    }
}
