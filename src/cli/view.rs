//! `furrier view`.

use super::axes::AxesArgs;
use super::console::Console;
use super::output;
use super::stage::StageArgs;
use crate::asset;
use crate::error::Result;
use crate::gpu::Choice;
use crate::runtime::Blending;
use crate::stage::file::Format;
use crate::viewer::{self, ViewOptions};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Draw a furry asset as a game would, into a picture
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier view furry.glb --screenshot furry.png
  furrier view furry.glb --screenshot walk.png --animation Walk --time 0.4 --orbit 70,10,0.8
  furrier view furry.glb --screenshot around.png --turntable 8 --size 256x256
  furrier view furry.glb --screenshot stretch.png --show stretch
  furrier view mat.glb --screenshot box.png --occluder box.obj --light dir:-1,-2,0:3,3,3
  furrier view furry.glb --screenshot fins.png --show skin,fins --light dir:0,-1,-1:3,3,3 --ambient 0.2,0.2,0.2

A camera file is JSON: {\"eye\": [x, y, z], \"target\": [x, y, z], \"up\": [x, y, z], \"vfov_deg\": 40}, in metres; the last
two may be left out. An .exr is linear and premultiplied, with the distance to the nearest skin or near shell (Z). Any graphics adapter will do, software ones too.")]
pub struct View {
    /// A file that furrier baked
    file: PathBuf,
    /// The picture to write: .png or .exr
    #[arg(long, value_name = "OUT.png|exr")]
    screenshot: PathBuf,
    /// What to draw: parts of the coat; or how it lies: the hair's direction and length, the patches of its texture, or
    /// their stretch; or where skin is bald that should not be; or how many texels each pixel reads
    #[arg(long, value_name = "skin,shells,fins|field|patches|stretch|bald|cost", default_value = "skin,shells,fins")]
    show: String,
    #[command(flatten)]
    stage: StageArgs,
    #[command(flatten)]
    axes: AxesArgs,
    /// A mesh to lay beside or into the fur, in the asset's units and axes: grey and opaque, it hides what it covers and casts
    /// its shadow; the camera is framed without it
    #[arg(long, value_name = "FILE|sample:NAME")]
    occluder: Option<String>,
    /// Leave out the shadow that the key light casts from limb to limb, and from the occluder
    #[arg(long)]
    no_shadow: bool,
    /// Draw this level of detail: 0 is the finest [default: by the height of hair in the picture]
    #[arg(long, value_name = "N")]
    level: Option<usize>,
    /// How half-transparent hair comes together in a pixel: from front to back; in any order, by weights; or there or not by
    /// chance, a grainy picture of those that a game averages over time
    #[arg(long, value_enum, default_value_t)]
    blend: BlendBy,
    /// Play this animation, by name or number
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// Seconds into the animation [default: 0]
    #[arg(long, value_name = "S", requires = "animation", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Draw a contact sheet of N views around the asset, 1 to 64; --size is that of one
    #[arg(long, value_name = "N")]
    turntable: Option<u32>,
    /// The adapter to draw with
    #[arg(long, value_name = "auto|gpu[:NAME]", default_value = "auto")]
    device: String,
    /// Write times, sizes and counts to this JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

/// As [`Blending`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum BlendBy {
    #[default]
    Sorted,
    Weighted,
    Hashed,
}

impl From<BlendBy> for Blending {
    fn from(by: BlendBy) -> Self {
        match by {
            BlendBy::Sorted => Self::Sorted,
            BlendBy::Weighted => Self::Weighted,
            BlendBy::Hashed => Self::Hashed,
        }
    }
}

impl View {
    /// Draws, and says what it drew with.
    ///
    /// # Errors
    /// As [`viewer::screenshot`], and where an option cannot be read or a file not written.
    pub fn run(self, console: &Console) -> Result<()> {
        let format = Format::of(&self.screenshot, "--screenshot")?;
        let options =
            ViewOptions { depths: matches!(format, Format::Exr), count: self.report.is_some(), ..self.options()? };
        options.occluder.iter().flat_map(|thing| &thing.warnings).for_each(|line| console.warning(line));
        let occluder = self.occluder.as_ref().map(Path::new);
        let read: Vec<&Path> = [Some(self.file.as_path()), occluder].into_iter().flatten().collect();
        output::check(&self.screenshot, &read)?;
        if let Some(report) = &self.report {
            output::check(report, &[&read[..], &[&self.screenshot]].concat())?;
        }
        let (asset, coat) = asset::coat::read_coat_as(&self.file, &self.axes.reading()?)?;
        let shot = match self.turntable {
            Some(views) => viewer::turntable(&asset, &coat, &options, views)?,
            None => viewer::screenshot(&asset, &coat, &options)?,
        };
        output::bytes(&self.screenshot, &shot.encode(format)?)?;
        if let Some(report) = &self.report {
            output::json(report, &shot.report)?;
        }
        let device = &shot.report.device;
        let (width, height) = (shot.image.width, shot.image.height);
        shot.legend.iter().chain(&shot.notes).for_each(|line| console.note(line));
        let outcome = json!({
            "screenshot": self.screenshot,
            "size": [width, height],
            "legend": shot.legend,
            "notes": shot.notes,
            "report": shot.report,
        });
        console.result(&outcome, |out| {
            writeln!(out, "{}: {width} × {height}, drawn by {device}", self.screenshot.display())
        })
    }

    fn options(&self) -> Result<ViewOptions> {
        let reading = self.axes.reading()?;
        Ok(ViewOptions {
            device: self.device.parse::<Choice>()?,
            stage: self.stage.options()?,
            show: viewer::parse_show(&self.show)?,
            moment: self.animation.clone().map(|name| (name, self.time.unwrap_or(0.0))),
            level: self.level,
            blend: self.blend.into(),
            shadow_map: !self.no_shadow,
            occluder: self.occluder.as_deref().map(|file| asset::load_as(file, &reading)).transpose()?,
            ..ViewOptions::default()
        })
    }
}
