//! What is behind the asset in a picture of eight bits.

use crate::error::{Error, Result};
use crate::math::Vec3;
use std::str::FromStr;

/// The wall at the top and at the bottom of the picture.
const BACKDROP: [Vec3; 2] = [Vec3::new(0.34, 0.37, 0.41), Vec3::new(0.66, 0.67, 0.68)];

/// What is behind the asset, linear RGB. It is put there after tone mapping and exposure, which are the asset's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// A grey wall, lighter below.
    #[default]
    Backdrop,
    /// One colour.
    Colour(Vec3),
    /// Nothing: the picture keeps its alpha.
    Transparent,
}

impl FromStr for Background {
    type Err = Error;

    /// Reads `backdrop` or `R,G,B`.
    fn from_str(text: &str) -> Result<Self> {
        if text.trim() == "backdrop" {
            return Ok(Self::Backdrop);
        }
        let fault = |error: Error| error.with_expected("backdrop, or R,G,B: linear, each 0 to 1");
        let colour = super::light::parse_triple(text, "background").map_err(fault)?;
        if colour.min_element() < 0.0 || colour.max_element() > 1.0 {
            let error = Error::usage("a picture has no such colour").with_parameter("background").with_found(text);
            return Err(fault(error));
        }
        Ok(Self::Colour(colour))
    }
}

impl Background {
    /// The colour behind row `y` of `height`; none where the picture keeps its alpha.
    pub fn behind(self, y: usize, height: usize) -> Option<Vec3> {
        match self {
            Self::Backdrop => Some(BACKDROP[0].lerp(BACKDROP[1], y as f32 / height.max(2) as f32)),
            Self::Colour(colour) => Some(colour),
            Self::Transparent => None,
        }
    }
}
