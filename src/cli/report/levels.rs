//! `furrier report levels`.

use super::checked_outputs;
use super::subject::Subject;
use crate::asset::coat::read_coat_as;
use crate::asset::write;
use crate::cli::console::Console;
use crate::cli::output;
use crate::coat::summary::summarise;
use crate::data::camera::Camera;
use crate::error::{Error, Kind, Result};
use crate::metrics::compare::LinearImage;
use crate::metrics::timing::SCHEMA_VERSION;
use crate::report::coat::keep::{Cost, Drawing};
use crate::report::coat::levels::{self, Dolly, Held, Row, Shown};
use crate::report::coat::{Fur, views};
use crate::report::plot::{self, Dot};
use crate::stage::light::Lit;
use crate::stage::png;
use crate::viewer::sitting::{Sitting, sit};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// The dolly's pictures have this part of the others' edges.
const DOLLY_PART: u32 = 2;

/// Look at a coat's levels of detail from near and far beside the fur that they stand for
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier report levels sample:creature -o levels.json --preset fox
  furrier report levels bunny.glb -o bunny.json --preset mink --distances 1,4,16 --dolly 0
  furrier report levels sample:hat -o hat.json --preset mink --size 256x256 --max-flip 0.1

Every level is drawn from every distance in the studio's light and compared with the render that `report coat` makes. Then a camera \
goes out to 16 times the distance, levels chosen as `view` does: how much pictures differ from one to the next beside how much \
renders do. docs/steps/levels.md says what is measured.")]
pub struct Levels {
    #[command(flatten)]
    subject: Subject,
    /// Distances, as factors on that at which the asset just fits, 0.05 to 100
    #[arg(long, value_name = "DISTANCE,…", default_value = "1,2,4,8,16,32,64")]
    distances: String,
    /// Pictures on the way out, of half the size; 0 leaves it out
    #[arg(long, value_name = "N", default_value_t = 96)]
    dolly: usize,
    /// Exit with 1 where the dolly's mean FLIP is over the render's by more than this
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
}

impl Levels {
    /// Bakes, looks, measures and writes.
    ///
    /// # Errors
    /// Where the input or an option cannot be used, there is no adapter, a file cannot be written, or the limit is exceeded.
    pub fn run(self, console: &Console) -> Result<()> {
        crate::cli::compare::check_limit(self.max_flip)?;
        let Self { subject, .. } = &self;
        let [csv, svg, sheet_file] = checked_outputs(&subject.output, &subject.input)?;
        let size = subject.size()?;
        let distances: Vec<f64> = views::parse(&self.distances, 1)?.iter().map(|distance| distance.times).collect();
        let (device, choice) = subject.devices()?;
        let preset = subject.preset()?;
        let mut keep = subject.keep()?;
        let progress = console.progress();
        progress.step("bake");
        let (_, file) = subject.baked(&mut keep, console)?;
        let (asset, coat) = read_coat_as(&file, &subject.reading()?)?;
        progress.step("grow");
        let fur = Fur::new(subject.picture(preset.clone())?, device.clone(), size)?;
        fur.notes().iter().for_each(|note| console.note(note));
        // Levels of several tiles go together: what they hold adds up.
        let tiles = summarise(&coat).tiles;
        let coarsest = tiles.iter().map(|tile| tile.levels.len()).min().unwrap_or(1);
        let held: Vec<Held> = (0..coarsest)
            .map(|level| {
                let of = || tiles.iter().map(|tile| &tile.levels[level]);
                (of().map(|level| level.layers).max().unwrap_or(0), of().map(|level| level.vram_bytes as u64).sum())
            })
            .collect();
        let (rows, dolly, sheet, adapter) = sit(&asset, &coat, &choice, |sitting| {
            let adapter = sitting.device.clone();
            let tell = &mut |what: &str| progress.step(what);
            let mut draw = |camera: &Camera, lit, level| shown(sitting, (camera, lit, size), level);
            let (rows, sheet) = levels::look(&fur, (&held, &distances), &mut keep, &mut draw, tell)?;
            let mut dolly = None;
            if self.dolly > 1 {
                let small = size.map(|n| (n / DOLLY_PART).max(1));
                let mut draw = |camera: &Camera, lit, level| shown(sitting, (camera, lit, small), level);
                let fur = Fur::new(subject.picture(preset)?, device, small)?;
                dolly = Some(levels::dolly(&fur, (self.dolly, small), &mut keep, &mut draw, tell)?);
            }
            Ok((rows, dolly, sheet, adapter))
        })?;
        progress.finish();
        let all = json!({
            "schema_version": SCHEMA_VERSION,
            "input": subject.input,
            "preset": subject.preset,
            "size": size,
            "seed": subject.seed,
            "coat_device": adapter,
            "render_device": subject.device,
            "hair_m": fur.hair_m(),
            "levels": rows,
            "dolly": dolly,
        });
        let title = format!("{}, {}, {} × {}, coat by {adapter}", subject.input, subject.preset, size[0], size[1]);
        let files = [
            (csv, levels::csv(&rows).into_bytes()),
            (svg, drawing(&title, &rows).into_bytes()),
            (sheet_file, png::encode(&sheet)?),
            (subject.output.clone(), output::json_bytes(&subject.output, &all)?),
        ];
        let files: Vec<(PathBuf, &[u8])> = files.iter().map(|(path, bytes)| (path.clone(), bytes.as_slice())).collect();
        write::all(&files, &[PathBuf::from(&subject.input)])?;
        console.result(&all, |out| print(&rows, dolly.as_ref(), out))?;
        let excess = dolly.as_ref().map(Dolly::excess);
        match self.max_flip.zip(excess) {
            Some((limit, excess)) if excess > limit => {
                Err(Error::new(Kind::Difference, "the way from level to level shows by more than the limit")
                    .with_file(&subject.output)
                    .with_field("mean of dolly.coat less that of dolly.fur")
                    .with_found(format!("{excess:.4}"))
                    .with_expected(format!("at most {limit}")))
            }
            _ => Ok(()),
        }
    }
}

/// One picture of a level, and what it cost.
fn shown(
    sitting: &mut Sitting<'_>,
    (camera, lit, size): (&Camera, Lit, [u32; 2]),
    level: Option<usize>,
) -> Result<Shown> {
    let start = Instant::now();
    let drawn = sitting.draw(camera, lit.clone(), size, level)?;
    let ms = start.elapsed().as_secs_f64() * 1e3;
    let reads = if level.is_some() { sitting.reads(camera, lit, &drawn.picture, level)? } else { 0.0 };
    let triangles = drawn.passes.iter().map(|pass| pass.triangles).sum();
    let cost = Cost { ms, triangles: Some(triangles) };
    let drawing = Drawing { picture: LinearImage::from(&drawn.picture.film()), cost };
    Ok(Shown { drawing, height_px: drawn.height_px, reads })
}

/// Error against cost: a group per level, and the floor of each distance.
fn drawing(title: &str, rows: &[Row]) -> String {
    let dot = |row: &Row| Dot {
        label: format!("level {}, distance {}: {:.0} ms, FLIP {:.4}", row.level, row.distance, row.view_ms, row.flip),
        group: format!("level {}", row.level),
        open: false,
        name: None,
        ms: row.view_ms,
        error: row.flip,
        pareto: false,
    };
    let dots: Vec<Dot> = rows.iter().map(dot).collect();
    plot::draw([title, "FLIP against fur drawn hair by hair"], &dots, &["one dot per distance"])
}

fn print(rows: &[Row], dolly: Option<&Dolly>, out: &mut dyn std::io::Write) -> std::io::Result<()> {
    writeln!(out, "distance  hair px  level  layers     FLIP    floor  to finer     bias coverage   reads      ms")?;
    for row in rows {
        let to_finer = row.flip_to_finer.map_or("        -".to_owned(), |flip| format!("{flip:9.4}"));
        writeln!(
            out,
            "{:8} {:8.1} {:6} {:7} {:8.4} {:8.4} {to_finer} {:+7.2}% {:+8.2} {:7.1} {:7.0}",
            row.distance,
            row.height_px,
            row.level,
            row.layers,
            row.flip,
            row.floor_flip,
            row.bias * 100.0,
            row.coverage,
            row.reads_per_covered_pixel,
            row.view_ms
        )?;
    }
    if let Some(dolly) = dolly {
        let frames = dolly.coat.len() + 1;
        writeln!(
            out,
            "from picture to picture of {frames} on the way out: FLIP over the render's {:+.4}",
            dolly.excess()
        )?;
    }
    Ok(())
}
