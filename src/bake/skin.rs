//! The skin made ready for fur: its mesh in metres, what is painted on it and the fields over it.

use super::comb::{comb, partings};
use super::steps::Steps;
use super::units::Scale;
use super::weld::Skin;
use crate::asset::material::BaseColour;
use crate::asset::{Asset, Pose, Posed, image};
use crate::coat::primitive::offset_over_height;
use crate::data::fields::Fields;
use crate::data::image::Image8;
use crate::data::maps::Maps;
use crate::data::mesh::Mesh;
use crate::data::paint::{Paint, Painted};
use crate::data::texture::Texture;
use crate::error::Result;
use crate::fur::field::{FieldSource, Singularity, directions};
use crate::fur::groom::fibre::Fibre;
use crate::fur::groom::lean::Standing;
use crate::fur::groom::unfold::unfold;
use crate::fur::groom::{ColourSource, fields, parted};
use crate::math::{Mat3, Vec3, Vec4};
use crate::preset::{self, Preset};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

/// Skin, fields, and what to tell the user of them.
#[derive(Clone, Debug)]
pub struct Groomed {
    /// The skin.
    pub skin: Skin,
    /// The fields on it.
    pub fields: Fields,
    /// Where the comb has no direction, in the rest pose.
    pub singularities: Vec<Singularity>,
    /// One sentence each.
    pub notes: Vec<String>,
}

/// What a part is to a preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Its hair grows there.
    Furred,
    /// Skin without hair, in its own colour.
    Bare,
    /// A part of the surface that nothing is asked of.
    Aside,
}

/// Gathers everything that decides how hair lies on `skin`, whose parts have these roles.
///
/// # Errors
/// When a map or texture cannot be read, or the comb's sources make no sense.
pub fn groom(
    asset: &Asset,
    skin: &Skin,
    role: impl Fn(usize) -> Role,
    preset: &Preset,
    scale: &Scale,
    steps: &mut Steps<'_>,
) -> Result<Groomed> {
    let mut notes = Vec::new();
    let maps = Arc::new(decode(&preset.maps)?);
    let paint = paint(asset, skin, &role, preset, &maps, &mut notes)?;
    let directions =
        |mesh: &Mesh, sources: &[FieldSource]| steps.kept("comb", &(mesh, sources), |_| directions(mesh, sources));
    let comb = comb(asset, &skin.mesh, &preset.groom, &maps, scale, &mut notes, directions)?;
    let diagonal_m = scale.diagonal_m as f32;
    let guard = Fibre::guard(&preset.guard, &preset.colour, diagonal_m);
    let undercoat = Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m);
    // Undercoat must not cross, as it is a volume; single guard hairs may.
    let height_m = if undercoat.height_m() > 0.0 { undercoat.height_m() } else { guard.height_m() };
    let unfolded = |standing: &Standing, lean: Vec<Vec3>, length: Vec<f32>| {
        steps.kept("lean", &(&skin.mesh, height_m, &lean, &length), |_| {
            let (mut lean, mut length) = (lean.clone(), length.clone());
            unfold(&skin.mesh, standing, height_m, &mut lean, &mut length);
            Ok((lean, length))
        })
    };
    let mut fields = fields::gather(&skin.mesh, &preset.groom, paint, comb.direction, unfolded)?;
    parted::part(&skin.mesh, partings(asset, &preset.groom, scale), height_m, &mut fields);
    Ok(Groomed { fields, skin: skin.clone(), singularities: comb.singularities, notes })
}

impl Groomed {
    /// The mesh of the skin.
    pub fn mesh(&self) -> &Mesh {
        &self.skin.mesh
    }

    /// Root to the top of the stack over the stack's height, one per vertex, world axes.
    pub fn offsets(&self) -> Vec<Vec3> {
        (0..self.fields.lean.len()).map(|v| offset_over_height(&self.fields, v)).collect()
    }

    /// Some parts of it, with hair as on the whole.
    pub fn cut(&self, keep: impl Fn(u32) -> bool) -> Self {
        let (skin, old) = self.skin.cut(&keep);
        fn at<T: Copy>(list: &[T], old: &[u32]) -> Vec<T> {
            old.iter().map(|&v| list[v as usize]).collect()
        }
        let Fields { length, density, direction, lean, clump, tint, paint, partings } = &self.fields;
        let cut_paint = |paint: &Arc<Paint>| {
            Arc::new(Paint {
                parts: paint.parts.clone(),
                part_of: at(&paint.part_of, &old),
                factor: at(&paint.factor, &old),
                longest: at(&paint.longest, &old),
                density: at(&paint.density, &old),
            })
        };
        let fields = Fields {
            length: at(length, &old),
            density: at(density, &old),
            direction: at(direction, &old),
            lean: at(lean, &old),
            clump: at(clump, &old),
            tint: at(tint, &old),
            paint: paint.as_ref().map(cut_paint),
            partings: partings.clone(),
        };
        // Triangles keep their order.
        let mut number = vec![u32::MAX; self.skin.part_of.len()];
        (0..number.len()).filter(|&t| keep(self.skin.part_of[t])).zip(0..).for_each(|(t, new)| number[t] = new);
        let kept = |s: &Singularity| {
            let triangle = number[s.triangle as usize];
            (triangle != u32::MAX).then_some(Singularity { triangle, ..*s })
        };
        let singularities = self.singularities.iter().filter_map(kept).collect();
        Self { skin, fields, singularities, notes: self.notes.clone() }
    }

    /// Puts the skin into a pose, every part as the node shows it that `node_of` names. Hair follows it as a coat's does: by the
    /// map of the skin under its root, without growing longer where the skin is stretched.
    ///
    /// # Errors
    /// Where the pose takes a vertex beyond what f32 can hold.
    pub fn pose(
        &self,
        asset: &Asset,
        pose: &Pose,
        node_of: impl Fn(usize) -> usize,
        metres_per_unit: f64,
    ) -> Result<Self> {
        let Self { skin, mut fields, singularities, notes } = self.clone();
        let mut posed: HashMap<u32, Posed> = HashMap::new();
        for &(part, _) in &skin.stored {
            posed.entry(part).or_insert_with(|| {
                let index = part as usize;
                asset.parts[index].posed(asset, pose, node_of(index), metres_per_unit)
            });
        }
        // Normals turn with the skin, and so does the direction in which hair stands.
        let rest_normals = skin.mesh.smooth_normals();
        let mut mesh = skin.mesh;
        let rest_m = mesh.positions_m.clone();
        for (v, &(part, stored)) in skin.stored.iter().enumerate() {
            let (part, of, stored) = (&asset.parts[part as usize], &posed[&part], stored as usize);
            let local = part.local_from_world(stored) / metres_per_unit;
            let turn: Mat3 = (of.world_from_offset[stored].as_dmat3() * local).as_mat3();
            let normal = (turn.inverse().transpose() * rest_normals[v]).normalize_or(of.normals[stored]);
            let along = turn * fields.direction[v];
            fields.direction[v] = along.reject_from(normal).normalize_or_zero();
            fields.lean[v] = (turn * fields.lean[v]).normalize_or(normal);
            mesh.positions_m[v] = of.positions_m[stored];
            mesh.normals[v] = of.normals[stored];
        }
        for (triangle, part) in mesh.triangles.iter_mut().zip(&skin.part_of) {
            if posed[part].mirrored != asset.parts[*part as usize].mirrored() {
                triangle.swap(1, 2);
            }
        }
        let mesh = Mesh { rest_m: Some(rest_m), hair_normals: None, ..mesh }.checked()?;
        Ok(Self { skin: Skin { mesh, ..skin }, fields, singularities, notes })
    }

    /// Adds another skin with its hair, which nothing joins to this one.
    pub fn append(&mut self, next: Self) {
        let (mesh, other) = (&mut self.skin.mesh, next.skin.mesh);
        let first = mesh.positions_m.len() as u32;
        let own_rest = mesh.rest_m.take().unwrap_or_else(|| mesh.positions_m.clone());
        let other_rest = other.rest_m.unwrap_or_else(|| other.positions_m.clone());
        mesh.rest_m = Some([own_rest, other_rest].concat());
        mesh.positions_m.extend(other.positions_m);
        mesh.normals.extend(other.normals);
        mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        mesh.face_seeds.extend(other.face_seeds);
        mesh.position_class.extend(other.position_class.iter().map(|c| c + first));
        mesh.uv_sets.iter_mut().zip(other.uv_sets).for_each(|(own, other)| own.extend(other));
        mesh.hair_normals = None;
        // Nothing asks for these once the fields are there.
        (mesh.colour, mesh.fur_length, mesh.fur_region, mesh.fur_direction) = (None, None, None, None);
        self.skin.stored.extend(next.skin.stored);
        self.skin.part_of.extend(next.skin.part_of);
        let (fields, other) = (&mut self.fields, next.fields);
        fields.length.extend(other.length);
        fields.density.extend(other.density);
        fields.direction.extend(other.direction);
        fields.lean.extend(other.lean);
        fields.clump.extend(other.clump);
        fields.tint.extend(other.tint);
        if let (Some(paint), Some(other)) = (&mut fields.paint, other.paint) {
            let mut joined = Paint::clone(paint);
            joined.part_of.extend(&other.part_of);
            joined.factor.extend(&other.factor);
            joined.longest.extend(&other.longest);
            joined.density.extend(&other.density);
            *paint = Arc::new(joined);
        }
    }
}

/// A preset's maps, decoded.
///
/// # Errors
/// When one cannot be read.
pub fn decode(maps: &preset::Maps) -> Result<Maps> {
    let load = |path: &Option<std::path::PathBuf>| path.as_deref().map(image::load).transpose();
    Ok(Maps {
        density: load(&maps.density)?,
        length: load(&maps.length)?,
        comb: load(&maps.comb)?,
        colour: load(&maps.colour)?,
        clump: load(&maps.clump)?,
    })
}

/// Where a preset's colour map stands in for a texture of the asset.
pub const OF_PRESET: usize = usize::MAX;

/// What is painted on the parts: the asset's own colour or the preset's tint, and the preset's maps.
fn paint(
    asset: &Asset,
    skin: &Skin,
    role: &impl Fn(usize) -> Role,
    preset: &Preset,
    maps: &Arc<Maps>,
    notes: &mut Vec<String>,
) -> Result<Paint> {
    let mut images: HashMap<usize, Option<Arc<Image8>>> = HashMap::new();
    let colour_map = maps.colour.clone().map(|image| (Texture::plain(OF_PRESET, OF_PRESET, 0), Arc::new(image)));
    let mut parts = Vec::with_capacity(asset.parts.len());
    let mut factors = Vec::with_capacity(asset.parts.len());
    for (index, part) in asset.parts.iter().enumerate() {
        let role = role(index);
        if role == Role::Aside {
            factors.push((Vec3::ONE, false));
            parts.push(Painted::default());
            continue;
        }
        let BaseColour { factor, texture, .. } = &part.base_colour;
        let has_uv = !part.stored.uv_sets.is_empty();
        // Nothing is decoded that nobody sees.
        let of_asset = preset.colour.from == ColourSource::Asset && !(colour_map.is_some() && has_uv);
        let texture = texture.clone().filter(|texture| texture.uv_set < part.stored.uv_sets.len());
        let texture = texture.filter(|_| role == Role::Bare || of_asset);
        let colour = match texture {
            Some(texture) => {
                let image = match images.entry(texture.image) {
                    Entry::Occupied(known) => known.get().clone(),
                    Entry::Vacant(slot) => {
                        let decoded = match asset.document.decode_image(texture.image) {
                            // What has no fur is no reason to stop.
                            Err(error) if role == Role::Bare => {
                                let place = error.field.as_deref().unwrap_or_default();
                                notes.push(format!("{}: {place}; it is left out", error.what));
                                None
                            }
                            decoded => decoded?,
                        };
                        slot.insert(decoded.map(Arc::new)).clone()
                    }
                };
                image.map(|image| (texture, image))
            }
            None => None,
        };
        let told = colour.is_some() || part.stored.colour.is_some() || factor.truncate() != Vec3::ONE;
        // What is painted, the factor on it, and whether vertex colours are a factor too.
        let (painted, factor, by_vertex) = if role == Role::Bare {
            // The renderer tints all skin by the preset's factor, which is not for bare skin.
            let skin_factor = Vec3::from(preset.colour.skin).max(Vec3::splat(1e-6));
            (Painted { colour, maps: None, bare: true }, factor.truncate() / skin_factor, true)
        } else {
            if !maps.is_empty() && !has_uv {
                let name = &part.material_name;
                notes.push(format!("material {name:?} has no texture coordinates: groom maps are left out"));
            }
            let maps = has_uv.then(|| maps.clone());
            match colour_map.clone().filter(|_| has_uv) {
                Some(map) => (Painted { colour: Some(map), maps, bare: false }, Vec3::ONE, false),
                None if told && preset.colour.from == ColourSource::Asset => {
                    (Painted { colour, maps, bare: false }, factor.truncate(), true)
                }
                None => (Painted { colour: None, maps, bare: false }, Vec3::from(preset.colour.tint), false),
            }
        };
        factors.push((factor, by_vertex));
        parts.push(painted);
    }
    let colour = |v: usize| skin.mesh.colour.as_ref().map_or(Vec4::ONE, |colour| colour[v]).truncate();
    let factor = |(v, &(part, _)): (usize, &(u32, u32))| {
        let (factor, by_vertex) = factors[part as usize];
        if by_vertex { factor * colour(v) } else { factor }
    };
    Ok(Paint {
        parts,
        part_of: skin.stored.iter().map(|(part, _)| *part).collect(),
        factor: skin.stored.iter().enumerate().map(factor).collect(),
        longest: Vec::new(),
        density: vec![1.0; skin.stored.len()],
    })
}
