//! A baked asset as camera and lights need to know it.

use crate::asset::{Asset, Part};
use crate::data::coat::Coat;
use crate::data::subject::Subject;
use crate::error::Result;

/// The asset in its rest pose, and how far the hair of its coat reaches.
///
/// # Errors
/// As [`Asset::subject`].
pub fn subject(asset: &Asset, coat: &Coat) -> Result<Subject> {
    let mut hair_m: Vec<Vec<f32>> = asset.parts.iter().map(|part| vec![0.0; part.vertices()]).collect();
    for coat_primitive in &coat.primitives {
        let is_of = |part: &Part| (part.mesh, part.primitive) == (coat_primitive.mesh, coat_primitive.primitive);
        let Some(index) = asset.parts.iter().position(is_of) else { continue };
        for &v in coat_primitive.triangles.iter().flatten() {
            let offset = coat_primitive.offset[v as usize].as_dvec3();
            let base = coat_primitive.base_vertex[v as usize] as usize;
            let world = asset.parts[index].world_from_local(base) * offset;
            let reach_m = &mut hair_m[index][base];
            *reach_m = reach_m.max((world.length() * coat.metres_per_unit) as f32);
        }
    }
    asset.subject(coat.metres_per_unit, |part, v| hair_m[part][v])
}
