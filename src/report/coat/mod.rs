//! A coat beside the fur that it stands for (`docs/steps/report-coat.md`): the same views in the same lights, drawn from the
//! coat as a game draws it and hair by hair.
//!
//! In: what to look at ([`Options`]), the fur ([`Fur`]) and something that draws the coat. Out: measures per picture, their
//! summary, and a sheet of the pictures. Finished pictures are kept ([`keep::Keep`]).

mod fur;
pub mod keep;
pub mod key;
pub mod levels;
pub mod sheet;
pub mod summary;
pub mod table;
pub mod views;

pub use fur::Fur;

use super::plot::{self, Dot};
use crate::data::camera::Camera;
use crate::data::image::Image8;
use crate::error::Result;
use crate::math::DVec3;
use crate::metrics::likeness::{self, Judged, Likeness};
use crate::stage::light::Lit;
use crate::stage::projection::Projection;
use crate::stage::rig::Rig;
use fur::Painter;
use keep::{Drawing, Keep, Of};
use key::Key;
use serde::Serialize;
use serde_json::{Value, json};
use sheet::Column;
use summary::{Summary, summarise};
use views::Distance;

/// How a coat is looked at.
#[derive(Clone, Debug)]
pub struct Options {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// In which lights.
    pub lights: Vec<Rig>,
    /// From how far, and how often.
    pub distances: Vec<Distance>,
    /// Stands for the coat and what draws it.
    pub coat: Key,
    /// Graphics memory of the coat's textures and geometry, bytes.
    pub coat_bytes: u64,
}

/// Draws the coat.
pub type DrawCoat<'a> = dyn FnMut(&Camera, Lit) -> Result<Drawing> + 'a;

/// One view in one light.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Where from, degrees, as [`crate::stage::camera::Orbit`] has it.
    pub azimuth_deg: f64,
    /// The same.
    pub elevation_deg: f64,
    /// Times the distance at which the asset just fits.
    pub distance: f64,
    /// In which light.
    pub light: Rig,
    /// How far the coat is off.
    pub likeness: Likeness,
    /// How far another growth of the same fur is off, in one picture from this distance.
    pub floor: Floor,
    /// What it cost.
    pub cost: Cost,
}

/// Another seed's fur against the same render.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Floor {
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// That of the fringe; none where no outline is in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe_flip: Option<f64>,
}

/// What a picture cost when it was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// Drawing the coat, ms: the passes and the way back.
    pub view_ms: f64,
    /// Drawing the fur, ms; what pictures in one light and direction share counts for the first.
    pub render_ms: f64,
    /// Graphics memory of the coat's textures and geometry.
    pub bytes: u64,
    /// Triangles that the coat's picture drew.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
}

/// Everything that was found.
#[derive(Clone, Debug)]
pub struct Report {
    /// By light, distance and azimuth.
    pub pictures: Vec<Picture>,
    /// In a few numbers.
    pub summary: Summary,
    /// What a person should know of the drawing, each once.
    pub notes: Vec<String>,
    /// Renders and coats that had to be drawn; the others were kept.
    pub drawn: Drawn,
    /// Per light and distance three rows, render, coat and FLIP, a column per view.
    pub sheet: Image8,
}

/// How many pictures had to be drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Drawn {
    /// Hair by hair.
    pub renders: usize,
    /// Of the coat.
    pub coats: usize,
}

impl Picture {
    /// As it stands in a report.
    pub fn value(&self) -> Value {
        let mut all = json!({
            "azimuth_deg": self.azimuth_deg,
            "elevation_deg": self.elevation_deg,
            "distance": self.distance,
            "light": self.light.name(),
        });
        let rest = [json!(self.likeness), json!({ "floor": self.floor, "cost": self.cost })];
        for members in rest {
            if let (Some(all), Value::Object(members)) = (all.as_object_mut(), members) {
                all.extend(members);
            }
        }
        all
    }
}

impl Report {
    /// Error against cost: coats, and the floor of each distance.
    pub fn plot(&self, title: &str) -> String {
        let mut dots: Vec<Dot> = Vec::new();
        for p in &self.pictures {
            let group = format!("distance {}", p.distance);
            let of = format!("{}, {group}, azimuth {:.0}°", p.light, p.azimuth_deg);
            let dot = |open: bool, ms: f64, error: f64| Dot {
                label: format!("{of}: {ms:.0} ms, FLIP {error:.4}"),
                group: group.clone(),
                open,
                name: None,
                ms,
                error,
                pareto: false,
            };
            if !dots.iter().any(|dot| dot.group == group) {
                dots.push(dot(true, p.cost.render_ms, p.floor.flip));
            }
            dots.push(dot(false, p.cost.view_ms, p.likeness.flip));
        }
        let notes = ["full: the coat", "open: fur of another seed, by render"];
        plot::draw([title, "FLIP against fur drawn hair by hair"], &dots, &notes)
    }
}

/// Looks at a coat. `tell` hears what is being drawn.
///
/// # Errors
/// As the renderers and [`likeness::judge`]; where a picture cannot be kept.
pub fn look(
    options: &Options,
    fur: &Fur,
    keep: &mut Keep,
    draw_coat: &mut DrawCoat<'_>,
    tell: &mut dyn FnMut(&str),
) -> Result<Report> {
    let most = options.distances.iter().map(|distance| distance.views).max().unwrap_or(0);
    let (mut drawn, mut notes) = (Drawn::default(), Vec::new());
    let floors = floors(options, fur, keep, (&mut drawn, &mut notes), tell)?;
    // A place per light, distance and view, in the report's order.
    let mut found: Vec<Vec<Vec<(Picture, Column)>>> =
        options.lights.iter().map(|_| options.distances.iter().map(|_| Vec::new()).collect()).collect();
    for (light, of_light) in options.lights.iter().zip(&mut found) {
        for number in 0..most {
            // Directions do not hang on the distance: what is made ready for one serves all.
            let rays = fur.light(*light, number, most);
            let mut painter = Painter::new(fur, &rays);
            for ((distance, floor), of_distance) in options.distances.iter().zip(&floors).zip(of_light.iter_mut()) {
                if !views::numbers(distance, most).any(|n| n == number) {
                    continue;
                }
                let orbit = views::orbit(number, most, distance.times);
                let camera = fur.camera(&orbit);
                let of = format!("{light}, distance {}, azimuth {:.0}°", distance.times, orbit.azimuth_deg);
                let (render, new) = painter.render(&camera, keep, &mut || tell(&format!("render: {of}")))?;
                drawn.renders += usize::from(new);
                let key = options.coat.with(camera).with(&rays.lit).with(options.size);
                let coat = match keep.get(Of::Coat, key, options.size) {
                    Some(kept) => kept,
                    None => {
                        tell(&format!("coat: {of}"));
                        let coat = draw_coat(&camera, rays.lit.clone())?;
                        keep.put(Of::Coat, key, &coat)?;
                        drawn.coats += 1;
                        coat
                    }
                };
                let judged = judge(fur, &camera, [&render, &coat])?;
                let column = Column::new(&judged);
                let picture = Picture {
                    azimuth_deg: orbit.azimuth_deg,
                    elevation_deg: orbit.elevation_deg,
                    distance: distance.times,
                    light: *light,
                    likeness: judged.likeness,
                    floor: *floor,
                    cost: Cost {
                        view_ms: coat.cost.ms,
                        render_ms: render.cost.ms,
                        bytes: options.coat_bytes,
                        triangles: coat.cost.triangles,
                    },
                };
                of_distance.push((picture, column));
            }
            notes.extend(painter.notes);
        }
    }
    let (mut pictures, mut groups) = (Vec::new(), Vec::new());
    for group in found.into_iter().flatten() {
        let (of_group, columns): (Vec<_>, Vec<_>) = group.into_iter().unzip();
        pictures.extend(of_group);
        groups.push(columns);
    }
    keep.tidy();
    notes.sort();
    notes.dedup();
    Ok(Report { summary: summarise(&pictures), pictures, notes, drawn, sheet: sheet::sheet(&groups) })
}

/// Per distance, how far fur of another seed is off in the first view and light.
fn floors(
    options: &Options,
    fur: &Fur,
    keep: &mut Keep,
    (drawn, notes): (&mut Drawn, &mut Vec<String>),
    tell: &mut dyn FnMut(&str),
) -> Result<Vec<Floor>> {
    let most = options.distances.iter().map(|distance| distance.views).max().unwrap_or(0);
    let Some(&light) = options.lights.first() else { return Ok(Vec::new()) };
    let (rays, other) = (fur.light(light, 0, most), fur.of_another_seed()?);
    let [mut own, mut other] = [fur, &other].map(|fur| Painter::new(fur, &rays));
    let mut floor = |distance: &Distance| {
        let camera = fur.camera(&views::orbit(0, most, distance.times));
        let mut say = || tell(&format!("floor: {light}, distance {}", distance.times));
        let (render, new) = own.render(&camera, keep, &mut say)?;
        let (again, new_again) = other.render(&camera, keep, &mut say)?;
        drawn.renders += usize::from(new) + usize::from(new_again);
        let judged = judge(fur, &camera, [&render, &again])?.likeness;
        Ok(Floor { flip: judged.flip, fringe_flip: judged.fringe.map(|fringe| fringe.flip) })
    };
    let floors = options.distances.iter().map(&mut floor).collect();
    notes.extend(own.notes.into_iter().chain(other.notes));
    floors
}

/// Compares, with a fringe as wide as hair is long in the picture.
fn judge(fur: &Fur, camera: &Camera, [render, other]: [&Drawing; 2]) -> Result<Judged> {
    let size = [render.picture.width, render.picture.height];
    let focal_px = Projection::new(camera, DVec3::ZERO, size)?.focal_px;
    let away_m = DVec3::from(camera.eye).distance(DVec3::from(camera.target)) as f32;
    likeness::judge(&render.picture, &other.picture, fur.hair_m() * focal_px / away_m)
}
