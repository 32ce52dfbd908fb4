//! A baked asset as camera and lights need to know it.

use crate::asset::Asset;
use crate::data::coat::Coat;
use crate::data::subject::Subject;
use crate::error::Result;

/// The asset in its rest pose with the longest hair that its coat holds.
///
/// # Errors
/// As [`Asset::subject`].
pub fn subject(asset: &Asset, coat: &Coat) -> Result<Subject> {
    let mut subject = asset.subject(coat.metres_per_unit)?;
    for coat_primitive in &coat.primitives {
        let is_of =
            |part: &&crate::asset::Part| (part.mesh, part.primitive) == (coat_primitive.mesh, coat_primitive.primitive);
        let Some(part) = asset.parts.iter().find(is_of) else { continue };
        for &v in coat_primitive.triangles.iter().flatten() {
            let offset = coat_primitive.offset[v as usize].as_dvec3();
            let world = part.world_from_local(coat_primitive.base_vertex[v as usize] as usize) * offset;
            subject.hair_m = subject.hair_m.max(world.length() * coat.metres_per_unit);
        }
    }
    Ok(subject)
}
