//! Which way up an input is: glTF says +y, with the front towards +z; scans and modelling programs say otherwise.

use crate::error::{Error, Result};
use crate::math::{DMat3, DVec3};
use std::str::FromStr;

/// A direction along one of a file's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// 0 to 2: x, y, z.
    index: usize,
    negative: bool,
}

impl Axis {
    /// Up in a glTF file.
    pub const Y: Self = Self { index: 1, negative: false };

    fn vector(self) -> DVec3 {
        DVec3::AXES[self.index] * if self.negative { -1.0 } else { 1.0 }
    }
}

impl FromStr for Axis {
    type Err = &'static str;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        let (negative, name) = match text.strip_prefix('-') {
            Some(name) => (true, name),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let index = ["x", "y", "z"].iter().position(|axis| axis.eq_ignore_ascii_case(name));
        index.map(|index| Self { index, negative }).ok_or("expected x, y, z, -x, -y or -z")
    }
}

/// The turn that stands an input upright: up along +y, its front towards +z.
///
/// # Errors
/// When the two lie along the same axis.
pub fn upright(up: Axis, forward: Option<Axis>) -> Result<DMat3> {
    // Without a word on its front, what a turn from +y to `up` about x (else z) makes of +z: −y for a file with z up, as in
    // Blender.
    let forward = forward.unwrap_or(match (up.index, up.negative) {
        (2, negative) => Axis { index: 1, negative: !negative },
        _ => Axis { index: 2, negative: false },
    });
    if up.index == forward.index {
        return Err(Error::usage("up and forward lie along the same axis")
            .with_parameter("forward")
            .with_found(["x", "y", "z"][forward.index])
            .with_expected("another axis than that of `up`"));
    }
    let (up, forward) = (up.vector(), forward.vector());
    // Rows: what of a vector of the file goes along x, y and z.
    Ok(DMat3::from_cols(up.cross(forward), up, forward).transpose())
}
