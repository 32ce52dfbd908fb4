//! `furrier view`.

use super::cache_flags::CacheFlags;
use super::console::Console;
use super::output;
use super::recipe::RecipeArgs;
use super::stage::StageArgs;
use crate::asset::{self, Asset};
use crate::bake::seen::seen;
use crate::data::coat::Coat;
use crate::error::{Error, Result};
use crate::gpu::Choice;
use crate::runtime::Blending;
use crate::stage::file::Format;
use crate::viewer::{self, Combing, ViewOptions};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Show a furry asset as a game would, in a window or into a picture
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier view furry.glb
  furrier view cat.glb --preset short-cat
  furrier view furry.glb --screenshot furry.png
  furrier view furry.glb --screenshot walk.png --animation Walk --time 0.4 --orbit 70,10,0.8
  furrier view furry.glb --screenshot around.png --turntable 8 --size 256x256
  furrier view furry.glb --screenshot walk.png --animation Walk --frames 48 --size 512x512
  furrier view furry.glb --screenshot stretch.png --show stretch
  furrier view mat.glb --screenshot box.png --occluder box.obj --light dir:-1,-2,0:3,3,3
  furrier view furry.glb --screenshot fins.png --show skin,fins --light dir:0,-1,-1:3,3,3 --ambient 0.2,0.2,0.2

Without --screenshot a window opens; ? lists its keys, docs/window.md tells the rest. A script drives it: one action a line.

A camera file is JSON: {\"eye\": [x, y, z], \"target\": [x, y, z], \"up\": [x, y, z], \"vfov_deg\": 40}, in metres; the last
two may be left out. An .exr is linear and premultiplied, with the distance to the nearest skin or near shell (Z). Any graphics adapter will do, software ones too.")]
pub struct View {
    /// A file that furrier baked; or, with --preset or --set, a mesh to bake first; or sample:NAME
    file: String,
    /// Write a picture, .png or .exr, instead of opening a window
    #[arg(long, value_name = "OUT.png|exr")]
    screenshot: Option<PathBuf>,
    /// Drive the window by this file, one action a line (docs/window.md)
    #[arg(long, value_name = "FILE", conflicts_with = "screenshot")]
    script: Option<PathBuf>,
    /// What to draw: parts of the coat; or how it lies: the hair's direction and length as signs or as colours, the patches of
    /// its texture, or their stretch; or how much of what is behind it hair hides, or how much light it lets down to the skin;
    /// or where skin is bald that should not be; or which level of detail is drawn, or the mesh over the picture; or how many
    /// texels each pixel reads
    #[arg(
        long,
        value_name = "skin,shells,fins|field|tangents|patches|stretch|opacity|transmittance|bald|levels|wireframe|cost",
        default_value = "skin,shells,fins"
    )]
    show: String,
    #[command(flatten)]
    stage: StageArgs,
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
    /// Make all hair so many times as long, 0.1 to 4, without baking it anew
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    lengthen: f32,
    /// Make all hair lean so much more the way it leans, -75 to 75 degrees, without baking it anew
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    slant: f32,
    /// Play this animation, by name or number
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// Seconds into the animation [default: 0]
    #[arg(long, value_name = "S", requires = "animation", allow_hyphen_values = true)]
    time: Option<f64>,
    /// Draw a contact sheet of N views around the asset, 1 to 64; --size is that of one
    #[arg(long, value_name = "N", requires = "screenshot")]
    turntable: Option<u32>,
    /// Draw N pictures, 1 to 9999, as OUT.0001.png and so on: over the length of the animation, or, without one or in the pose
    /// that --time says, around the asset
    #[arg(long, value_name = "N", requires = "screenshot", conflicts_with = "turntable")]
    frames: Option<u32>,
    /// The adapter to draw with
    #[arg(long, value_name = "auto|gpu[:NAME]", default_value = "auto")]
    device: String,
    /// Write times, sizes and counts to this JSON file
    #[arg(long, value_name = "FILE.json", requires = "screenshot")]
    report: Option<PathBuf>,
    #[command(flatten, next_help_heading = "Baking")]
    recipe: RecipeArgs,
    #[command(flatten, next_help_heading = "Baking")]
    cache: CacheFlags,
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
    /// Opens the window, or draws and says what it drew with.
    ///
    /// # Errors
    /// As [`viewer::screenshot`], and where an option cannot be read, a file not written or a window not opened.
    pub fn run(self, console: &Console) -> Result<()> {
        match self.screenshot.clone() {
            Some(screenshot) => self.shoot(&screenshot, console),
            None => self.open(),
        }
    }

    fn shoot(self, screenshot: &Path, console: &Console) -> Result<()> {
        let format = Format::of(screenshot, "--screenshot")?;
        let options =
            ViewOptions { depths: matches!(format, Format::Exr), count: self.report.is_some(), ..self.options()? };
        options.occluder.iter().flat_map(|thing| &thing.warnings).for_each(|line| console.warning(line));
        let occluder = self.occluder.as_ref().map(Path::new);
        let read: Vec<&Path> = [Some(Path::new(&self.file)), occluder].into_iter().flatten().collect();
        output::check(screenshot, &read)?;
        if let Some(report) = &self.report {
            output::check(report, &[&read[..], &[screenshot]].concat())?;
        }
        if let Some(frames) = self.frames {
            return self.film(frames, (screenshot, format), &options, &read, console);
        }
        let (asset, coat) = self.subject(console)?;
        let shot = match self.turntable {
            Some(views) => viewer::turntable(&asset, &coat, &options, views)?,
            None => viewer::screenshot(&asset, &coat, &options)?,
        };
        output::bytes(screenshot, &shot.encode(format)?)?;
        if let Some(report) = &self.report {
            output::json(report, &shot.report)?;
        }
        let device = &shot.report.device;
        let (width, height) = (shot.image.width, shot.image.height);
        shot.legend.iter().chain(&shot.notes).for_each(|line| console.note(line));
        let outcome = json!({
            "screenshot": screenshot,
            "size": [width, height],
            "legend": shot.legend,
            "notes": shot.notes,
            "report": shot.report,
        });
        console.result(&outcome, |out| writeln!(out, "{}: {width} × {height}, drawn by {device}", screenshot.display()))
    }

    /// Draws pictures one after another, each a file of its own.
    fn film(
        &self,
        frames: u32,
        (screenshot, format): (&Path, Format),
        options: &ViewOptions,
        read: &[&Path],
        console: &Console,
    ) -> Result<()> {
        let numbered = |i: u32| {
            let extension = screenshot.extension().unwrap_or_default().to_string_lossy();
            screenshot.with_extension(format!("{i:04}.{extension}"))
        };
        (1..=frames).try_for_each(|i| output::check(&numbered(i), read).map(drop))?;
        let (asset, coat) = self.subject(console)?;
        let mut i = 0;
        let told = viewer::sequence(&asset, &coat, options, (frames, self.time.is_some()), &mut |picture, image| {
            i += 1;
            output::bytes(&numbered(i), &viewer::encode(picture, image, format)?).map(drop)
        })?;
        let (legend, notes, report) = (told.legend, told.notes, told.recorder.finish());
        if let Some(file) = &self.report {
            output::json(file, &report)?;
        }
        legend.iter().chain(&notes).for_each(|line| console.note(line));
        let (first, last) = (numbered(1), numbered(frames));
        let outcome = json!({ "frames": frames, "first": first, "last": last, "legend": legend, "notes": notes, "report": report });
        console.result(&outcome, |out| {
            writeln!(out, "{} to {}: {frames} pictures, drawn by {}", first.display(), last.display(), report.device)
        })
    }

    /// Whether the input is baked first.
    fn bakes(&self) -> bool {
        self.recipe.chosen() || self.file.starts_with("sample:")
    }

    /// What is looked at: read, or baked first.
    fn subject(&self, console: &Console) -> Result<(Asset, Coat)> {
        let reading = self.recipe.reading()?;
        if !self.bakes() {
            return asset::coat::read_coat_as(Path::new(&self.file), &reading);
        }
        let recipe = self.recipe.choices().recipe()?;
        let progress = console.progress();
        let seen = seen(&recipe, (&self.file, None), &reading, self.cache.store(), &mut |step| progress.step(step));
        progress.finish();
        let (asset, coat, baked) = seen?;
        baked.notes.iter().for_each(|note| console.note(note));
        baked.warnings.iter().for_each(|warning| console.warning(warning));
        Ok((asset, coat))
    }

    /// Opens the window.
    #[cfg(feature = "window")]
    fn open(self) -> Result<()> {
        use super::spoken;
        use crate::error::Kind;
        use crate::window::{self, Begin, loading, script::Script};
        if self.occluder.is_some() {
            return Err(Error::usage("the window shows the asset alone")
                .with_parameter("occluder")
                .with_hint("`--screenshot OUT.png` shows things beside it"));
        }
        let ViewOptions { device, stage, show, moment, shadow_map, level, blend, combing, .. } = self.options()?;
        let subject = loading::Subject {
            input: self.file.clone(),
            reading: self.recipe.reading()?,
            choices: self.bakes().then(|| self.recipe.choices()),
            cache: self.cache.store(),
        };
        let script = self.script.as_deref().map(Script::read).transpose()?.unwrap_or_default();
        window::open(Begin {
            subject,
            stage,
            shown: show,
            level,
            combing,
            blend,
            moment,
            shadow: shadow_map,
            device,
            in_words: spoken::bake,
            script,
        })
        .map_err(|error| {
            // Who has no adapter has none for pictures either.
            if crate::gpu::adapters().is_empty() {
                return error;
            }
            let instead = "write a picture, which needs no window: `--screenshot OUT.png`";
            match (error.kind, error.hint.clone()) {
                (Kind::Device, Some(hint)) => error.with_hint(format!("{hint}; or {instead}")),
                (Kind::Device, None) => error.with_hint(instead),
                _ => error,
            }
        })
    }

    /// Says that there is no window.
    #[cfg(not(feature = "window"))]
    fn open(self) -> Result<()> {
        Err(Error::usage("this furrier was built without its window").with_parameter("screenshot").with_hint(
            "`--screenshot OUT.png` writes a picture; the cargo feature `window`, on by default, brings the window",
        ))
    }

    fn options(&self) -> Result<ViewOptions> {
        let reading = self.recipe.reading()?;
        Ok(ViewOptions {
            device: self.device.parse::<Choice>()?,
            stage: self.stage.options()?,
            show: viewer::parse_show(&self.show)?,
            moment: self.animation.clone().map(|name| (name, self.time.unwrap_or(0.0))),
            level: self.level,
            blend: self.blend.into(),
            combing: Combing::new(self.lengthen, self.slant)?,
            shadow_map: !self.no_shadow,
            occluder: self.occluder.as_deref().map(|file| asset::load_as(file, &reading)).transpose()?,
            ..ViewOptions::default()
        })
    }
}
