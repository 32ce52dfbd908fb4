//! How a picture is made.

use super::resolve::Blending;
use super::strands::thin::Thinning;
use crate::data::camera::Camera;
use crate::data::film::Layers;
use crate::error::Result;
use crate::math::DVec3;
use crate::stage::projection::Projection;
use crate::volume::march::Stepping;
use crate::volume::march::content::Resolution;

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Pixels are drawn as 2^halvings × 2^halvings samples, at most [`MOST_HALVINGS`], and averaged. Andersen et al. 2016 use
    /// four samples.
    pub halvings: u32,
    /// How guard hair and undercoat are ordered.
    pub blending: Blending,
    /// How finely rays are followed through undercoat.
    pub stepping: Stepping,
    /// How finely undercoat is stored.
    pub resolution: Resolution,
    /// How far apart columns of the shadow in the mean stand at most, in heights of the tips; infinite for those over the skin's
    /// vertices alone.
    pub shadow_span: f32,
    /// Width, px, that guard hairs have at least at their roots: where single ones are thinner, fewer are drawn, each wider; 0 draws
    /// every hair as it is.
    pub hair_px: f32,
    /// Transmittance below which what is seen already stands for what is behind it.
    pub opaque: f32,
    /// Memory for the strands of a band of rows, bytes: smaller budgets give more bands and the same picture.
    pub band_bytes: usize,
    /// What the film holds.
    pub layers: Layers,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [512, 512],
            halvings: 0,
            blending: Blending::Virtual { fragments: 8 },
            stepping: Stepping::default(),
            resolution: Resolution::default(),
            shadow_span: 0.1,
            hair_px: 0.0,
            opaque: 1e-3,
            band_bytes: 256 << 20,
            layers: Layers::All,
        }
    }
}

impl Settings {
    /// One sample per pixel, no finer than a first look needs: hair and sub-elements as fine as pixels show them.
    pub fn preview(size: [usize; 2]) -> Self {
        Self {
            size,
            hair_px: 0.5,
            opaque: 0.006,
            stepping: Stepping { depth: 0.5, layers: 2.0 },
            resolution: Resolution { subelement_px: 3.0, ..Resolution::default() },
            shadow_span: f32::INFINITY,
            ..Self::default()
        }
    }

    /// Andersen et al. 2016's four samples per pixel, or sixteen in small pictures, with shorter steps and more virtual
    /// fragments.
    pub fn best(size: [usize; 2]) -> Self {
        Self {
            size,
            halvings: if size[0] * size[1] <= SMALL { 2 } else { 1 },
            blending: Blending::Virtual { fragments: 8 },
            opaque: 0.004,
            stepping: Stepping { depth: 0.15, layers: 0.25 },
            resolution: Resolution { coarsest_details: 2.0, ..Resolution::default() },
            ..Self::default()
        }
    }

    /// Samples along a pixel's edge.
    pub fn edge_samples(&self) -> usize {
        1 << self.halvings.min(MOST_HALVINGS)
    }

    /// How hair too thin for its pixels is drawn in a view of samples.
    pub(super) fn thinning(&self, view: &Projection) -> Thinning {
        Thinning::new(view, self.hair_px * self.edge_samples() as f32)
    }

    /// What the camera shows, sample by sample, of a mesh at `origin_m`.
    ///
    /// # Errors
    /// As [`Projection::new`].
    pub(super) fn view(&self, camera: &Camera, origin_m: DVec3) -> Result<Projection> {
        Projection::new(camera, origin_m, self.size.map(|n| n * self.edge_samples()))
    }
}

/// Pixels of a picture small enough for them to be wider than clumps are fine, and to cost little.
const SMALL: usize = 1 << 17;

/// Most halvings of a pixel's edge: a tile's 32 samples are then four pixels.
pub const MOST_HALVINGS: u32 = 3;
