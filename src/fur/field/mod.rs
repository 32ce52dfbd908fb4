//! The comb: a direction along the skin at every point, from what the artist said and smooth where nothing was said
//! (`docs/steps/field.md`).

mod singular;
mod smooth;
mod source;

use crate::data::mesh::Mesh;
use crate::data::parting::Parting;
use crate::error::{Error, Result};
use crate::math::Vec3;
use serde::{Deserialize, Serialize};
use smooth::{Hold, smooth};
use source::wishes;

pub use singular::Singularity;
pub use source::distance_to_line;

/// A point that hair turns around. Lengths and places are in the mesh's frame, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Whorl {
    /// Its middle.
    pub centre_m: Vec3,
    /// How far it reaches; beyond, other sources and smoothness decide.
    pub reach_m: f32,
    /// Angle between the hair and the way out from the middle, rad, counter-clockwise seen from outside: 0 for hair
    /// that points away from the middle, ±π/2 for a ring, π for hair that points to it.
    pub spin_rad: f32,
}

/// Where the comb comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum FieldSource {
    /// One direction per vertex, zero where unknown: a vertex attribute or a sampled groom map. Kept as it is.
    Vertices(Vec<Vec3>),
    /// Down, as hair hangs.
    Gravity,
    /// From head (+Z) to tail (−Z), and down by `sag` (0 for straight back, 1 for as much down as back).
    Tailward {
        /// Share of gravity.
        sag: f32,
    },
    /// Crowns and swirls.
    Whorls(Vec<Whorl>),
    /// Brush strokes: polylines on or near the skin, each combing what lies within `reach_m`.
    Strokes {
        /// The polylines, from where the hair comes to where it goes, m.
        lines_m: Vec<Vec<Vec3>>,
        /// How far a stroke reaches, m.
        reach_m: f32,
    },
    /// Lines that hair falls away from, beside them and within their reach.
    Partings(Vec<Parting>),
}

/// A comb without gaps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DirectionField {
    /// Tangent unit vector per vertex, the same at all vertices of one place; zero only where no triangle is.
    pub direction: Vec<Vec3>,
    /// Where the comb has no direction: crowns, partings' ends, saddles.
    pub singularities: Vec<Singularity>,
    /// Vertices that no source said anything about.
    pub filled: usize,
}

/// The comb of `mesh` after `sources`; where two speak of the same place, the earlier one decides.
///
/// What no source covers is filled with the smoothest field that continues the rest: the connection Laplacian's
/// solution, with vectors carried between tangent planes by the smallest rotation. Parts of the mesh without any source
/// are combed by gravity, and those that lie flat from head to tail.
///
/// # Errors
/// Names a source whose arrays do not fit the mesh or hold numbers that are not finite.
pub fn directions(mesh: &Mesh, sources: &[FieldSource]) -> Result<DirectionField> {
    for (i, source) in sources.iter().enumerate() {
        check(mesh, source).map_err(|e| Error { field: Some(format!("field[{i}]")), ..e })?;
    }
    let normals = mesh.smooth_normals();
    let wishes = wishes(mesh, &normals, sources);
    let filled = wishes.iter().filter(|w| matches!(w.hold, Hold::Free)).count();
    let direction = smooth(mesh, &normals, &wishes);
    let singularities = singular::find(mesh, &normals, &direction);
    Ok(DirectionField { direction, singularities, filled })
}

/// Where `direction` (one per vertex, the same at all vertices of one place) turns round itself.
pub fn singularities(mesh: &Mesh, direction: &[Vec3]) -> Vec<Singularity> {
    singular::find(mesh, &mesh.smooth_normals(), direction)
}

fn check(mesh: &Mesh, source: &FieldSource) -> Result<()> {
    let fault = |found: String, expected: &str| {
        Err(Error::input("a source of the comb does not make sense").with_found(found).with_expected(expected))
    };
    let vertices = mesh.positions_m.len();
    match source {
        FieldSource::Vertices(all) if all.len() != vertices => {
            fault(format!("{} directions", all.len()), "one direction per vertex")
        }
        FieldSource::Vertices(all) if !all.iter().all(|d| d.is_finite()) => {
            fault("a direction that is not finite".into(), "finite numbers")
        }
        FieldSource::Tailward { sag } if !sag.is_finite() => fault(format!("sag {sag}"), "a finite number"),
        FieldSource::Whorls(all) => match all
            .iter()
            .find(|w| !(w.centre_m.is_finite() && w.spin_rad.is_finite() && w.reach_m.is_finite() && w.reach_m > 0.0))
        {
            Some(whorl) => fault(format!("{whorl:?}"), "finite numbers and a positive reach"),
            None => Ok(()),
        },
        FieldSource::Strokes { reach_m, .. } if !(reach_m.is_finite() && *reach_m > 0.0) => {
            fault(format!("a reach of {reach_m} m"), "a positive number of metres")
        }
        FieldSource::Strokes { lines_m, .. } if !lines_m.iter().flatten().all(|p| p.is_finite()) => {
            fault("a stroke through a point that is not finite".into(), "finite numbers")
        }
        FieldSource::Partings(all) => match all.iter().find(|p| !sound(p)) {
            Some(parting) => fault(format!("{parting:?}"), "finite numbers and a positive reach"),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

fn sound(parting: &Parting) -> bool {
    let Parting { line_m, reach_m, width_m, angle_rad } = parting;
    let numbers = [*reach_m, *width_m, *angle_rad];
    line_m.iter().all(|p| p.is_finite()) && numbers.iter().all(|x| x.is_finite()) && *reach_m > 0.0 && *width_m >= 0.0
}
