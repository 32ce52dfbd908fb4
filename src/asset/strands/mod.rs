//! Guard hairs out: USD BasisCurves and cyHair, for programs that take curves.

mod cyhair;
mod usda;

use crate::data::strands::Strands;
use crate::error::{Error, Kind, Result};
use crate::math::{DMat3, DVec3, Vec3};
use std::path::Path;

/// Hairs and the units they are written in: those of the input, so that they stand on it as it is.
#[derive(Clone, Copy, Debug)]
pub struct Export<'a> {
    /// The hairs, m.
    pub strands: &'a Strands,
    /// Where their origin lies in the world, m.
    pub origin_m: DVec3,
    /// Length of a unit of the file, m.
    pub metres_per_unit: f64,
    /// Turns the world to the axes of the input.
    pub file_from_world: DMat3,
    /// What the hairs are called in the file; letters, digits and underscores survive.
    pub name: &'a str,
}

/// A file format of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// USD, text: linear BasisCurves with widths, displayColor and displayOpacity at every point.
    Usda,
    /// Cem Yuksel's HAIR: points, thickness, transparency and colour at every point.
    CyHair,
}

impl Format {
    /// By a file's ending.
    ///
    /// # Errors
    /// [`Kind::Usage`] where it is neither `.usda` nor `.hair`.
    pub fn of(path: &Path) -> Result<Self> {
        let kind = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match kind.as_str() {
            "usda" => Ok(Self::Usda),
            "hair" => Ok(Self::CyHair),
            _ => Err(Error::usage("the kind of strand file is unknown")
                .with_parameter("export strands")
                .with_found(path.display())
                .with_expected("a name that ends in .usda or .hair")),
        }
    }
}

/// The bytes of a strand file. The same hairs give the same bytes.
///
/// # Errors
/// [`Kind::Output`] where there are more hairs or points than the format can count.
pub fn encode(export: &Export<'_>, format: Format) -> Result<Vec<u8>> {
    match format {
        Format::Usda => usda::encode(export),
        Format::CyHair => cyhair::encode(export),
    }
}

impl Export<'_> {
    /// A vector of the world, m, in axes and units of the file.
    fn in_file(&self, vector_m: DVec3) -> DVec3 {
        self.file_from_world * vector_m / self.metres_per_unit
    }
}

/// What a hair is like at one of its points.
struct Point {
    /// Diameter, file units.
    diameter: f32,
    /// Linear RGB.
    colour: Vec3,
    /// In [0, 1].
    opacity: f32,
}

/// Every point of every hair, root first, hair by hair.
fn points(export: &Export<'_>) -> impl Iterator<Item = Point> {
    let (strands, scale) = (export.strands, export.metres_per_unit);
    let count = strands.points_per_strand;
    (0..strands.len() * count).map(move |i| {
        let (hair, s) = (i / count, (i % count) as f32 / (count - 1) as f32);
        let diameter_m = 2.0 * strands.root_radius_m[hair] * strands.profile.radius_factor(s);
        Point {
            diameter: (f64::from(diameter_m) / scale) as f32,
            colour: strands.tint[hair] * strands.profile.ramp_at(s),
            opacity: strands.profile.opacity_at(s),
        }
    })
}

/// How many, as the 32-bit number that both formats count with.
fn counted(count: usize, what: &str) -> Result<u32> {
    u32::try_from(count).ok().filter(|&n| i32::try_from(n).is_ok()).ok_or_else(|| {
        Error::new(Kind::Output, "there are too many hairs for a strand file")
            .with_field(what)
            .with_found(count)
            .with_expected(format!("at most {}", i32::MAX))
            .with_hint("`set` guard.density_per_cm2=… grows fewer")
    })
}
