//! `furrier inspect`.

use super::console::Console;
use crate::asset;
use crate::coat::measures::{Measures, Range};
use crate::coat::summary::{SCREEN, Summary, summarise};
use crate::error::Result;
use clap::Args;
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Instant;

/// Say what the coat of a file holds and costs
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier inspect furry.glb
  furrier inspect furry.glb --json | jq .coat.vram_bytes")]
pub struct Inspect {
    /// A file that furrier baked
    file: PathBuf,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Inspection {
    file: PathBuf,
    /// Material of each coat primitive, in their order.
    materials: Vec<String>,
    coat: Summary,
    /// How well each coat primitive lies on its skin, in their order.
    measures: Vec<Measures>,
    /// How long measuring took, ms.
    measured_in_ms: f64,
}

impl Inspect {
    /// Prints what the coat holds.
    ///
    /// # Errors
    /// Where the file cannot be read or has no coat.
    pub fn run(self, console: &Console) -> Result<()> {
        let (asset, coat) = asset::coat::read_coat(&self.file)?;
        let material = |mesh, primitive| {
            let part = asset.parts.iter().find(|part| (part.mesh, part.primitive) == (mesh, primitive));
            part.map_or_else(String::new, |part| part.material_name.clone())
        };
        let materials = coat.primitives.iter().map(|primitive| material(primitive.mesh, primitive.primitive)).collect();
        let start = Instant::now();
        let measures = Measures::all(&asset, &coat)?;
        let measured_in_ms = start.elapsed().as_secs_f64() * 1e3;
        let inspection = Inspection { file: self.file, materials, coat: summarise(&coat), measures, measured_in_ms };
        console.result(&inspection, |out| print(&inspection, out))
    }
}

fn print(inspection: &Inspection, out: &mut dyn Write) -> io::Result<()> {
    let coat = &inspection.coat;
    writeln!(out, "{}", inspection.file.display())?;
    for (i, (primitive, material)) in coat.primitives.iter().zip(&inspection.materials).enumerate() {
        let into = primitive.into_tile.map_or_else(String::new, |tile| format!(" passing into {tile}"));
        writeln!(
            out,
            "  {material}: {} triangles, {} coat vertices, {} patches, {} fins, tile {}{into}",
            primitive.triangles, primitive.vertices, primitive.patches, primitive.fins, primitive.tile
        )?;
        if let Some(measures) = inspection.measures.get(i) {
            lies(measures, out)?;
        }
    }
    for (i, tile) in coat.tiles.iter().enumerate() {
        writeln!(
            out,
            "  {} {i} ({}): {:.1} mm wide, {:.1} mm high, {} layers of {}², {} mips, fins {}×{}, {}",
            if tile.sampled_on_skin { "atlas" } else { "tile" },
            tile.preset,
            tile.edge_mm,
            tile.height_mm,
            tile.layers,
            tile.texture_size,
            tile.mips,
            tile.fin_size[0],
            tile.fin_size[1],
            megabytes(tile.vram_bytes)
        )?;
        if let Some(used) = tile.texels_used {
            writeln!(out, "    {:.1} % of its texels lie on skin, the rest between charts", 100.0 * used)?;
        }
        for (level, coarser) in tile.levels.iter().enumerate().skip(1) {
            let (layers, size, most_px) = (coarser.layers, coarser.texture_size, coarser.most_px.unwrap_or_default());
            let bytes = megabytes(coarser.vram_bytes);
            writeln!(
                out,
                "    level {level}: {layers} layers of {size}², where hair is up to {most_px:.1} pixels high, {bytes}"
            )?;
        }
        writeln!(
            out,
            "    layers are 2 pixels apart at {:.2} m ({} pixels high, {}° of view); step back further",
            tile.gap_distance_m, SCREEN.0, SCREEN.1
        )?;
    }
    writeln!(
        out,
        "  all: {} triangles in {} draw calls, {}",
        coat.drawn_triangles,
        coat.draw_calls,
        megabytes(coat.vram_bytes)
    )
}

/// How the texture lies on the skin.
fn lies(m: &Measures, out: &mut dyn Write) -> io::Result<()> {
    let range = |r: &Range| format!("{:.3} ({:.3} to {:.3})", r.mean, r.p5, r.p95);
    let doubled = if m.faces_doubled > 0 { format!(", {} MORE THAN ONCE", m.faces_doubled) } else { String::new() };
    writeln!(
        out,
        "    covers {} triangles once{doubled}, leaves {} bare; {:.0} cm²",
        m.faces, m.faces_bare, m.area_cm2
    )?;
    writeln!(
        out,
        "    stretch {}, {:.1} % of the skin within 0.7 to 1.4; {:.1}° from the hair; {} texels per mm",
        range(&m.singular_values),
        100.0 * m.share_within,
        m.field_angle_deg,
        range(&m.texels_per_mm)
    )?;
    let Some(seams) = &m.seams else { return Ok(()) };
    writeln!(
        out,
        "    seams {:.0} cm; across them {:.2} of what chance would show, {:.2} as sharp as the rest",
        m.seams_cm, seams.on_skin.difference_over_fake, seams.on_skin.variance_over_interior
    )
}

fn megabytes(bytes: usize) -> String {
    format!("{:.2} MB", bytes as f64 / 1e6)
}
