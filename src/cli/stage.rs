//! The flags of every command that takes a picture: camera, light, development.

use crate::data::camera::Camera;
use crate::error::{Error, Result};
use crate::stage::background::Background;
use crate::stage::camera::{Orbit, Viewpoint};
use crate::stage::environment::Environment;
use crate::stage::light::{parse, parse_triple};
use crate::stage::options::Options;
use crate::stage::tone::{Development, Tone};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// What these flags stand under in the help.
const HEADING: &str = "Camera and light";

/// What a picture is taken with; the same for all commands.
#[derive(Debug, Args)]
pub struct StageArgs {
    /// Pixels
    #[arg(long, help_heading = HEADING, value_name = "WxH", default_value = "1024x1024")]
    size: String,
    /// Degrees around and above, and a factor on the distance at which the asset just fits in its rest pose
    /// [default: 35,12,1]
    #[arg(long, help_heading = HEADING, value_name = "AZ,EL,DIST", allow_hyphen_values = true, conflicts_with = "camera")]
    orbit: Option<String>,
    /// A camera file, or a camera of the asset by its node's name or its own; a nameless one is camera_0, camera_1, …
    #[arg(long, help_heading = HEADING, value_name = "FILE.json|NAME")]
    camera: Option<String>,
    /// A light, in metres and linear RGB, repeatable: the direction it travels and its irradiance; its place and its intensity;
    /// its place, direction, the angle from there to its cone's edge, and its intensity; or a light of the asset by name, whose
    /// lux is taken as irradiance and candela as intensity. The first is the key. Default: a small studio
    #[arg(long = "light", help_heading = HEADING, value_name = "dir:X,Y,Z:R,G,B|point:X,Y,Z:R,G,B|spot:X,Y,Z:DX,DY,DZ:DEG:R,G,B|NAME")]
    lights: Vec<String>,
    /// Light from everywhere, radiance in linear RGB [default: the studio's; none with --light or --env]
    #[arg(long, help_heading = HEADING, value_name = "R,G,B")]
    ambient: Option<String>,
    /// A map of surrounding light: directional lights stand for it, 16 in all with those of --light
    #[arg(long, help_heading = HEADING, value_name = "FILE.hdr|exr")]
    env: Option<PathBuf>,
    /// Stops of exposure, for a picture of eight bits
    #[arg(long, help_heading = HEADING, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true)]
    exposure: f32,
    /// What becomes of light too bright for a picture of eight bits: rolled off (Khronos PBR Neutral), or cut off
    #[arg(long, help_heading = HEADING, value_enum, default_value = "neutral")]
    tone: ToneName,
    /// What is behind the asset in a picture of eight bits: a grey wall, or one colour in linear RGB
    #[arg(long, help_heading = HEADING, value_name = "backdrop|R,G,B", default_value = "backdrop", conflicts_with = "transparent")]
    background: String,
    /// Leave out what is behind the asset: the picture keeps its alpha, as an .exr does in any case
    #[arg(long, help_heading = HEADING)]
    transparent: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ToneName {
    Neutral,
    None,
}

impl StageArgs {
    /// What was asked for.
    ///
    /// # Errors
    /// Names the flag that cannot be read, or the file.
    pub fn options(&self) -> Result<Options> {
        let viewpoint = match (&self.camera, &self.orbit) {
            (Some(camera), _) => viewpoint(camera)?,
            (None, Some(orbit)) => Viewpoint::Orbit(orbit.parse()?),
            (None, None) => Viewpoint::Orbit(Orbit::default()),
        };
        if !self.exposure.is_finite() || self.exposure.abs() > 64.0 {
            return Err(Error::usage("there is no such exposure")
                .with_field("--exposure")
                .with_found(self.exposure)
                .with_expected("-64 to 64 stops"));
        }
        let background = if self.transparent { Background::Transparent } else { self.background.parse()? };
        let tone = match self.tone {
            ToneName::Neutral => Tone::Neutral,
            ToneName::None => Tone::None,
        };
        Ok(Options {
            size: size(&self.size)?,
            viewpoint,
            lights: self.lights.iter().map(|light| parse(light)).collect::<Result<_>>()?,
            ambient: self.ambient.as_deref().map(|rgb| parse_triple(rgb, "ambient")).transpose()?,
            environment: self.env.as_deref().map(Environment::read).transpose()?,
            environment_on_undercoat: false,
            development: Development { exposure_ev: self.exposure, tone, background },
        })
    }
}

/// What ends in .json or is there is a file; all else is a name.
fn viewpoint(text: &str) -> Result<Viewpoint> {
    let file = Path::new(text);
    if !file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) && !file.is_file() {
        return Ok(Viewpoint::Named(text.to_owned()));
    }
    let text = std::fs::read_to_string(file)
        .map_err(|e| Error::input("the camera file cannot be read").with_file(file).with_found(e))?;
    Camera::from_json(&text).map(Viewpoint::Camera).map_err(|e| e.with_file(file))
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
