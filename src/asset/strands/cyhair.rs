//! cyHair (Cem Yuksel, "HAIR file format", cemyuksel.com/research/hairmodels): a header of 128 bytes and flat arrays, little
//! endian.

use super::{Export, counted, points};
use crate::error::Result;

/// What the arrays after the header are: segments, points, thickness, transparency, colours.
const ALL_ARRAYS: u32 = 1 | 2 | 4 | 8 | 16;

/// Text at the header's end, at most 88 bytes.
const ABOUT: &[u8] = b"furrier: guard hair, axes and units of the input; its undercoat is a volume, not in here";

pub(super) fn encode(export: &Export<'_>) -> Result<Vec<u8>> {
    let strands = export.strands;
    let segments = (strands.points_per_strand - 1) as u16;
    let mut out = Vec::with_capacity(128 + 2 * strands.len() + 32 * strands.points_m.len());
    out.extend(b"HAIR");
    out.extend(counted(strands.len(), "hairs")?.to_le_bytes());
    out.extend(counted(strands.points_m.len(), "points")?.to_le_bytes());
    out.extend(ALL_ARRAYS.to_le_bytes());
    out.extend(u32::from(segments).to_le_bytes());
    // Defaults for absent arrays: thickness, transparency, colour. All are there.
    for default in [0.0_f32, 0.0, 1.0, 1.0, 1.0] {
        out.extend(default.to_le_bytes());
    }
    let mut about = [0; 88];
    about[..ABOUT.len()].copy_from_slice(ABOUT);
    out.extend(about);

    out.extend(std::iter::repeat_n(segments.to_le_bytes(), strands.len()).flatten());
    let mut floats = |value: f32| out.extend(value.to_le_bytes());
    for &point_m in &strands.points_m {
        let point = export.in_file(export.origin_m + point_m.as_dvec3());
        point.as_vec3().to_array().into_iter().for_each(&mut floats);
    }
    points(export).for_each(|point| floats(point.diameter));
    points(export).for_each(|point| floats(1.0 - point.opacity));
    points(export).for_each(|point| point.colour.to_array().into_iter().for_each(&mut floats));
    Ok(out)
}
