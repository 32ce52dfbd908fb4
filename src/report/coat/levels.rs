//! A coat's levels of detail beside the fur that they stand for: each from every distance, and the way from one to the next.

use super::fur::{Fur, Painter};
use super::keep::{Drawing, Keep};
use super::sheet::{Column, sheet};
use super::{judge, views};
use crate::data::camera::Camera;
use crate::data::image::Image8;
use crate::error::Result;
use crate::stage::light::Lit;
use crate::stage::rig::Rig;
use serde::Serialize;

/// Furthest that the camera goes on its way out, times the distance at which the asset just fits: there is still an asset to see.
const FURTHEST: f64 = 16.0;

/// A level as it was drawn.
pub struct Shown {
    /// The picture.
    pub drawing: Drawing,
    /// Height of the longest hair in it, pixels.
    pub height_px: f32,
    /// Texels read for each pixel that shows anything.
    pub reads: f64,
}

/// Draws the coat in one level, or in that which the runtime chooses.
pub type DrawLevel<'a> = dyn FnMut(&Camera, Lit, Option<usize>) -> Result<Shown> + 'a;

/// One level from one distance, beside the fur.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Level, 0 being the finest.
    pub level: usize,
    /// Layers, the skin counted.
    pub layers: u32,
    /// Height of the longest hair in the picture, pixels.
    pub height_px: f32,
    /// Times the distance at which the asset just fits.
    pub distance: f64,
    /// Mean LDR-FLIP against the render.
    pub flip: f64,
    /// The same of fur of another seed.
    pub floor_flip: f64,
    /// Mean LDR-FLIP against the level above; none of the finest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip_to_finer: Option<f64>,
    /// Mean luminance over the render's, less 1.
    pub bias: f64,
    /// Mean alpha less the render's, in points.
    pub coverage: f64,
    /// Mean LDR-FLIP of the fringe; none where no outline is in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe_flip: Option<f64>,
    /// Texels read for each pixel that shows anything.
    pub reads_per_covered_pixel: f64,
    /// Graphics memory of the level's textures.
    pub bytes: u64,
    /// Drawing it, ms: the passes and the way back.
    pub view_ms: f64,
}

/// FLIP between neighbouring pictures of a camera that moves away by equal factors, levels chosen by the runtime.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Dolly {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// Of the coat.
    pub coat: Vec<f64>,
    /// Of the fur.
    pub fur: Vec<f64>,
}

impl Dolly {
    /// Mean of the coat's less that of the fur's.
    pub fn excess(&self) -> f64 {
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len().max(1) as f64;
        mean(&self.coat) - mean(&self.fur)
    }
}

/// What a level holds: layers, and bytes of its textures.
pub type Held = (u32, u64);

/// Draws every level from every distance. Gives rows and a sheet: per distance, a column per level. `tell` hears what is being drawn.
///
/// # Errors
/// As the renderers; where a picture cannot be kept.
pub fn look(
    fur: &Fur,
    (held, distances): (&[Held], &[f64]),
    keep: &mut Keep,
    draw: &mut DrawLevel<'_>,
    tell: &mut dyn FnMut(&str),
) -> Result<(Vec<Row>, Image8)> {
    let (light, other) = (fur.light(Rig::Studio, 0, 1), fur.of_another_seed()?);
    let [mut own, mut again] = [fur, &other].map(|fur| Painter::new(fur, &light));
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    for &distance in distances {
        let camera = fur.camera(&views::orbit(0, 1, distance));
        let mut say = || tell(&format!("render: distance {distance}"));
        let (render, _) = own.render(&camera, keep, &mut say)?;
        let (floor, _) = again.render(&camera, keep, &mut say)?;
        let floor_flip = judge(fur, &camera, [&render, &floor])?.likeness.flip;
        let (mut finer, mut of_distance): (Option<Drawing>, _) = (None, Vec::new());
        for (level, &(layers, bytes)) in held.iter().enumerate() {
            let shown = draw(&camera, light.lit.clone(), Some(level))?;
            let judged = judge(fur, &camera, [&render, &shown.drawing])?;
            let to_finer = finer.map(|finer| judge(fur, &camera, [&finer, &shown.drawing])).transpose()?;
            of_distance.push(Column::new(&judged));
            let likeness = judged.likeness;
            rows.push(Row {
                level,
                layers,
                height_px: shown.height_px,
                distance,
                flip: likeness.flip,
                floor_flip,
                flip_to_finer: to_finer.map(|judged| judged.likeness.flip),
                bias: likeness.bias,
                coverage: likeness.coverage,
                fringe_flip: likeness.fringe.map(|fringe| fringe.flip),
                reads_per_covered_pixel: shown.reads,
                bytes,
                view_ms: shown.drawing.cost.ms,
            });
            finer = Some(shown.drawing);
        }
        columns.push(of_distance);
    }
    Ok((rows, sheet(&columns)))
}

/// Goes out in `frames` pictures of `size`.
///
/// # Errors
/// As [`look`].
pub fn dolly(
    fur: &Fur,
    (frames, size): (usize, [u32; 2]),
    keep: &mut Keep,
    draw: &mut DrawLevel<'_>,
    tell: &mut dyn FnMut(&str),
) -> Result<Dolly> {
    let light = fur.light(Rig::Studio, 0, 1);
    let mut painter = Painter::new(fur, &light);
    let mut dolly = Dolly { size, ..Dolly::default() };
    let mut last: Option<[Drawing; 2]> = None;
    for frame in 0..frames {
        let distance = FURTHEST.powf(frame as f64 / (frames.max(2) - 1) as f64);
        let camera = fur.camera(&views::orbit(0, 1, distance));
        let (render, _) = painter.render(&camera, keep, &mut || tell(&format!("dolly: {frame} of {frames}")))?;
        let coat = draw(&camera, light.lit.clone(), None)?.drawing;
        if let Some([before, coat_before]) = &last {
            dolly.fur.push(judge(fur, &camera, [before, &render])?.likeness.flip);
            dolly.coat.push(judge(fur, &camera, [coat_before, &coat])?.likeness.flip);
        }
        last = Some([render, coat]);
    }
    Ok(dolly)
}

/// A header and one line per row; what a row does not have is empty.
pub fn csv(rows: &[Row]) -> String {
    let mut out = String::from(
        "level,layers,height_px,distance,flip,floor_flip,flip_to_finer,bias,coverage,fringe_flip,reads_per_covered_pixel,bytes,view_ms\r\n",
    );
    for row in rows {
        let of = |number: Option<f64>| number.map(|n| format!("{n:.6}")).unwrap_or_default();
        let fields = [
            row.level.to_string(),
            row.layers.to_string(),
            format!("{:.2}", row.height_px),
            row.distance.to_string(),
            of(Some(row.flip)),
            of(Some(row.floor_flip)),
            of(row.flip_to_finer),
            of(Some(row.bias)),
            of(Some(row.coverage)),
            of(row.fringe_flip),
            format!("{:.1}", row.reads_per_covered_pixel),
            row.bytes.to_string(),
            format!("{:.1}", row.view_ms),
        ];
        out.push_str(&fields.join(","));
        out.push_str("\r\n");
    }
    out
}
