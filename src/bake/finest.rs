//! What is painted more finely than a coat can show, one sentence each.

use super::Method;
use super::skin::Groomed;
use super::textures::MOST_PAINTED;
use crate::data::coat::CoatPrimitive;
use crate::data::maps::Maps;
use std::collections::BTreeSet;

/// From this many times as fine on as an atlas, a texture loses what people see.
const FINER: f32 = 2.0;

/// Of `groomed` parts, called `materials`, and what they carry. `texel_m` is how far texels of an atlas are apart, m.
pub fn notes(
    groomed: &Groomed,
    materials: &str,
    carried: &[(usize, CoatPrimitive)],
    method: Method,
    texel_m: Option<f32>,
) -> Vec<String> {
    let Some(paint) = &groomed.fields.paint else { return Vec::new() };
    let mut notes = Vec::new();
    let parts: BTreeSet<u32> = groomed.skin.part_of.iter().copied().collect();
    let maps = || parts.iter().filter_map(|&part| paint.parts[part as usize].maps.as_deref());
    let has = |of: fn(&Maps) -> bool| maps().any(of);
    if has(|maps| maps.comb.is_some()) {
        notes.push(format!(
            "{materials}: shells and fins follow the comb map at the skin's vertices; hair of `render` at every root"
        ));
    }
    if has(|maps| maps.clump.is_some()) && !matches!(method, Method::Atlas { .. }) {
        notes.push(format!(
            "{materials}: the clump map is not in the coat, as a tile clumps everywhere alike; an atlas (`parameterisation`) has it"
        ));
    }
    let sizes = maps().flat_map(|maps| [&maps.length, &maps.density, &maps.comb]).flatten();
    if let Some(size) = sizes.map(|image| image.width.max(image.height)).max().filter(|size| *size > MOST_PAINTED) {
        notes.push(format!("{materials}: maps of {size} texels a side are kept at {MOST_PAINTED} in the coat"));
    }
    if carried.iter().any(|(_, primitive)| primitive.cut.as_ref().is_some_and(|cut| cut.coarse)) {
        notes.push(format!(
            "{materials}: the pattern is finer than vertex colours of the fallback show; shells and fins have all of it"
        ));
    }
    if let Some(texel_m) = texel_m {
        let mesh = groomed.mesh();
        let (mut area_m2, mut texels) = (0.0, 0.0);
        for t in (0..mesh.triangles.len()).filter(|&t| paint.of(mesh, t).varies()) {
            area_m2 += mesh.area_m2(t);
            texels += mesh.area_m2(t) / paint.texel_m(mesh, t).powi(2);
        }
        let finer = texel_m / (area_m2 / texels).sqrt();
        if finer > FINER && finer.is_finite() {
            notes.push(format!(
                "{materials}: textures are {finer:.1} times as fine as the atlas: `texture size` N makes it finer, and lapped coats \
                 show all of it"
            ));
        }
    }
    notes
}
