//! A colour for each direction of hair.

use super::{CoveredPart, stage};
use crate::math::Vec3;
use crate::runtime::SkinMesh;

/// See [`super::draw`].
pub(super) fn draw<'a>(all: &[CoveredPart<'_>]) -> (Vec<SkinMesh<'a>>, Vec<String>) {
    let skin = |covered: &CoveredPart<'_>| {
        let fur = stage::fur(covered.posed, covered.primitive);
        SkinMesh {
            colour: fur.offsets_m.iter().map(|&offset| colour(offset)).collect(),
            triangles: fur.triangles.to_vec(),
            positions_m: fur.positions_m,
            normals: fur.normals,
            ..SkinMesh::default()
        }
    };
    let legend = "colour is where hair points, from root to tip: red is how far along x, green along y (up), blue along z, each from \
                  0 (against it) by a half (across it) to 1, in linear light; skin without hair is grey";
    (all.iter().map(skin).collect(), vec![legend.to_owned()])
}

/// Of hair that stands so.
fn colour(offset: Vec3) -> Vec3 {
    offset.normalize_or_zero() * 0.5 + 0.5
}
