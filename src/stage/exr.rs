//! A film to OpenEXR, with every layer.

use crate::data::film::Film;
use crate::error::{Error, Kind, Result};
use crate::math::Vec3;
use exr::prelude::*;
use std::io::Cursor;

/// Encodes a film as one scan-line image of 32-bit floats. Channels: `R G B A` (radiance, premultiplied), `Z` (mean distance,
/// m), `normal.XYZ` and `tangent.XYZ` (world axes), `albedo.RGB`, `guard` and `undercoat` (their parts of A); those of layers
/// that the film does not have are left out.
///
/// # Errors
/// Where the film is too large to encode.
pub fn encode(film: &Film) -> Result<Vec<u8>> {
    let mut channels = SmallVec::new();
    let mut add = |name: &str, values: Vec<f32>| {
        if !values.is_empty() {
            channels.push(AnyChannel::new(name, FlatSamples::F32(values)));
        }
    };
    let axis = |values: &[Vec3], i: usize| values.iter().map(|v| v[i]).collect::<Vec<f32>>();
    let vectors = [
        (["R", "G", "B"], &film.radiance),
        (["albedo.R", "albedo.G", "albedo.B"], &film.albedo),
        (["normal.X", "normal.Y", "normal.Z"], &film.normal),
        (["tangent.X", "tangent.Y", "tangent.Z"], &film.tangent),
    ];
    for (names, values) in vectors {
        for (i, name) in names.into_iter().enumerate() {
            add(name, axis(values, i));
        }
    }
    for (name, values) in
        [("A", &film.alpha), ("Z", &film.depth_m), ("guard", &film.guard), ("undercoat", &film.undercoat)]
    {
        add(name, values.clone());
    }
    let layer = Layer::new(
        (film.width, film.height),
        LayerAttributes::named("fur"),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| Error::new(Kind::Output, "the film cannot be encoded as EXR").with_found(e))?;
    Ok(bytes.into_inner())
}
