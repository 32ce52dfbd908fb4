//! One part made ready for fur: its mesh in metres and the fields on it.

use super::comb::comb;
use super::units::Scale;
use crate::asset::material::BaseColour;
use crate::asset::{Asset, Part, Pose, image};
use crate::coat::primitive::offset_over_height;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::error::Result;
use crate::fur::field::Singularity;
use crate::fur::groom::fibre::Fibre;
use crate::fur::groom::maps::Maps;
use crate::fur::groom::{ColourSource, fields};
use crate::math::{Vec3, Vec4};
use crate::preset::{self, Preset};

/// Mesh, fields, and what to tell the user of them.
#[derive(Debug)]
pub struct Groomed {
    /// The skin.
    pub mesh: Mesh,
    /// The fields on it.
    pub fields: Fields,
    /// Where the comb has no direction, in the rest pose.
    pub singularities: Vec<Singularity>,
    /// One sentence each.
    pub notes: Vec<String>,
}

impl Groomed {
    /// Root to the top of the stack over the stack's height, one per vertex, world axes.
    pub fn offsets(&self) -> Vec<Vec3> {
        (0..self.fields.lean.len()).map(|v| offset_over_height(&self.fields, v)).collect()
    }
}

/// Gathers everything that decides how hair lies on `part`.
pub fn groom(asset: &Asset, part: &Part, preset: &Preset, scale: &Scale) -> Result<Groomed> {
    let metres_per_unit = scale.metres_per_unit;
    let mesh = part.mesh(metres_per_unit)?;
    let maps = decode(&preset.maps)?;
    let mut notes = Vec::new();
    if !maps.is_empty() && mesh.uv_sets.is_empty() {
        notes.push(format!("material {:?} has no texture coordinates: groom maps are left out", part.material_name));
    }
    let comb = comb(asset, &mesh, &preset.groom, &maps, metres_per_unit, &mut notes)?;
    let tint = tint(asset, part, &mesh, preset)?;
    let diagonal_m = scale.diagonal_m as f32;
    let guard = Fibre::guard(&preset.guard, &preset.colour, diagonal_m);
    let undercoat = Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m);
    // Undercoat must not cross, as it is a volume; single guard hairs may.
    let height_m = if undercoat.height_m() > 0.0 { undercoat.height_m() } else { guard.height_m() };
    let fields = fields::gather(&mesh, &preset.groom, &maps, comb.direction, tint, height_m);
    Ok(Groomed { fields, mesh, singularities: comb.singularities, notes })
}

impl Groomed {
    /// Puts the skin into a pose. Hair follows it as a coat's does: by the map of the skin under its root, without growing
    /// longer where the skin is stretched.
    ///
    /// # Errors
    /// Where the pose takes a vertex beyond what f32 can hold.
    pub fn pose(self, asset: &Asset, part: &Part, pose: &Pose, metres_per_unit: f64) -> Result<Self> {
        let posed = part.posed(asset, pose, part.nodes[0], metres_per_unit);
        let Self { mesh, mut fields, singularities, notes } = self;
        let turned = |v: usize, direction: Vec3| {
            let local = part.local_from_world(v) * (direction.as_dvec3() / metres_per_unit);
            posed.world_from_offset[v].as_dmat3() * local
        };
        for v in 0..mesh.positions_m.len() {
            let along = turned(v, fields.direction[v]).as_vec3();
            fields.direction[v] = along.reject_from(posed.normals[v]).normalize_or_zero();
            fields.lean[v] = turned(v, fields.lean[v]).as_vec3().normalize_or(posed.normals[v]);
        }
        let mut mesh =
            Mesh { rest_m: Some(mesh.positions_m), positions_m: posed.positions_m, normals: posed.normals, ..mesh };
        if posed.mirrored != part.mirrored() {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(Self { mesh: mesh.checked()?, fields, singularities, notes })
    }
}

fn decode(maps: &preset::Maps) -> Result<Maps> {
    let load = |path: &Option<std::path::PathBuf>| path.as_deref().map(image::load).transpose();
    Ok(Maps {
        density: load(&maps.density)?,
        length: load(&maps.length)?,
        comb: load(&maps.comb)?,
        colour: load(&maps.colour)?,
        clump: load(&maps.clump)?,
    })
}

/// Hair colour per vertex: the asset's own; the preset's tint where it has none.
fn tint(asset: &Asset, part: &Part, mesh: &Mesh, preset: &Preset) -> Result<Vec<Vec3>> {
    let own = match preset.colour.from {
        ColourSource::Preset => None,
        ColourSource::Asset => own_colour(asset, part, mesh)?,
    };
    Ok(own.unwrap_or_else(|| vec![Vec3::from(preset.colour.tint); mesh.positions_m.len()]))
}

/// Skin colour per vertex of a part that no preset has a say in.
pub(super) fn bare_colour(asset: &Asset, part: &Part, mesh: &Mesh) -> Result<Vec<Vec3>> {
    Ok(own_colour(asset, part, mesh)?.unwrap_or_else(|| vec![Vec3::ONE; mesh.positions_m.len()]))
}

/// Base-colour texture, factor and vertex colours; none where the asset has none of them.
fn own_colour(asset: &Asset, part: &Part, mesh: &Mesh) -> Result<Option<Vec<Vec3>>> {
    let BaseColour { factor, texture } = &part.base_colour;
    let image = match texture {
        Some(texture) => asset.document.decode_image(texture.image)?.map(|image| (texture, image)),
        None => None,
    };
    if image.is_none() && mesh.colour.is_none() && factor.truncate() == Vec3::ONE {
        return Ok(None);
    }
    let vertex_colour = |v: usize| mesh.colour.as_ref().map_or(Vec4::ONE, |colour| colour[v]);
    let texel = |v: usize| match &image {
        Some((texture, image)) => match mesh.uv_sets.get(texture.uv_set) {
            Some(uv) => texture.sample(image, uv[v]),
            None => Vec4::ONE,
        },
        None => Vec4::ONE,
    };
    let colour = |v: usize| (*factor * vertex_colour(v) * texel(v)).truncate().clamp(Vec3::ZERO, Vec3::ONE);
    Ok(Some((0..mesh.positions_m.len()).map(colour).collect()))
}
