//! Tiles as JSON and KTX2 buffer views, and back.

use super::shells::{self, PackedShells, images, positive};
use crate::asset::Document;
use crate::asset::encode::numbers;
use crate::asset::json::At;
use crate::asset::ktx2::{self, Format};
use crate::data::coat::{FinTexture, LOOK, Level, Sampled, Tile, TileLooks};
use crate::data::image::Image8;
use crate::error::Result;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A tile's textures as files hold them, each a KTX2 file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packed {
    shells: PackedShells,
    levels: Vec<PackedShells>,
    #[serde(with = "serde_bytes")]
    fin_albedo: Vec<u8>,
    #[serde(with = "serde_bytes")]
    fin_tangent: Vec<u8>,
}

impl Packed {
    /// Of a tile: most of the work of writing a coat.
    ///
    /// # Errors
    /// When its mips or layers do not fit together.
    pub fn new(tile: &Tile) -> Result<Self> {
        let single = |images: &[Image8], format| {
            let levels: Vec<Vec<&Image8>> = images.iter().map(|image| vec![image]).collect();
            ktx2::encode(&levels, format, false)
        };
        Ok(Self {
            shells: PackedShells::new(&tile.shells)?,
            levels: tile.levels.iter().map(|level| PackedShells::new(&level.shells)).collect::<Result<_>>()?,
            fin_albedo: single(&tile.fin.albedo, Format::Rgba8Srgb)?,
            fin_tangent: single(&tile.fin.tangent, Format::Rgba8)?,
        })
    }
}

/// Appends a tile's textures and gives its JSON.
pub fn write(document: &mut Document, tile: &Tile, packed: &Packed) -> Value {
    let fin = &tile.fin;
    let shells = shells::write(document, &tile.shells, &packed.shells);
    let levels = tile.levels.iter().zip(&packed.levels).map(|(level, packed)| {
        let shells = shells::write(document, &level.shells, packed);
        let undercoat_share = numbers(&level.undercoat_share);
        json!({"mostPixels": f64::from(level.most_px), "undercoatShare": undercoat_share, "shells": shells})
    });
    let levels: Vec<Value> = levels.collect();
    let [fin_albedo, fin_tangent] =
        [&packed.fin_albedo, &packed.fin_tangent].map(|bytes| document.push_view(bytes, None));
    let mut value = json!({
        "preset": tile.preset,
        "edge": f64::from(tile.edge_m),
        "height": f64::from(tile.height_m),
        "shells": shells,
        "fin": {
            "size": fin.size,
            "width": f64::from(fin.width_m),
            "thickness": f64::from(fin.thickness_m),
            "albedo": fin_albedo,
            "tangent": fin_tangent,
        },
    });
    if !levels.is_empty() {
        value["levels"] = json!(levels);
    }
    if tile.sampled == Sampled::Skin {
        value["sampled"] = json!("skin");
    }
    if let Some(looks) = &tile.looks {
        let [guard, undercoat] = looks.of.each_ref().map(|look| numbers(look.as_flattened()));
        value["looks"] = json!({
            "guard": guard,
            "undercoat": undercoat,
            "crowding": numbers(&looks.crowding),
            "undercoatShare": numbers(&looks.undercoat_share),
        });
    }
    value
}

/// So many finite numbers.
fn finite_numbers(at: &At<'_>, key: &str, count: usize) -> Result<Vec<f32>> {
    let finite = |at: &At<'_>| -> Result<f32> {
        let number = at.number()? as f32;
        if number.is_finite() { Ok(number) } else { Err(at.fault("a finite number")) }
    };
    let found = at.list(key)?.iter().map(finite).collect::<Result<Vec<_>>>()?;
    if found.len() == count { Ok(found) } else { Err(at.need(key)?.fault(&format!("{count} numbers"))) }
}

/// So many numbers from 0 to `most`.
fn numbers_within(at: &At<'_>, key: &str, count: usize, most: f32) -> Result<Vec<f32>> {
    let found = finite_numbers(at, key, count)?;
    let fits = found.iter().all(|number| (0.0..=most).contains(number));
    if fits { Ok(found) } else { Err(at.need(key)?.fault(&format!("numbers from 0 to {most}"))) }
}

/// Reads how the hair of a tile with so many layers is lit.
fn looks(at: &At<'_>, layers: usize) -> Result<TileLooks> {
    let look = |key: &str| -> Result<[[f32; 4]; LOOK]> {
        let numbers = finite_numbers(at, key, 4 * LOOK)?;
        Ok(std::array::from_fn(|row| std::array::from_fn(|i| numbers[4 * row + i])))
    };
    let crowding = numbers_within(at, "crowding", 2, f32::MAX)?;
    Ok(TileLooks {
        of: [look("guard")?, look("undercoat")?],
        crowding: [crowding[0], crowding[1]],
        undercoat_share: numbers_within(at, "undercoatShare", layers, 1.0)?,
    })
}

/// Reads a tile back.
pub fn read(document: &Document, at: &At<'_>) -> Result<Tile> {
    let fin = at.need("fin")?;
    let shells = shells::read(document, &at.need("shells")?)?;
    let single = |key: &str, format| -> Result<Vec<Image8>> {
        Ok(images(document, &fin, key, format)?.into_iter().filter_map(|mut mip| mip.pop()).collect())
    };
    let float = |owner: &At<'_>, key: &str| positive(&owner.need(key)?);
    let (fin_albedo, fin_tangent) = (single("albedo", Format::Rgba8Srgb)?, single("tangent", Format::Rgba8)?);
    let size = fin.need("size")?.numbers::<2>()?.map(|n| n as u32);
    let alike = |list: &[Image8]| list.first().is_some_and(|image| [image.width, image.height] == size);
    if fin_albedo.len() != fin_tangent.len() || !alike(&fin_albedo) || !alike(&fin_tangent) {
        return Err(fin.need("tangent")?.fault("textures of the stated size with equally many mips"));
    }
    let sampled = match at.get("sampled") {
        None => Sampled::Square,
        Some(sampled) if sampled.value == &json!("skin") => Sampled::Skin,
        Some(sampled) => return Err(sampled.fault("\"skin\", or nothing for a tile that repeats")),
    };
    let level = |at: &At<'_>| -> Result<Level> {
        let shells = shells::read(document, &at.need("shells")?)?;
        let undercoat_share = numbers_within(at, "undercoatShare", shells.layers as usize, 1.0)?;
        Ok(Level { shells, undercoat_share, most_px: float(at, "mostPixels")? })
    };
    Ok(Tile {
        levels: at.list("levels")?.iter().map(level).collect::<Result<_>>()?,
        looks: at.get("looks").map(|at| looks(&at, shells.layers as usize)).transpose()?,
        preset: at.need("preset")?.text()?.to_owned(),
        sampled,
        edge_m: float(at, "edge")?,
        height_m: float(at, "height")?,
        shells,
        fin: FinTexture {
            size,
            width_m: float(&fin, "width")?,
            thickness_m: float(&fin, "thickness")?,
            albedo: fin_albedo,
            tangent: fin_tangent,
        },
    })
}
