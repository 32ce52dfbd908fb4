//! Tiles as JSON and KTX2 buffer views, and back.

use crate::asset::Document;
use crate::asset::encode::numbers;
use crate::asset::json::At;
use crate::asset::ktx2::{self, Format};
use crate::data::coat::{FinTexture, GAIN_ANGLES_DEG, LOOK, Sampled, ShellStack, Tile, TileLooks};
use crate::data::image::Image8;
use crate::error::Result;
use crate::math::Vec2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A tile's textures as files hold them, each a KTX2 file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packed {
    #[serde(with = "serde_bytes")]
    albedo: Vec<u8>,
    #[serde(with = "serde_bytes")]
    medium: Vec<u8>,
    #[serde(with = "serde_bytes")]
    ends: Vec<u8>,
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
        let array = |images: &[Vec<Image8>], format| {
            let levels: Vec<Vec<&Image8>> = images.iter().map(|level| level.iter().collect()).collect();
            ktx2::encode(&levels, format, true)
        };
        let single = |images: &[Image8], format| {
            let levels: Vec<Vec<&Image8>> = images.iter().map(|image| vec![image]).collect();
            ktx2::encode(&levels, format, false)
        };
        let (shells, fin) = (&tile.shells, &tile.fin);
        Ok(Self {
            albedo: array(&shells.albedo, Format::Rgba8Srgb)?,
            medium: array(&shells.medium, Format::Rgba8)?,
            ends: array(&shells.ends, Format::R8)?,
            fin_albedo: single(&fin.albedo, Format::Rgba8Srgb)?,
            fin_tangent: single(&fin.tangent, Format::Rgba8)?,
        })
    }
}

/// Appends a tile's textures and gives its JSON.
pub fn write(document: &mut Document, tile: &Tile, packed: &Packed) -> Value {
    let (shells, fin) = (&tile.shells, &tile.fin);
    let mut view = |bytes: &[u8]| document.push_view(bytes, None);
    let (albedo, medium, ends) = (view(&packed.albedo), view(&packed.medium), view(&packed.ends));
    let (fin_albedo, fin_tangent) = (view(&packed.fin_albedo), view(&packed.fin_tangent));
    let mut value = json!({
        "preset": tile.preset,
        "edge": f64::from(tile.edge_m),
        "height": f64::from(tile.height_m),
        "shells": {
            "layers": shells.layers,
            "size": shells.size,
            "extinctionScales": numbers(&shells.extinction_scales_per_m),
            "gainAngles": numbers(&GAIN_ANGLES_DEG),
            "gains": shells.gains.iter().map(|mip| mip.iter().map(|g| numbers(g)).collect()).collect::<Vec<Vec<_>>>(),
            "slopes": shells.slopes.iter().map(|s| numbers(&s.to_array())).collect::<Vec<_>>(),
            "albedo": albedo,
            "medium": medium,
            "ends": ends,
        },
        "fin": {
            "size": fin.size,
            "width": f64::from(fin.width_m),
            "thickness": f64::from(fin.thickness_m),
            "albedo": fin_albedo,
            "tangent": fin_tangent,
        },
    });
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

/// Reads how the hair of a tile with so many layers is lit.
fn looks(at: &At<'_>, layers: usize) -> Result<TileLooks> {
    let finite = |at: &At<'_>| -> Result<f32> {
        let number = at.number()? as f32;
        if number.is_finite() { Ok(number) } else { Err(at.fault("a finite number")) }
    };
    let list = |key: &str, count: usize| -> Result<Vec<f32>> {
        let found = at.list(key)?.iter().map(finite).collect::<Result<Vec<_>>>()?;
        if found.len() == count { Ok(found) } else { Err(at.need(key)?.fault(&format!("{count} numbers"))) }
    };
    let look = |key: &str| -> Result<[[f32; 4]; LOOK]> {
        let numbers = list(key, 4 * LOOK)?;
        Ok(std::array::from_fn(|row| std::array::from_fn(|i| numbers[4 * row + i])))
    };
    let within = |key: &str, count: usize, most: f32| -> Result<Vec<f32>> {
        let found = list(key, count)?;
        let fits = found.iter().all(|number| (0.0..=most).contains(number));
        if fits { Ok(found) } else { Err(at.need(key)?.fault(&format!("numbers from 0 to {most}"))) }
    };
    let crowding = within("crowding", 2, f32::MAX)?;
    Ok(TileLooks {
        of: [look("guard")?, look("undercoat")?],
        crowding: [crowding[0], crowding[1]],
        undercoat_share: within("undercoatShare", layers, 1.0)?,
    })
}

/// Reads a tile back.
pub fn read(document: &Document, at: &At<'_>) -> Result<Tile> {
    let (shells, fin) = (at.need("shells")?, at.need("fin")?);
    let images = |owner: &At<'_>, key: &str, format| -> Result<Vec<Vec<Image8>>> {
        let view = owner.need(key)?;
        ktx2::decode(document.view(view.size()?)?, format).map_err(|e| e.with_field(view.path.clone()))
    };
    let array = |key: &str, format| -> Result<Vec<Vec<Image8>>> {
        let found = images(&shells, key, format)?;
        let (layers, size) = (shells.need("layers")?.size()?, shells.need("size")?.size()?);
        let fits = found.first().is_some_and(|mip| mip.len() == layers && mip[0].width as usize == size);
        if fits { Ok(found) } else { Err(shells.need(key)?.fault("a texture of the stated layers and size")) }
    };
    let single = |key: &str, format| -> Result<Vec<Image8>> {
        Ok(images(&fin, key, format)?.into_iter().filter_map(|mut mip| mip.pop()).collect())
    };
    let positive = |at: &At<'_>| -> Result<f32> {
        let number = at.number()? as f32;
        if number > 0.0 && number.is_finite() { Ok(number) } else { Err(at.fault("a number above 0")) }
    };
    let float = |owner: &At<'_>, key: &str| positive(&owner.need(key)?);
    let angles = shells.need("gainAngles")?;
    if angles.numbers::<9>()?.iter().zip(GAIN_ANGLES_DEG).any(|(&a, b)| (a - f64::from(b)).abs() > 1e-6) {
        return Err(angles.fault(&format!("{GAIN_ANGLES_DEG:?}")));
    }
    let slopes = shells.list("slopes")?;
    let slopes = slopes.iter().map(|s| s.numbers::<2>().map(|n| Vec2::new(n[0] as f32, n[1] as f32)));
    let (albedo, medium, ends) =
        (array("albedo", Format::Rgba8Srgb)?, array("medium", Format::Rgba8)?, array("ends", Format::R8)?);
    let (fin_albedo, fin_tangent) = (single("albedo", Format::Rgba8Srgb)?, single("tangent", Format::Rgba8)?);
    // Up to version 2 a mip's layers have one row together.
    let row = |at: &At<'_>| -> Result<[f32; 9]> { Ok(at.numbers::<9>()?.map(|n| n as f32)) };
    let of_mip = |at: &At<'_>| -> Result<Vec<[f32; 9]>> {
        match at.value.get(0) {
            Some(Value::Array(_)) => at.entries()?.iter().map(row).collect(),
            _ => Ok(vec![row(at)?; albedo.first().map_or(0, Vec::len)]),
        }
    };
    let gains = shells.list("gains")?.iter().map(of_mip).collect::<Result<Vec<_>>>()?;
    let size = fin.need("size")?.numbers::<2>()?.map(|n| n as u32);
    let alike = |list: &[Image8]| list.first().is_some_and(|image| [image.width, image.height] == size);
    if fin_albedo.len() != fin_tangent.len() || !alike(&fin_albedo) || !alike(&fin_tangent) {
        return Err(fin.need("tangent")?.fault("textures of the stated size with equally many mips"));
    }
    if medium.len() != albedo.len() || ends.len() != albedo.len() {
        return Err(shells.need("medium")?.fault("as many mips as the other textures"));
    }
    let slopes = slopes.collect::<Result<Vec<_>>>()?;
    let scales = shells.list("extinctionScales")?;
    let scales = scales.iter().map(positive).collect::<Result<Vec<_>>>()?;
    if gains.len() != albedo.len()
        || gains.iter().any(|mip| mip.len() != albedo[0].len())
        || scales.len() != albedo.len()
        || slopes.len() != albedo[0].len()
        || albedo[0].len() < 2
    {
        return Err(shells
            .need("gains")?
            .fault("one row per mip and layer, one slope per layer, and at least 2 layers"));
    }
    let sampled = match at.get("sampled") {
        None => Sampled::Square,
        Some(sampled) if sampled.value == &json!("skin") => Sampled::Skin,
        Some(sampled) => return Err(sampled.fault("\"skin\", or nothing for a tile that repeats")),
    };
    let looks = at.get("looks").map(|at| looks(&at, albedo[0].len())).transpose()?;
    Ok(Tile {
        looks,
        preset: at.need("preset")?.text()?.to_owned(),
        sampled,
        edge_m: float(at, "edge")?,
        height_m: float(at, "height")?,
        shells: ShellStack {
            layers: albedo[0].len() as u32,
            size: albedo[0][0].width,
            gains,
            slopes,
            extinction_scales_per_m: scales,
            albedo,
            medium,
            ends,
        },
        fin: FinTexture {
            size,
            width_m: float(&fin, "width")?,
            thickness_m: float(&fin, "thickness")?,
            albedo: fin_albedo,
            tangent: fin_tangent,
        },
    })
}
