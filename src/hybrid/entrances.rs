//! Where rays enter the shell: the top of every prism, and its sides at open borders.

use crate::hybrid::flat::{self, Flat};
use crate::math::Vec3;
use crate::stage::projection::Projection;
use crate::volume::bins::{Bins, TileGrid};
use crate::volume::march::Start;
use crate::volume::shell::Shell;
use crate::volume::shell::prism::ShellPoint;
use crate::volume::shell::{locate, outer};
use rayon::prelude::*;

/// An outer face of the shell, as seen by a view.
#[derive(Clone, Copy, Debug)]
struct SeenFace {
    outer: outer::OuterFace,
    camera_m: [Vec3; 3],
}

/// All points where a view's rays may enter the shell, by tile.
#[derive(Debug)]
pub struct Entrances {
    faces: Vec<SeenFace>,
    bins: Bins,
    /// Prisms that hold the eye.
    around_eye: Vec<(u32, ShellPoint)>,
}

impl Entrances {
    /// Of a shell for a view.
    pub fn new(shell: &Shell<'_>, view: &Projection, grid: &TileGrid) -> Self {
        let triangles = shell.skin.triangles.len() as u32;
        let faces: Vec<SeenFace> = (0..triangles)
            .into_par_iter()
            .flat_map_iter(|triangle| {
                let prism = shell.prism(triangle);
                let camera = move |point: ShellPoint| view.camera_from_world(prism.jacobian(&point).at_m);
                let facing =
                    |f: &SeenFace| Flat::new(f.camera_m).faces_eye() || f.camera_m.iter().any(|p| p.z <= view.near_m);
                outer::faces(shell, triangle, 1.0)
                    .map(move |outer| SeenFace { outer, camera_m: outer.corners.map(camera) })
                    .filter(facing)
            })
            .collect();
        let bins = Bins::new(grid, faces.len(), |i| flat::reach(view, &faces[i].camera_m));
        let around_eye = locate::around(shell, view.eye_m);
        Self { faces, bins, around_eye }
    }

    /// The faces that reach into a tile.
    pub fn of_tile(&self, tile: usize) -> impl Iterator<Item = (usize, [Vec3; 3])> {
        self.bins.of(tile).iter().map(|&i| (i as usize, self.faces[i as usize].camera_m))
    }

    /// Whether rays start inside the shell.
    pub fn around_eye(&self) -> impl Iterator<Item = Start> {
        self.around_eye.iter().map(|&(triangle, point)| Start { at_m: 0.0, triangle, point })
    }

    /// The start of a march where a ray from the eye meets face `face` at `barycentric`, `at_m` from the eye.
    ///
    /// A wall's two flat halves only have its edges in common with the side of the prism, which is curved wherever hair turns
    /// aside along a border: marches start on the side itself.
    pub fn start(&self, shell: &Shell<'_>, face: usize, barycentric: Vec3, at_m: f32, ray_m: [Vec3; 2]) -> Start {
        let outer::OuterFace { triangle, corners, .. } = self.faces[face].outer;
        let mean = |value: fn(&ShellPoint) -> f32| {
            value(&corners[0]) * barycentric.x + value(&corners[1]) * barycentric.y + value(&corners[2]) * barycentric.z
        };
        let point = ShellPoint { b: [mean(|p| p.b[0]), mean(|p| p.b[1])], t: mean(|p| p.t) };
        let Some(corner) = self.faces[face].outer.opposite() else { return Start { at_m, triangle, point } };
        let [eye_m, direction] = ray_m;
        let on_m = shell.prism(triangle).to_side_m(corner, eye_m + direction * at_m, direction, point);
        Start { at_m: (at_m + on_m).max(0.0), triangle, point }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.faces.len() * size_of::<SeenFace>() + self.bins.bytes()
    }
}
