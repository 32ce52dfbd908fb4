//! A skin cut so finely that its vertices tell what is painted on it (`docs/steps/paint.md`): what fills the shell is interpolated
//! between vertices, on every device and in the reference alike.

mod cutter;
mod roots;

use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::math::Vec3;
use cutter::{Cutter, Painting};

/// How far a skin is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finest {
    /// Edges are not cut to less than this, m.
    pub edge_m: f32,
    /// Most triangles that are made.
    pub triangles: usize,
}

/// Some triangle of the skin before it was cut, and a point of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origin {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates.
    pub b: Vec3,
}

/// A skin that was cut.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Its mesh.
    pub mesh: Mesh,
    /// The fields on it, without paint: vertices hold it.
    pub fields: Fields,
    /// Per vertex, where it lies on the skin before.
    pub origin: Vec<Origin>,
    /// Per triangle, which of the skin's it is a piece of.
    pub piece_of: Vec<u32>,
    /// Whether there is more to see than could be cut out.
    pub coarse: bool,
    /// Triangles as they were cut: the first are the skin's, pieces follow in the order of cutting.
    cuts: Vec<Cut>,
}

/// A triangle, whole or cut.
#[derive(Clone, Debug)]
struct Cut {
    corners: [u32; 3],
    /// Where these lie in the skin's triangle, in its barycentric coordinates.
    within: [Vec3; 3],
    /// The skin's triangle.
    parent: u32,
    /// Its pieces, or none.
    pieces: Vec<u32>,
}

/// Cuts triangles on which what is painted differs from what lies between their vertices, as far as `finest` says; `None` where
/// nothing is painted. A posed mesh is cut as in its rest pose.
pub fn refine(mesh: &Mesh, fields: &Fields, finest: Finest) -> Option<Refined> {
    let paint = fields.paint.as_deref()?;
    let skin = Painting { mesh, fields, paint };
    let mut cutter = Cutter::new(skin, finest);
    while cutter.round() {}
    Some(cutter.finish())
}
