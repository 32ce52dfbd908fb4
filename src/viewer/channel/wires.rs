//! Edges of triangles, drawn over a picture on the CPU: thin lines are no surfaces.

use super::Seen;
use crate::math::{Vec3, Vec4};
use crate::runtime::{Frame, Picture};
use std::collections::HashSet;

/// Of the skin, and of the outermost shell, linear RGB.
const COLOURS: [Vec3; 2] = [Vec3::new(0.0, 0.01, 0.2), Vec3::new(0.0, 0.8, 0.9)];
/// What lies deeper than the skin by no more than this share of its distance is on it.
const ON: f32 = 2e-3;

/// `picture` with the lines over it, where the skin, so far away, does not hide them.
pub(super) fn over(picture: &Picture, skin_m: &[f32], seen: &Seen<'_>) -> (Picture, Vec<String>) {
    let furthest_m = around(skin_m, picture.size);
    let mut sheets =
        [(); 2].map(|()| Sheet { frame: seen.frame, furthest_m: &furthest_m, ink: vec![0.0; skin_m.len()] });
    let mut counts = [0; 2];
    for skin in &seen.scene.skins {
        let facing = |p: Vec3, t: &[u32; 3]| (seen.frame.eye.truncate() - p).dot(outwards(&skin.normals, t)) > 0.0;
        counts[0] += sheets[0].mesh(&skin.positions_m, &skin.triangles, facing);
    }
    // In a passage between two tiles both have the same shells.
    for fur in seen.scene.furs.iter().filter(|fur| !fur.over_last) {
        let tips_m: Vec<Vec3> = fur.positions_m.iter().zip(&fur.offsets_m).map(|(p, o)| *p + *o).collect();
        let facing = |_: Vec3, t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| tips_m[v as usize]);
            let (face, out) = ((b - a).cross(c - a), outwards(&fur.offsets_m, t));
            (seen.frame.eye.truncate() - a).dot(face) * face.dot(out) > 0.0
        };
        counts[1] += sheets[1].mesh(&tips_m, fur.triangles, facing);
    }
    let mut pixels = picture.pixels.clone();
    for (sheet, colour) in sheets.iter().zip(COLOURS) {
        for (pixel, &ink) in pixels.iter_mut().zip(&sheet.ink) {
            *pixel = (Vec4::from(*pixel) * (1.0 - ink) + colour.extend(1.0) * ink).to_array();
        }
    }
    let legend = format!(
        "lines are edges of triangles that face the eye: {} of the skin dark blue, {} of the coat's outermost shell light blue",
        counts[0], counts[1]
    );
    (Picture { pixels, ..picture.clone() }, vec![legend])
}

/// Sum of a triangle's three.
fn outwards(of: &[Vec3], triangle: &[u32; 3]) -> Vec3 {
    triangle.iter().map(|&v| of[v as usize]).sum()
}

/// Of each pixel and its neighbours the furthest distance, m, or infinity where one shows nothing: a line beside an outline is
/// hidden by neither side of it.
fn around(distances_m: &[f32], [width, height]: [u32; 2]) -> Vec<f32> {
    let near = |at: u32, end: u32| at.saturating_sub(1)..(at + 2).min(end);
    let furthest = |i: u32| {
        let (x, y) = (i % width, i / width);
        let all = near(y, height).flat_map(|y| near(x, width).map(move |x| distances_m[(y * width + x) as usize]));
        all.map(|m| if m > 0.0 { m } else { f32::INFINITY }).fold(0.0, f32::max)
    };
    (0..width * height).map(furthest).collect()
}

/// What lines cover of each pixel.
struct Sheet<'a> {
    frame: &'a Frame,
    furthest_m: &'a [f32],
    ink: Vec<f32>,
}

impl Sheet<'_> {
    /// Draws each edge of the triangles that face the eye, once. Their number is returned.
    fn mesh(&mut self, positions_m: &[Vec3], triangles: &[[u32; 3]], faces: impl Fn(Vec3, &[u32; 3]) -> bool) -> usize {
        let facing = triangles.iter().filter(|t| faces(positions_m[t[0] as usize], t));
        let edges = facing.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]);
        let edges: HashSet<[u32; 2]> = edges.collect();
        for edge in &edges {
            self.line(edge.map(|v| positions_m[v as usize]));
        }
        edges.len()
    }

    /// A line a pixel wide: along its longer axis each step shares one pixel's ink between two.
    fn line(&mut self, ends_m: [Vec3; 2]) {
        let Some([a, b]) = self.before_the_eye(ends_m) else { return };
        let [width, height] = self.frame.size;
        let at =
            |p: Vec4| [(0.5 + 0.5 * p.x / p.w) * width as f32 - 0.5, (0.5 - 0.5 * p.y / p.w) * height as f32 - 0.5];
        let (from, to) = (at(a.1), at(b.1));
        let along = usize::from((to[0] - from[0]).abs() < (to[1] - from[1]).abs());
        let (from, to, a, b) = if from[along] <= to[along] { (from, to, a, b) } else { (to, from, b, a) };
        let length = to[along] - from[along];
        if !(length.is_finite() && length > 0.0) {
            return;
        }
        let last = self.frame.size[along] as f32 - 1.0;
        let (first, last) = (from[along].round().max(0.0), to[along].round().min(last));
        let mut step = first;
        while step <= last {
            let t = ((step - from[along]) / length).clamp(0.0, 1.0);
            // Equal steps on the picture are not equal steps in the world.
            let far = t / b.1.w / (t / b.1.w + (1.0 - t) / a.1.w);
            let distance_m = a.0.lerp(b.0, far).distance(self.frame.eye.truncate());
            let across = from[1 - along] + (to[1 - along] - from[1 - along]) * t;
            let below = across.floor();
            for (place, ink) in [(below, 1.0 - (across - below)), (below + 1.0, across - below)] {
                self.dot(if along == 0 { [step, place] } else { [place, step] }, ink, distance_m);
            }
            step += 1.0;
        }
    }

    fn dot(&mut self, [x, y]: [f32; 2], ink: f32, distance_m: f32) {
        let [width, height] = self.frame.size.map(|edge| edge as f32);
        if x < 0.0 || y < 0.0 || x >= width || y >= height {
            return;
        }
        let i = y as usize * self.frame.size[0] as usize + x as usize;
        if distance_m <= self.furthest_m[i] * (1.0 + ON) {
            self.ink[i] = self.ink[i].max(ink);
        }
    }

    /// The part of a line beyond the near plane, in the world and in clip space.
    fn before_the_eye(&self, ends_m: [Vec3; 2]) -> Option<[(Vec3, Vec4); 2]> {
        let [a, b] = ends_m.map(|p| (p, self.frame.clip_from_world * p.extend(1.0)));
        let cut = |(p, clip): (Vec3, Vec4), (q, other): (Vec3, Vec4)| {
            let t = clip.z / (clip.z - other.z);
            (p.lerp(q, t), clip.lerp(other, t))
        };
        match [a.1.z >= 0.0, b.1.z >= 0.0] {
            [true, true] => Some([a, b]),
            [true, false] => Some([a, cut(b, a)]),
            [false, true] => Some([cut(a, b), b]),
            [false, false] => None,
        }
    }
}
