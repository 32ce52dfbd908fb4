//! `furrier report coat`.

use super::checked_outputs;
use super::measure::{Seen, Sight, measure};
use super::subject::Subject;
use crate::asset::write;
use crate::cli::compare::check_limit;
use crate::cli::console::Console;
use crate::cli::output;
use crate::error::{Error, Kind, Result};
use crate::metrics::timing::SCHEMA_VERSION;
use crate::report::coat::summary::Group;
use crate::report::coat::{Fur, Report, table, views};
use crate::stage::png;
use crate::stage::rig::Rig;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Look at a coat from many sides beside the fur that it stands for
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier report coat sample:hat -o hat.json --preset mink --views 4 --distances 1,4
  furrier report coat bunny.glb -o bunny.json --distances 1:8,0.35:2,2:2,4:2,8:2 --lights studio,rim
  furrier report coat sample:torus -o torus.json --preset sheep --size 256x256 --max-flip 0.05

The coat is baked and drawn as `view` draws it, the fur as `render --quality final` does, in one light and through one camera. \
Beside hat.json stand hat.csv, hat.svg and hat.png: per light and distance three rows, render, coat and FLIP, a column per view. \
hat.parts/ keeps finished pictures: a report that was stopped goes on where it was, and a render is drawn again only where what it \
shows has changed. docs/steps/report-coat.md says what is measured.")]
pub struct Coat {
    #[command(flatten)]
    subject: Subject,
    /// Views around the asset at each distance, 1 to 64
    #[arg(long, value_name = "N", default_value_t = 8)]
    views: usize,
    /// Distances, as factors on that at which the asset just fits, 0.05 to 100; each may have a number of views of its own
    #[arg(long, value_name = "DISTANCE[:VIEWS],…", default_value = "1,2,4,8")]
    distances: String,
    /// Lights: from the eye; from the left; from behind; from everywhere; or three lights and what comes from everywhere
    #[arg(long, value_name = "front,side,rim,sky,studio", default_value = "studio,front")]
    lights: String,
    /// Exit with 1 where the mean FLIP is over the floor by more than this
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
}

impl Coat {
    /// Bakes, looks, measures and writes.
    ///
    /// # Errors
    /// Where the input or an option cannot be used, there is no adapter, a file cannot be written, or the limit is exceeded.
    pub fn run(self, console: &Console) -> Result<()> {
        check_limit(self.max_flip)?;
        let [csv, svg, png_file] = checked_outputs(&self.subject.output, &self.subject.input)?;
        let size = self.subject.size()?;
        let distances = views::parse(&self.distances, self.views)?;
        let lights = lights(&self.lights)?;
        let (device, _) = self.subject.devices()?;
        let preset = self.subject.preset()?;
        let mut keep = self.subject.keep()?;
        let progress = console.progress();
        progress.step("bake");
        let (coat_key, file) = self.subject.baked(&mut keep, console)?;
        let sight = Sight { coat: coat_key, fur: self.subject.picture(preset)?, device, size, lights, distances };
        let seen = measure(&file, sight, &mut keep, &mut |what| progress.step(what))?;
        let Seen { report, fur, adapter } = seen;
        progress.finish();
        fur.notes().iter().for_each(|note| console.note(note));
        report.notes.iter().for_each(|note| console.warning(note));
        let all = self.json(&report, &fur, size, &adapter);
        let title =
            format!("{}, {}, {} × {}, coat by {adapter}", self.subject.input, self.subject.preset, size[0], size[1]);
        let files = [
            (csv, table::csv(&report.pictures).into_bytes()),
            (svg, report.plot(&title).into_bytes()),
            (png_file, png::encode(&report.sheet)?),
            (self.subject.output.clone(), output::json_bytes(&self.subject.output, &all)?),
        ];
        let files: Vec<(PathBuf, &[u8])> = files.iter().map(|(path, bytes)| (path.clone(), bytes.as_slice())).collect();
        write::all(&files, &[PathBuf::from(&self.subject.input)])?;
        console.result(&all, |out| self.print(&report, out))?;
        let excess = report.summary.excess.flip;
        match self.max_flip {
            Some(limit) if excess > limit => {
                Err(Error::new(Kind::Difference, "the coat is off by more than the limit")
                    .with_file(&self.subject.output)
                    .with_field("summary.excess.flip")
                    .with_found(format!("{excess:.4}"))
                    .with_expected(format!("at most {limit}")))
            }
            _ => Ok(()),
        }
    }

    fn json(&self, report: &Report, fur: &Fur, size: [u32; 2], adapter: &str) -> Value {
        json!({
            "schema_version": SCHEMA_VERSION,
            "input": self.subject.input,
            "preset": self.subject.preset,
            "size": size,
            "seed": self.subject.seed,
            "coat_device": adapter,
            "render_device": self.subject.device,
            "hair_m": fur.hair_m(),
            "drawn": report.drawn,
            "pictures": report.pictures.iter().map(|picture| picture.value()).collect::<Vec<_>>(),
            "summary": report.summary,
        })
    }

    fn print(&self, report: &Report, out: &mut dyn std::io::Write) -> std::io::Result<()> {
        writeln!(out, "light   distance     FLIP    floor   fringe     bias coverage  views")?;
        for Group { light, distance, pictures, mean, excess } in &report.summary.by_light_and_distance {
            let (flip, floor, fringe) = (mean.flip, mean.flip - excess.flip, mean.fringe_flip.unwrap_or(f64::NAN));
            let (bias, coverage) = (mean.bias * 100.0, mean.coverage);
            writeln!(
                out,
                "{light:<7} {distance:8} {flip:8.4} {floor:8.4} {fringe:8.4} {bias:+7.2}% {coverage:+8.2} {pictures:6}"
            )?;
        }
        let excess = report.summary.excess.flip;
        writeln!(out, "FLIP over the floor: {excess:.4}; {}", self.subject.output.display())
    }
}

/// Reads lights with commas between, each once.
fn lights(text: &str) -> Result<Vec<Rig>> {
    let mut all: Vec<Rig> = Vec::new();
    for name in text.split(',') {
        let rig = name.parse()?;
        if all.contains(&rig) {
            return Err(Error::usage("lights are asked for twice").with_field("--lights").with_found(name));
        }
        all.push(rig);
    }
    Ok(all)
}
