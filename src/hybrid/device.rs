//! Which device draws a picture, and what happens where it cannot.

use super::gpu;
use super::picture::Picture;
use super::prepared::Prepared;
use crate::data::camera::Camera;
use crate::error::{Error, Kind, Result};
use crate::gpu::{AdapterKind, Choice, Gpu, adapters};
use std::str::FromStr;

/// What draws.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Device {
    /// A hardware GPU where there is one, else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A graphics adapter, software ones too.
    Gpu(Choice),
}

impl FromStr for Device {
    type Err = Error;

    /// Reads `auto`, `cpu`, `gpu` or `gpu:NAME`.
    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            "cpu" => Ok(Self::Cpu),
            _ => match text.parse() {
                Ok(choice) => Ok(Self::Gpu(choice)),
                Err(error) => Err(error.with_expected("auto, cpu, gpu or gpu:NAME")),
            },
        }
    }
}

/// A picture, and what drew it.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// `cpu`, or the adapter.
    pub device: String,
    /// What a person should know, one sentence each.
    pub notes: Vec<String>,
}

/// How much larger the buffers of a hardware GPU may be than [`super::Settings::band_bytes`]: its memory is its own.
const HARDWARE: usize = 8;
/// By how much they shrink where the device failed, and how often.
const SHRINK: [usize; 3] = [1, 4, 16];

/// Draws what was made ready on `device`.
///
/// # Errors
/// As [`Prepared::draw`]; [`Kind::Device`] where a GPU was asked for and there is none, or none of the name.
pub fn draw(device: &Device, prepared: &Prepared<'_>, camera: &Camera) -> Result<Drawn> {
    let choice = match device {
        Device::Cpu => None,
        Device::Gpu(choice) => Some(choice.clone()),
        Device::Auto => {
            let hardware = |kind| !matches!(kind, AdapterKind::Software | AdapterKind::Other);
            adapters().first().filter(|adapter| hardware(adapter.kind)).map(|_| Choice::Auto)
        }
    };
    match choice {
        Some(choice) => with_fallback(|| Gpu::open(&choice), prepared, camera),
        None => on_cpu(prepared, camera, Vec::new()),
    }
}

/// Draws on the GPU that `open` gives. One that fails is opened anew and asked for less at a time; where that fails too, the
/// CPU draws. Notes say so.
///
/// # Errors
/// As [`Prepared::draw`], and what `open` says the first time.
pub fn with_fallback(open: impl Fn() -> Result<Gpu>, prepared: &Prepared<'_>, camera: &Camera) -> Result<Drawn> {
    let mut gpu = open()?;
    let name = gpu.adapter.to_string();
    let mut notes = Vec::new();
    for (attempt, shrink) in SHRINK.into_iter().enumerate() {
        if attempt > 0 {
            // A device that was lost or ran out of memory is not asked again; a new one may do.
            match open() {
                Ok(new) => gpu = new,
                Err(_) => break,
            }
        }
        match on_gpu(&gpu, shrink, prepared, camera) {
            Ok(picture) => return Ok(Drawn { picture, device: name, notes }),
            Err(error) if error.kind == Kind::Device => notes.push(format!("{name} failed: {error}")),
            Err(error) => return Err(error),
        }
    }
    notes.push(format!("{name} could not draw the picture: the CPU did"));
    on_cpu(prepared, camera, notes)
}

fn on_gpu(gpu: &Gpu, shrink: usize, prepared: &Prepared<'_>, camera: &Camera) -> Result<Picture> {
    let own = if gpu.adapter.kind == AdapterKind::Software { 1 } else { HARDWARE };
    gpu::prepare(gpu, prepared)?.draw(camera, prepared.settings.band_bytes * own / shrink)
}

fn on_cpu(prepared: &Prepared<'_>, camera: &Camera, notes: Vec<String>) -> Result<Drawn> {
    Ok(Drawn { picture: prepared.draw_alone(camera)?, device: "cpu".to_owned(), notes })
}
