//! The comb's sources in the order that they decide: painted map, vertex attribute, whorls, strokes, partings,
//! the preset's rule.

use super::units::Scale;
use crate::asset::Asset;
use crate::data::maps::Maps;
use crate::data::mesh::Mesh;
use crate::data::parting::Parting;
use crate::error::Result;
use crate::fur::field::{DirectionField, FieldSource, Whorl};
use crate::fur::groom::maps::comb_directions;
use crate::fur::groom::{self, Comb, Groom, Place};
use crate::math::{DVec3, Vec3};

/// Share of gravity in a tailward comb.
const SAG: f32 = 0.3;

/// The comb of `mesh`, all parts of `asset`, as `directions` ([`crate::fur::field::directions`], or what kept its results)
/// makes it of the sources; zero where hair stands upright. What should be said of whorls, strokes and partings that miss the
/// asset is added to `notes`.
///
/// # Errors
/// As `directions`.
pub fn comb(
    asset: &Asset,
    mesh: &Mesh,
    groom: &Groom,
    maps: &Maps,
    scale: &Scale,
    notes: &mut Vec<String>,
    directions: impl FnOnce(&Mesh, &[FieldSource]) -> Result<DirectionField>,
) -> Result<DirectionField> {
    let mut sources = Vec::new();
    if let (Some(map), Some(uv)) = (&maps.comb, mesh.uv_sets.first()) {
        sources.push(FieldSource::Vertices(comb_directions(mesh, uv, map)));
    }
    if let Some(attribute) = &mesh.fur_direction {
        sources.push(FieldSource::Vertices(attribute.clone()));
    }
    if !groom.whorls.is_empty() || !groom.strokes.is_empty() || !groom.partings.is_empty() {
        let brush = Brush::new(asset, scale);
        sources.extend(brush.sources(groom));
        brush.misses(groom, notes);
    }
    match groom.comb {
        Comb::Upright if sources.is_empty() => {
            let direction = vec![Vec3::ZERO; mesh.positions_m.len()];
            return Ok(DirectionField { direction, ..DirectionField::default() });
        }
        Comb::Upright | Comb::Smooth => {}
        Comb::Gravity => sources.push(FieldSource::Gravity),
        Comb::Tailward => sources.push(FieldSource::Tailward { sag: SAG }),
    }
    directions(mesh, &sources)
}

/// A preset's partings on `asset`.
pub fn partings(asset: &Asset, groom: &Groom, scale: &Scale) -> Vec<Parting> {
    if groom.partings.is_empty() {
        return Vec::new();
    }
    let brush = Brush::new(asset, scale);
    groom.partings.iter().map(|parting| brush.parting(parting)).collect()
}

/// Turns places of a preset into metres of an asset.
struct Brush<'a> {
    asset: &'a Asset,
    low: DVec3,
    high: DVec3,
    origin: DVec3,
    scale: &'a Scale,
}

impl<'a> Brush<'a> {
    fn new(asset: &'a Asset, scale: &'a Scale) -> Self {
        let points = || asset.parts.iter().flat_map(|part| (0..part.vertices()).map(|v| part.world_units(v)));
        Self {
            asset,
            low: points().fold(DVec3::INFINITY, DVec3::min),
            high: points().fold(DVec3::NEG_INFINITY, DVec3::max),
            origin: asset.parts.first().map_or(DVec3::ZERO, |part| part.centre_units),
            scale,
        }
    }

    fn diagonal_m(&self) -> f32 {
        self.scale.diagonal_m as f32
    }

    fn point_m(&self, place: Place) -> Vec3 {
        let units = match place {
            Place::Relative(share) => self.low + (self.high - self.low) * Vec3::from(share).as_dvec3(),
            Place::Units(units) => self.asset.scene.world_from_file(DVec3::from(units)),
        };
        ((units - self.origin) * self.scale.metres_per_unit).as_vec3()
    }

    fn parting(&self, parting: &groom::Parting) -> Parting {
        Parting {
            line_m: parting.points.places().into_iter().map(|p| self.point_m(p)).collect(),
            reach_m: parting.reach.metres(self.diagonal_m()),
            width_m: parting.width.metres(self.diagonal_m()),
            angle_rad: parting.angle_deg.to_radians(),
        }
    }

    fn sources(&self, groom: &Groom) -> Vec<FieldSource> {
        let whorl = |w: &crate::fur::groom::Whorl| Whorl {
            centre_m: self.point_m(w.at),
            reach_m: w.reach.metres(self.diagonal_m()),
            spin_rad: w.spin_deg.to_radians(),
        };
        let whorls = FieldSource::Whorls(groom.whorls.iter().map(whorl).collect());
        let strokes = groom.strokes.iter().map(|s| FieldSource::Strokes {
            lines_m: vec![s.points.places().into_iter().map(|p| self.point_m(p)).collect()],
            reach_m: s.reach.metres(self.diagonal_m()),
        });
        let partings = FieldSource::Partings(groom.partings.iter().map(|p| self.parting(p)).collect());
        std::iter::once(whorls).chain(strokes).chain([partings]).collect()
    }

    /// Says which whorls, strokes and partings lie further from every vertex than they reach.
    fn misses(&self, groom: &Groom, notes: &mut Vec<String>) {
        let whorls = groom.whorls.iter().enumerate().map(|(i, w)| (format!("groom.whorls[{i}]"), vec![w.at], w.reach));
        let strokes =
            groom.strokes.iter().enumerate().map(|(i, s)| (format!("groom.strokes[{i}]"), s.points.places(), s.reach));
        let partings = groom
            .partings
            .iter()
            .enumerate()
            .map(|(i, p)| (format!("groom.partings[{i}]"), p.points.places(), p.reach));
        for (name, places, reach) in whorls.chain(strokes).chain(partings) {
            let line: Vec<Vec3> = places.into_iter().map(|p| self.point_m(p)).collect();
            let reach_m = reach.metres(self.diagonal_m());
            let nearest_m = self
                .asset
                .parts
                .iter()
                .flat_map(|part| (0..part.vertices()).map(|v| part.world_units(v)))
                .map(|p| ((p - self.origin) * self.scale.metres_per_unit).as_vec3())
                .map(|p| crate::fur::field::distance_to_line(p, &line))
                .fold(f32::INFINITY, f32::min);
            if nearest_m >= reach_m {
                notes.push(format!(
                    "{name} combs nothing: it reaches {:.1} mm, and the skin's nearest vertex is {:.1} mm away",
                    reach_m * 1e3,
                    nearest_m * 1e3
                ));
            }
        }
    }
}
