//! Which way up an input is: glTF says +y, with the front towards +z; scans and modelling programs say otherwise.

use crate::error::{Error, Result};
use crate::math::{DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// What axes are called.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// A direction along one of a file's axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
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
        let index = NAMES.iter().position(|axis| axis.eq_ignore_ascii_case(name));
        index.map(|index| Self { index, negative }).ok_or("expected x, y, z, -x, -y or -z")
    }
}

impl TryFrom<String> for Axis {
    type Error = &'static str;

    fn try_from(text: String) -> std::result::Result<Self, Self::Error> {
        text.parse()
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.negative { "-" } else { "" }, NAMES[self.index])
    }
}

impl From<Axis> for String {
    fn from(axis: Axis) -> Self {
        axis.to_string()
    }
}

/// How a file's axes lie that are others than glTF's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Upright {
    up: Axis,
    forward: Axis,
}

impl Upright {
    /// Of the axis that is up and the one that the front looks along; none where neither is said.
    ///
    /// # Errors
    /// When the two lie along the same axis.
    pub fn of(up: Option<Axis>, forward: Option<Axis>) -> Result<Option<Self>> {
        if up.is_none() && forward.is_none() {
            return Ok(None);
        }
        let up = up.unwrap_or(Axis::Y);
        // Without a word on its front, what a turn from +y to `up` about x (else z) makes of +z: −y for a file with z up, as in
        // Blender.
        let forward = forward.unwrap_or(match (up.index, up.negative) {
            (2, negative) => Axis { index: 1, negative: !negative },
            _ => Axis { index: 2, negative: false },
        });
        if up.index == forward.index {
            return Err(Error::usage("up and forward lie along the same axis")
                .with_parameter("forward")
                .with_found(forward)
                .with_expected("another axis than that of `up`"));
        }
        Ok(Some(Self { up, forward }))
    }

    /// The turn that stands the file upright: up along +y, its front towards +z.
    pub fn turn(self) -> DMat3 {
        let (up, forward) = (self.up.vector(), self.forward.vector());
        // Rows: what of a vector of the file goes along x, y and z.
        DMat3::from_cols(up.cross(forward), up, forward).transpose()
    }
}
