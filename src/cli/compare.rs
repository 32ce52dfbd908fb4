//! `furrier compare`.

use super::console::Console;
use crate::error::{Error, Kind, Result};
use crate::metrics::compare::{Difference, compare, load};
use clap::Args;
use std::io::{self, Write};
use std::path::PathBuf;

/// Say how far one picture is from another
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier compare reference.exr rendered.exr
  furrier compare golden.png new.png --max-flip 0.02

FLIP is NVIDIA's LDR-FLIP at 67 pixels per degree, averaged over pixels that either picture covers. The pictures may be
PNG (sRGB) or EXR (linear) and must be of one size.")]
pub struct Compare {
    /// The reference
    a: PathBuf,
    /// The picture to judge
    b: PathBuf,
    /// Exit with 1 where the mean FLIP is larger than this
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
}

/// Whether a limit on FLIP is one.
pub(super) fn check_limit(limit: Option<f64>) -> Result<()> {
    match limit.filter(|limit| !(0.0..=1.0).contains(limit)) {
        Some(limit) => Err(Error::usage("the limit is out of range")
            .with_field("--max-flip")
            .with_found(limit)
            .with_expected("a number from 0 to 1")),
        None => Ok(()),
    }
}

impl Compare {
    /// Prints the measures.
    ///
    /// # Errors
    /// Where a picture cannot be read, sizes differ, or FLIP is over the limit.
    pub fn run(self, console: &Console) -> Result<()> {
        check_limit(self.max_flip)?;
        let (reference, other) = (load(&self.a)?, load(&self.b)?);
        let difference = compare(&reference, &other).map_err(|e| e.with_file(&self.b))?;
        console.result(&difference, |out| print(&difference, out))?;
        match self.max_flip {
            Some(limit) if difference.flip > limit => {
                Err(Error::new(Kind::Difference, "the pictures differ by more than the limit")
                    .with_file(&self.b)
                    .with_field("flip")
                    .with_found(format!("{:.4}", difference.flip))
                    .with_expected(format!("at most {limit}")))
            }
            _ => Ok(()),
        }
    }
}

fn print(d: &Difference, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "FLIP      {:.4} (95th percentile {:.4})", d.flip, d.flip_p95)?;
    writeln!(out, "relMSE    {:.5}", d.rel_mse)?;
    match d.psnr_db {
        Some(psnr_db) => writeln!(out, "PSNR      {psnr_db:.2} dB")?,
        None => writeln!(out, "PSNR      equal")?,
    }
    writeln!(out, "SSIM      {:.4}", d.ssim)?;
    writeln!(out, "bias      {:+.2} %", d.bias * 100.0)?;
    writeln!(out, "coverage  {:.4} and {:.4}", d.coverage[0], d.coverage[1])
}
