//! How much a coat looks like the fur that it stands for (`docs/steps/report-coat.md`). In: a render of the fur and a picture
//! of the coat, of one camera and light. Out: what a player would see of the difference, split into what causes it.

pub mod bands;
pub mod blocks;
pub mod fringe;
mod smooth;

use super::compare::{LUMA, LinearImage, compare_mapped, mean};
use crate::error::{Error, Result};
use crate::math::Vec3;
use bands::Bands;
use serde::Serialize;

/// Mean luminance that fur is exposed for, linear.
pub const EXPOSED: f64 = 0.25;
/// What is behind the fur in both pictures, linear: mid-grey.
pub const BEHIND: f32 = 0.18;

/// A render's light below this counts as this, so that what is over it is a number.
const DARKEST: f64 = 1e-9;

/// How far a coat is off a render; `Serialize` gives the names that the report has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Likeness {
    /// Mean LDR-FLIP over counted pixels: those with coverage in either picture.
    pub flip: f64,
    /// Its 95th percentile.
    pub flip_p95: f64,
    /// mean((a − b)²/(b² + 0.01)) over counted pixels and channels.
    pub relmse: f64,
    /// The same between means of blocks of 8 × 8 pixels.
    pub relmse_8x8: f64,
    /// Mean luminance of what is drawn over the render's, less 1.
    pub bias: f64,
    /// The same of each channel.
    pub bias_rgb: [f64; 3],
    /// Mean alpha over counted pixels, less the render's, in points.
    pub coverage: f64,
    /// What the band around the outline shows; none where no outline is in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe: Option<Fringe>,
    /// Variance of luminance by size of detail, over the render's.
    pub bands: Bands,
}

/// How far a coat is off around the outline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fringe {
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// Mean alpha less the render's, in points.
    pub coverage: f64,
}

/// Two pictures laid over each other.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The measures.
    pub likeness: Likeness,
    /// Render and coat as they were compared: exposed, over grey.
    pub shown: [LinearImage; 2],
    /// LDR-FLIP pixel by pixel.
    pub flip: Vec<f32>,
}

/// The factor on light that puts the mean luminance of what `render` shows at [`EXPOSED`].
///
/// # Errors
/// [`crate::error::Kind::Usage`] where it shows nothing, or nothing lit.
pub fn exposure(render: &LinearImage) -> Result<f32> {
    let luminance = f64::from(mean_light(render).dot(LUMA));
    let exposure = (EXPOSED / luminance) as f32;
    if luminance > 0.0 && exposure.is_finite() {
        return Ok(exposure);
    }
    Err(Error::usage("a view shows no lit fur")
        .with_found(format!("mean luminance {luminance}"))
        .with_expected("some light")
        .with_hint("choose other `distances` or `lights`"))
}

/// Compares `coat` with `render`, whose outline has a band of `fringe_px` pixels around it.
///
/// # Errors
/// As [`exposure`] and [`super::compare::compare`].
pub fn judge(render: &LinearImage, coat: &LinearImage, fringe_px: f32) -> Result<Judged> {
    let exposure = exposure(render)?;
    let shown = [render, coat].map(|picture| over_grey(picture, exposure));
    let (difference, flip) = compare_mapped(&shown[0], &shown[1])?;
    let counted = counted(render, coat);
    let points = |at: &[usize]| 100.0 * mean(at.iter().map(|&i| f64::from(coat.alpha[i] - render.alpha[i])));
    let band = fringe::band(render, fringe_px);
    let fringe = (!band.is_empty())
        .then(|| Fringe { flip: mean(band.iter().map(|&i| f64::from(flip[i]))), coverage: points(&band) });
    let [of_render, of_coat] = [render, coat].map(mean_light);
    let likeness = Likeness {
        flip: difference.flip,
        flip_p95: difference.flip_p95,
        relmse: difference.rel_mse,
        relmse_8x8: blocks::rel_mse(&shown[0], &shown[1]),
        bias: excess(of_coat.dot(LUMA), of_render.dot(LUMA)),
        bias_rgb: std::array::from_fn(|i| excess(of_coat[i], of_render[i])),
        coverage: points(&counted),
        fringe,
        bands: Bands::new(&shown[0], &shown[1]),
    };
    Ok(Judged { likeness, shown, flip })
}

/// Pixels with coverage in either picture.
fn counted(render: &LinearImage, coat: &LinearImage) -> Vec<usize> {
    (0..render.alpha.len()).filter(|&i| render.alpha[i] > 0.0 || coat.alpha[i] > 0.0).collect()
}

/// `a` over `b`, less 1; 0 where both are black.
fn excess(a: f32, b: f32) -> f64 {
    if a == b { 0.0 } else { f64::from(a) / f64::from(b).max(DARKEST) - 1.0 }
}

/// Mean light of what is drawn, as if it covered its pixels: light over alpha.
fn mean_light(picture: &LinearImage) -> Vec3 {
    let light = picture.colour.iter().fold(crate::math::DVec3::ZERO, |sum, c| sum + c.as_dvec3());
    let alpha: f64 = picture.alpha.iter().map(|&a| f64::from(a)).sum();
    if alpha > 0.0 { (light / alpha).as_vec3() } else { Vec3::ZERO }
}

/// The picture exposed and over mid-grey; its alpha stays what it was.
fn over_grey(picture: &LinearImage, exposure: f32) -> LinearImage {
    let over = |(&colour, &alpha): (&Vec3, &f32)| colour * exposure + Vec3::splat(BEHIND * (1.0 - alpha));
    LinearImage { colour: picture.colour.iter().zip(&picture.alpha).map(over).collect(), ..picture.clone() }
}
