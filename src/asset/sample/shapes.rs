//! The simple samples. Triangle counts and areas of `cylinder` and `hat` are those of the test scenes in Andersen et
//! al. 2016.

use super::Shape;
use crate::math::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// sin and cos of an angle that is a fraction of a turn.
fn turn(fraction: f32) -> Vec2 {
    Vec2::new(libm::cosf(TAU * fraction), libm::sinf(TAU * fraction))
}

/// A skin of 190 cm² bent over a half cylinder of 4.2 cm radius: 56 × 32 quads, 3,584 triangles.
pub fn cylinder() -> Shape {
    let radius = 0.042;
    let length = 0.019 / (PI * radius);
    Shape::grid(56, 32, |u, v| {
        let around = turn(0.5 - 0.5 * u);
        let normal = Vec3::new(around.x, around.y, 0.0);
        (radius * normal + Vec3::new(0.0, 0.0, length * (0.5 - v)), normal)
    })
}

/// A hat of 1,500 cm²: a profile of crown and brim turned round the vertical, 64 × 44 quads and no degenerate row,
/// 5,632 triangles. Open below.
pub fn hat() -> Shape {
    // Control points (radius, height) of the outline from the brim's edge to the crown, m, for a Catmull-Rom curve.
    const OUTLINE: [(f32, f32); 9] = [
        (0.160, 0.016),
        (0.148, 0.006),
        (0.122, 0.000),
        (0.101, 0.006),
        (0.092, 0.035),
        (0.088, 0.075),
        (0.076, 0.106),
        (0.045, 0.121),
        (0.001, 0.124),
    ];
    let point = |i: isize| {
        let (radius, height) = OUTLINE[i.clamp(0, OUTLINE.len() as isize - 1) as usize];
        Vec2::new(radius, height)
    };
    let outline = |v: f32| {
        let s = (v * (OUTLINE.len() - 1) as f32).min(OUTLINE.len() as f32 - 1.000_1);
        let (i, t) = (s.floor() as isize, s.fract());
        let [a, b, c, d] = [point(i - 1), point(i), point(i + 1), point(i + 2)];
        0.5 * (2.0 * b
            + (c - a) * t
            + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
            + (3.0 * b - a - 3.0 * c + d) * t * t * t)
    };
    let scaled = |scale: f32| {
        Shape::grid(64, 44, |u, v| {
            let (here, ahead, behind) =
                (outline(v) * scale, outline((v + 1e-3).min(1.0)), outline((v - 1e-3).max(0.0)));
            let (around, along) = (turn(-u), ahead - behind);
            let out = Vec3::new(around.x, 0.0, around.y);
            (out * here.x + Vec3::Y * here.y, out * along.y - Vec3::Y * along.x)
        })
    };
    let area: f32 = {
        let shape = scaled(1.0);
        let corner = |v: u32| shape.positions[v as usize];
        shape
            .triangles
            .iter()
            .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length())
            .sum()
    };
    scaled((0.15 / area).sqrt())
}

/// A ball of 10 cm radius: 64 × 32 quads.
pub fn sphere() -> Shape {
    let mut sphere = ball(64, 32);
    sphere.positions.iter_mut().for_each(|p| *p *= 0.1);
    sphere
}

/// The unit ball.
pub fn ball(columns: u32, rows: u32) -> Shape {
    Shape::grid(columns, rows, |u, v| {
        let (around, up) = (turn(-u), turn(0.5 * v - 0.25));
        let normal = Vec3::new(around.x * up.x, up.y, around.y * up.x);
        (normal, normal)
    })
}

/// A ring of 10 cm radius and 4 cm thickness of its half: 72 × 32 quads.
pub fn torus() -> Shape {
    Shape::grid(72, 32, |u, v| {
        let (around, tube) = (turn(-u), turn(v));
        let normal = Vec3::new(around.x * tube.x, tube.y, around.y * tube.x);
        (Vec3::new(around.x, 0.0, around.y) * 0.1 + 0.04 * normal, normal)
    })
}

/// A square of 20 cm in the ground plane: 16 × 16 quads.
pub fn plane() -> Shape {
    Shape::grid(16, 16, |u, v| (Vec3::new(0.2 * (u - 0.5), 0.0, 0.2 * (0.5 - v)), Vec3::Y))
}
