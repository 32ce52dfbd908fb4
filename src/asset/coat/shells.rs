//! Shell stacks as JSON and KTX2 buffer views, and back.

use crate::asset::Document;
use crate::asset::encode::numbers;
use crate::asset::json::At;
use crate::asset::ktx2::{self, Format};
use crate::data::coat::{GAIN_ANGLES_DEG, ShellStack};
use crate::data::image::Image8;
use crate::data::shell::Slabs;
use crate::error::Result;
use crate::math::Vec2;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A stack's textures as files hold them, each a KTX2 file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PackedShells {
    #[serde(with = "serde_bytes")]
    albedo: Vec<u8>,
    #[serde(with = "serde_bytes")]
    medium: Vec<u8>,
    #[serde(with = "serde_bytes")]
    ends: Vec<u8>,
}

impl PackedShells {
    /// Of a stack.
    ///
    /// # Errors
    /// When its mips or layers do not fit together.
    pub fn new(shells: &ShellStack) -> Result<Self> {
        let array = |images: &[Vec<Image8>], format| {
            let levels: Vec<Vec<&Image8>> = images.iter().map(|level| level.iter().collect()).collect();
            ktx2::encode(&levels, format, true)
        };
        Ok(Self {
            albedo: array(&shells.albedo, Format::Rgba8Srgb)?,
            medium: array(&shells.medium, Format::Rgba8)?,
            ends: array(&shells.ends, Format::R8)?,
        })
    }
}

/// Appends a stack's textures and gives its JSON.
pub fn write(document: &mut Document, shells: &ShellStack, packed: &PackedShells) -> Value {
    let [albedo, medium, ends] =
        [&packed.albedo, &packed.medium, &packed.ends].map(|bytes| document.push_view(bytes, None));
    json!({
        "layers": shells.layers,
        "tops": numbers(shells.slabs.tops()),
        "size": shells.size,
        "extinctionScales": numbers(&shells.extinction_scales_per_m),
        "gainAngles": numbers(&GAIN_ANGLES_DEG),
        "gains": shells.gains.iter().map(|mip| mip.iter().map(|g| numbers(g)).collect()).collect::<Vec<Vec<_>>>(),
        "slopes": shells.slopes.iter().map(|s| numbers(&s.to_array())).collect::<Vec<_>>(),
        "albedo": albedo,
        "medium": medium,
        "ends": ends,
    })
}

/// The mips and layers of a texture.
pub fn images(document: &Document, owner: &At<'_>, key: &str, format: Format) -> Result<Vec<Vec<Image8>>> {
    let view = owner.need(key)?;
    ktx2::decode(document.view(view.size()?)?, format).map_err(|e| e.with_field(view.path.clone()))
}

/// A number above 0.
pub fn positive(at: &At<'_>) -> Result<f32> {
    let number = at.number()? as f32;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err(at.fault("a number above 0")) }
}

/// Reads a stack back.
pub fn read(document: &Document, at: &At<'_>) -> Result<ShellStack> {
    let array = |key: &str, format| -> Result<Vec<Vec<Image8>>> {
        let found = images(document, at, key, format)?;
        let (layers, size) = (at.need("layers")?.size()?, at.need("size")?.size()?);
        let fits = found.first().is_some_and(|mip| mip.len() == layers && mip[0].width as usize == size);
        if fits { Ok(found) } else { Err(at.need(key)?.fault("a texture of the stated layers and size")) }
    };
    let angles = at.need("gainAngles")?;
    if angles.numbers::<9>()?.iter().zip(GAIN_ANGLES_DEG).any(|(&a, b)| (a - f64::from(b)).abs() > 1e-6) {
        return Err(angles.fault(&format!("{GAIN_ANGLES_DEG:?}")));
    }
    let (albedo, medium, ends) =
        (array("albedo", Format::Rgba8Srgb)?, array("medium", Format::Rgba8)?, array("ends", Format::R8)?);
    if medium.len() != albedo.len() || ends.len() != albedo.len() {
        return Err(at.need("medium")?.fault("as many mips as the other textures"));
    }
    let layers = albedo[0].len();
    // Up to version 2 a mip's layers have one row together.
    let row = |at: &At<'_>| -> Result<[f32; 9]> { Ok(at.numbers::<9>()?.map(|n| n as f32)) };
    let of_mip = |at: &At<'_>| -> Result<Vec<[f32; 9]>> {
        match at.value.get(0) {
            Some(Value::Array(_)) => at.entries()?.iter().map(row).collect(),
            _ => Ok(vec![row(at)?; layers]),
        }
    };
    let gains = at.list("gains")?.iter().map(of_mip).collect::<Result<Vec<_>>>()?;
    let slope = |at: &At<'_>| at.numbers::<2>().map(|n| Vec2::new(n[0] as f32, n[1] as f32));
    let slopes = at.list("slopes")?.iter().map(slope).collect::<Result<Vec<_>>>()?;
    let scales = at.list("extinctionScales")?.iter().map(positive).collect::<Result<Vec<_>>>()?;
    let fits = gains.len() == albedo.len()
        && gains.iter().all(|mip| mip.len() == layers)
        && scales.len() == albedo.len()
        && slopes.len() == layers
        && layers > 1;
    if !fits {
        return Err(at.need("gains")?.fault("one row per mip and layer, one slope per layer, and at least 2 layers"));
    }
    // Up to version 2 slabs are equally high.
    let slabs = match at.get("tops") {
        None => Slabs::even(layers - 1),
        Some(tops) => {
            let found = at.list("tops")?.iter().map(|top| Ok(top.number()? as f32)).collect::<Result<Vec<_>>>()?;
            let slabs = Slabs::with_tops(found).filter(|slabs| slabs.count() + 1 == layers);
            slabs.ok_or_else(|| tops.fault("a rising number per layer, from 0 to at most 1"))?
        }
    };
    Ok(ShellStack {
        layers: layers as u32,
        slabs,
        size: albedo[0][0].width,
        gains,
        slopes,
        extinction_scales_per_m: scales,
        albedo,
        medium,
        ends,
    })
}
