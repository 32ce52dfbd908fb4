//! `furrier view`.

use super::console::Console;
use super::output;
use crate::asset;
use crate::data::camera::Camera;
use crate::error::{Error, Result};
use crate::gpu::Choice;
use crate::viewer::{self, Background, Framing, Options};
use clap::Args;
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
  furrier view furry.glb --screenshot fins.png --show skin,fins --light dir:0,-1,-1:3,3,3 --ambient 0.2,0.2,0.2

A camera file is JSON: {\"eye\": [x, y, z], \"target\": [x, y, z], \"up\": [x, y, z], \"vfov_deg\": 40}, in metres; the last
two may be left out. Any graphics adapter will do, software ones too.")]
pub struct View {
    /// A file that furrier baked
    file: PathBuf,
    /// The picture to write
    #[arg(long, value_name = "OUT.png")]
    screenshot: PathBuf,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    size: String,
    /// What to draw: parts of the coat, or how it lies: the hair's direction and length, the patches of its texture, or
    /// their stretch
    #[arg(long, value_name = "skin,shells,fins|field|patches|stretch", default_value = "skin,shells,fins")]
    show: String,
    /// Degrees around and above, and a factor on the distance at which the asset just fits [default: 35,12,1]
    #[arg(long, value_name = "AZ,EL,DIST", allow_hyphen_values = true, conflicts_with = "camera")]
    orbit: Option<String>,
    /// A camera file
    #[arg(long, value_name = "FILE.json")]
    camera: Option<PathBuf>,
    /// A light: the direction it travels, its irradiance in linear RGB; repeatable. Default: a small studio
    #[arg(long = "light", value_name = "dir:X,Y,Z:R,G,B")]
    lights: Vec<String>,
    /// Light from everywhere, radiance in linear RGB
    #[arg(long, value_name = "R,G,B")]
    ambient: Option<String>,
    /// Play this animation, by name or number
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// Seconds into the animation [default: 0]
    #[arg(long, value_name = "S", requires = "animation", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Draw a contact sheet of N views around the asset, 1 to 64; --size is that of one
    #[arg(long, value_name = "N")]
    turntable: Option<u32>,
    /// Leave out what is behind the asset: the picture keeps its alpha
    #[arg(long)]
    transparent: bool,
    /// The adapter to draw with
    #[arg(long, value_name = "auto|gpu[:NAME]", default_value = "auto")]
    device: String,
    /// Write times, sizes and counts to this JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

impl View {
    /// Draws, and says what it drew with.
    ///
    /// # Errors
    /// As [`viewer::screenshot`], and where an option cannot be read or a file not written.
    pub fn run(self, console: &Console) -> Result<()> {
        let options = self.options()?;
        output::check(&self.screenshot, &[&self.file])?;
        if let Some(report) = &self.report {
            output::check(report, &[&self.file, &self.screenshot])?;
        }
        let (asset, coat) = asset::coat::read_coat(&self.file)?;
        let shot = match self.turntable {
            Some(views) => viewer::turntable(&asset, &coat, &options, views)?,
            None => viewer::screenshot(&asset, &coat, &options)?,
        };
        output::png(&self.screenshot, &shot.image)?;
        if let Some(report) = &self.report {
            output::json(report, &shot.report)?;
        }
        let device = &shot.report.device;
        let (width, height) = (shot.image.width, shot.image.height);
        shot.legend.iter().for_each(|line| console.note(line));
        let outcome = json!({
            "screenshot": self.screenshot,
            "size": [width, height],
            "legend": shot.legend,
            "report": shot.report,
        });
        console.result(&outcome, |out| {
            writeln!(out, "{}: {width} × {height}, drawn by {device}", self.screenshot.display())
        })
    }

    fn options(&self) -> Result<Options> {
        let framing = match (&self.camera, &self.orbit) {
            (Some(file), _) => Framing::Camera(read_camera(file)?),
            (None, Some(orbit)) => Framing::Orbit(orbit.parse()?),
            (None, None) => Framing::default(),
        };
        Ok(Options {
            device: self.device.parse::<Choice>()?,
            size: size(&self.size)?,
            framing,
            lights: self.lights.iter().map(|light| viewer::parse_light(light)).collect::<Result<_>>()?,
            ambient: self.ambient.as_deref().map(|rgb| viewer::parse_triple(rgb, "--ambient")).transpose()?,
            show: viewer::parse_show(&self.show)?,
            moment: self.animation.clone().map(|name| (name, self.time.unwrap_or(0.0))),
            background: if self.transparent { Background::Transparent } else { Background::Backdrop },
            ..Options::default()
        })
    }
}

/// Reads a camera file.
pub(super) fn read_camera(file: &Path) -> Result<Camera> {
    let text = std::fs::read_to_string(file)
        .map_err(|e| Error::input("the camera file cannot be read").with_file(file).with_found(e))?;
    Camera::from_json(&text).map_err(|e| e.with_file(file))
}

/// Reads `WxH`.
pub(super) fn size(text: &str) -> Result<[u32; 2]> {
    let pair = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    pair.filter(|pair| pair.iter().all(|n| (1..=16_384).contains(n))).ok_or_else(|| {
        Error::usage("the size cannot be read")
            .with_field("--size")
            .with_found(text)
            .with_expected("WxH, each from 1 to 16384")
            .with_hint("`--size 1920x1080`, for instance")
    })
}
