//! The shell's outer faces: tops of all prisms, and walls at open borders.

use super::Shell;
use super::prism::ShellPoint;

/// A flat outer face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OuterFace {
    /// Whose prism it bounds.
    pub triangle: u32,
    /// 0 for the top, 1 + 2·corner for one half of the wall over the edge opposite to that corner, the next for its other
    /// half.
    pub kind: u32,
    /// Whether the prism is inside out there, as where hair crosses in a crease.
    pub turned: bool,
    /// Corners, counter-clockwise for who enters there.
    pub corners: [ShellPoint; 3],
}

impl OuterFace {
    /// The corner opposite to the wall; none of tops.
    pub fn opposite(&self) -> Option<usize> {
        self.kind.checked_sub(1).map(|wall| wall as usize / 2)
    }

    /// Corners, counter-clockwise for who enters there where the prism is not inside out.
    pub fn unturned(&self) -> [ShellPoint; 3] {
        let [a, b, c] = self.corners;
        if self.turned { [a, c, b] } else { [a, b, c] }
    }
}

/// Corner `i` of a triangle, counted round, at a height.
pub fn corner(i: usize, t: f32) -> ShellPoint {
    ShellPoint { b: [f32::from(u8::from(i % 3 == 1)), f32::from(u8::from(i % 3 == 2))], t }
}

/// The outer faces over a triangle, of a shell that ends at `top`.
pub fn faces(shell: &Shell<'_>, triangle: u32, top: f32) -> impl Iterator<Item = OuterFace> {
    let prism = shell.prism(triangle);
    let face = move |(kind, corners): (u32, [ShellPoint; 3])| {
        let [a, b, c] = corners;
        let mean = |i: usize| (a.b[i] + b.b[i] + c.b[i]) / 3.0;
        let middle = ShellPoint { b: [mean(0), mean(1)], t: (a.t + b.t + c.t) / 3.0 };
        let turned = prism.jacobian(&middle).determinant < 0.0;
        OuterFace { triangle, kind, turned, corners: if turned { [a, c, b] } else { corners } }
    };
    let borders = (0..3).filter(move |&c| shell.neighbours.beyond(triangle, c).is_none());
    let walls = borders.flat_map(move |c| {
        let (foot, top) = (|i: usize| corner(c + i, 0.0), |i: usize| corner(c + i, top));
        let kind = 1 + 2 * c as u32;
        [(kind, [foot(1), foot(2), top(2)]), (kind + 1, [foot(1), top(2), top(1)])]
    });
    std::iter::once((0, [corner(0, top), corner(1, top), corner(2, top)])).chain(walls).map(face)
}
