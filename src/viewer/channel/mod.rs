//! What a picture measures of a coat from where it is seen: what hides, what lets light through, which level is where, the mesh.

mod levels;
mod wires;

use crate::data::shell::MOST_ABOVE;
use crate::error::Result;
use crate::runtime::gpu::{Prepared, Renderer};
use crate::runtime::{Blending, DrawList, Frame, Picture, Show};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// How much of what lies behind it hair hides.
    Opacity,
    /// How much light comes through hair down to the skin.
    Transmittance,
    /// Which level of detail is drawn.
    Levels,
    /// The triangles of skin and outermost shell, over the picture.
    Wireframe,
}

/// What is looked at and from where.
pub struct Seen<'a> {
    /// What draws it.
    pub renderer: &'a Renderer<'a>,
    /// The asset with its coat.
    pub scene: &'a DrawList<'a>,
    /// From where; a perspective picture.
    pub frame: &'a Frame,
    /// How the coat comes together.
    pub blend: Blending,
}

/// The picture of `channel`, and what its colours mean, one sentence each. `prepared` is the scene, `whole` how it is drawn so.
///
/// # Errors
/// As [`Prepared::draw`].
pub fn draw(
    channel: Channel,
    prepared: &mut Prepared<'_>,
    seen: &Seen<'_>,
    whole: &Picture,
) -> Result<(Picture, Vec<String>)> {
    match channel {
        Channel::Opacity => {
            let coat = Show { skin: false, ..Show::default() };
            Ok(opacity(&prepared.draw_by(seen.frame, coat, seen.blend)?.picture, whole))
        }
        Channel::Transmittance => Ok(transmittance(prepared.depth_to_skin(seen.frame)?)),
        Channel::Levels => levels::draw(prepared, seen),
        Channel::Wireframe => {
            // Its depths are those of the skin alone.
            let frame = Frame { depths: false, shadow_map: false, ..seen.frame.clone() };
            let skin = prepared.draw(&frame, Show { shells: false, fins: false, ..Show::default() })?.picture;
            Ok(wires::over(whole, &skin.depth_m, seen))
        }
    }
}

/// White hair over a black asset.
fn opacity(coat: &Picture, whole: &Picture) -> (Picture, Vec<String>) {
    let grey = |(coat, whole): (&[f32; 4], &[f32; 4])| [coat[3], coat[3], coat[3], whole[3].max(coat[3])];
    let pixels = coat.pixels.iter().zip(&whole.pixels).map(grey).collect();
    let legend = format!(
        "white is hair that hides all behind it, black none; over the whole asset, hair hides {:.1} %",
        100.0 * coat.coverage() / whole.coverage().max(f64::MIN_POSITIVE)
    );
    (Picture { pixels, ..whole.clone() }, vec![legend])
}

/// A picture of [`Prepared::depth_to_skin`], in grey that falls evenly with depth: shares of light span many powers of ten.
fn transmittance(depths: Picture) -> (Picture, Vec<String>) {
    let grey = |&[depth, _, _, alpha]: &[f32; 4]| {
        let light = (alpha - depth / MOST_ABOVE).max(0.0);
        [light, light, light, alpha]
    };
    let furred = || depths.pixels.iter().filter(|pixel| pixel[1] > 0.99);
    let mean = furred().map(|pixel| f64::from(pixel[0])).sum::<f64>() / furred().count().max(1) as f64;
    let legend = format!(
        "the skin alone: white where all light, of what falls in at 45°, comes down to it through its hair; darker evenly by the \
         logarithm, black at e^−{MOST_ABOVE}, the least that a tile knows; the mean of skin that has hair is e^−{mean:.2}, {:.2} %",
        100.0 * libm::exp(-mean)
    );
    (Picture { pixels: depths.pixels.iter().map(grey).collect(), ..depths }, vec![legend])
}
