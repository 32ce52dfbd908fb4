//! The flags of every command that reads a mesh: which way up it is.

use crate::asset::Reading;
use crate::asset::axes::{Axis, Upright};
use crate::error::Result;
use clap::Args;

/// Which way up an input is.
#[derive(Clone, Debug, Args)]
pub struct AxesArgs {
    /// Which of the file's axes is up: x, y, z, -x, -y or -z; glTF's is y, scans often have z. Hair, camera and light take the
    /// file to stand so; what is written keeps its own axes
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub up: Option<Axis>,
    /// Where its front looks [default: z, or -y with --up z]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub forward: Option<Axis>,
}

impl AxesArgs {
    /// How to read the input.
    ///
    /// # Errors
    /// When both are along one axis.
    pub fn reading(&self) -> Result<Reading> {
        let upright = Upright::of(self.up, self.forward)?.map(Upright::turn);
        Ok(Reading { upright, ..Reading::default() })
    }
}
