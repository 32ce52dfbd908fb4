//! A coat beside its fur: the file is drawn as a game would, the fur hair by hair.

use crate::asset::coat::read_coat_as;
use crate::bake::picture::PictureRequest;
use crate::coat::summary::summarise;
use crate::error::Result;
use crate::gpu::Choice;
use crate::hybrid::device::Device;
use crate::metrics::compare::LinearImage;
use crate::report::coat::keep::{Cost, Drawing, Keep};
use crate::report::coat::key::Key;
use crate::report::coat::views::Distance;
use crate::report::coat::{Fur, Options, Report, look};
use crate::stage::rig::Rig;
use crate::viewer::sitting::sit;
use std::path::Path;
use std::time::Instant;

/// How a coat is looked at.
pub struct Sight {
    /// Stands for the coat.
    pub coat: Key,
    /// The fur that it stands for.
    pub fur: PictureRequest,
    /// What draws.
    pub device: Device,
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// In which lights.
    pub lights: Vec<Rig>,
    /// From how far, and how often.
    pub distances: Vec<Distance>,
}

/// What was seen, of which fur, and what drew the coat.
pub struct Seen {
    /// Measures of all pictures.
    pub report: Report,
    /// The fur.
    pub fur: Fur,
    /// The adapter.
    pub adapter: String,
}

/// Looks at the coat in `file`.
///
/// # Errors
/// Where the file or the fur cannot be used, there is no adapter, or a picture cannot be kept.
pub fn measure(file: &Path, sight: Sight, keep: &mut Keep, tell: &mut dyn FnMut(&str)) -> Result<Seen> {
    let Sight { coat: coat_key, fur, device, size, lights, distances } = sight;
    let (asset, coat) = read_coat_as(file, &fur.reading)?;
    tell("grow");
    let fur = Fur::new(fur, device.clone(), size)?;
    let choice = match &device {
        Device::Gpu(choice) => choice.clone(),
        Device::Auto | Device::Cpu => Choice::Auto,
    };
    let coat_bytes = summarise(&coat).vram_bytes as u64;
    let (report, adapter) = sit(&asset, &coat, &choice, |sitting| {
        let adapter = sitting.device.clone();
        let options = Options { size, lights, distances, coat: coat_key.with(&adapter), coat_bytes };
        let mut draw = |camera: &_, lit| {
            let start = Instant::now();
            let drawn = sitting.draw(camera, lit, size, None)?;
            let triangles = drawn.passes.iter().map(|pass| pass.triangles).sum();
            let cost = Cost { ms: start.elapsed().as_secs_f64() * 1e3, triangles: Some(triangles) };
            Ok(Drawing { picture: LinearImage::from(&drawn.picture.film()), cost })
        };
        let report = look(&options, &fur, keep, &mut draw, tell)?;
        Ok((report, adapter))
    })?;
    Ok(Seen { report, fur, adapter })
}
