//! A picture of an asset's fur by the hybrid renderer, without baking it.

use super::skin::{self, Groomed};
use super::units::{self, Units};
use crate::asset;
use crate::asset::strands::Export;
use crate::coat::hair::TileHair;
use crate::coat::primitive::{is_furred, offset_over_height};
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::data::mesh::Mesh;
use crate::data::subject::Subject;
use crate::error::Result;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::hybrid::device::{self, Device, Drawn};
use crate::hybrid::{self, Picture, Settings};
use crate::math::{DVec3, Vec3};
use crate::preset::Preset;
use crate::reference;
use crate::volume::scene::{HairScattering, Lighting, Scene};

/// Which hair is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Only {
    /// Guard hair as strands and undercoat as a volume.
    Hybrid,
    /// Guard hair.
    Guard,
    /// Undercoat.
    Undercoat,
}

/// What to depict.
#[derive(Clone, Debug)]
pub struct PictureRequest {
    /// A file, or `sample:NAME`.
    pub input: String,
    /// Preset of all furred materials.
    pub preset: Preset,
    /// Materials to fur; empty for all that are not by name bare.
    pub materials: Vec<String>,
    /// What a unit of the file means.
    pub units: Units,
    /// Decides all that is random.
    pub seed: u64,
    /// Which hair is drawn.
    pub only: Only,
    /// An animation by name or number, and seconds into it; the rest pose without.
    pub pose: Option<(String, f64)>,
}

/// Skin and hair, grown and ready to be drawn.
#[derive(Debug)]
pub struct Grown {
    groomed: Groomed,
    guard: (crate::data::strands::Strands, Fibre),
    undercoat: Fibre,
    skin_factor: Vec3,
    only: Only,
    metres_per_unit: f64,
    /// What cameras and lights need to know of the asset. It is that of the rest pose, so that a camera stands still while an
    /// animation plays.
    pub subject: Subject,
    /// What a person should know, one sentence each.
    pub notes: Vec<String>,
}

impl Grown {
    /// Reads, grooms and grows a request. All parts become one skin; those without fur are bare.
    ///
    /// # Errors
    /// When the input cannot be used or names something that is not there.
    pub fn new(request: &PictureRequest) -> Result<Self> {
        let asset = asset::load(&request.input)?;
        let chosen = asset::select(&asset.parts, &request.materials)?;
        let preset = &request.preset;
        let scale = units::scale(request.units, preset, &asset, request.input.starts_with("sample:"))?;
        let mut notes = asset.warnings.clone();
        notes.extend(scale.note.clone());
        let pose = match &request.pose {
            Some((animation, seconds)) => {
                let index = asset.animation(animation).map_err(|e| e.with_parameter("pose"))?;
                Some(asset.pose(index, *seconds)?)
            }
            None => None,
        };
        let diagonal_m = scale.diagonal_m as f32;
        let fibre = Fibre::guard(&preset.guard, &preset.colour, diagonal_m);
        let undercoat = Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m);
        let tile = TileHair::grow(&fibre, &undercoat, preset.shells.tile_mm * 1e-3, request.seed);
        let mut hair_m = Vec::with_capacity(asset.parts.len());
        let mut all: Option<Groomed> = None;
        for (index, part) in asset.parts.iter().enumerate() {
            let mut groomed = skin::groom(&asset, part, preset, &scale)?;
            if !chosen.contains(&index) {
                groomed.fields.density.fill(0.0);
                // The renderer tints all skin by the preset's factor, which is not for bare skin.
                let factor = Vec3::from(preset.colour.skin).max(Vec3::splat(1e-6));
                let own = skin::bare_colour(&asset, part, &groomed.mesh)?;
                groomed.fields.tint = own.into_iter().map(|colour| colour / factor).collect();
            }
            hair_m.push(reaches_m(&groomed, tile.height_m));
            if let Some(pose) = &pose {
                groomed = groomed.pose(&asset, part, pose, scale.metres_per_unit)?;
            }
            notes.append(&mut groomed.notes);
            match &mut all {
                None => all = Some(groomed),
                Some(all) => join(all, groomed),
            }
        }
        let groomed = all.unwrap_or_else(|| unreachable!("an asset without parts is refused when it is read"));
        let strands = grow::skin::grow(&fibre, &groomed.mesh, &groomed.fields, request.seed);
        Ok(Self {
            guard: (strands, fibre),
            undercoat,
            skin_factor: Vec3::from(preset.colour.skin),
            only: request.only,
            metres_per_unit: scale.metres_per_unit,
            groomed,
            subject: asset.subject(scale.metres_per_unit, |part, v| hair_m[part][v])?,
            notes,
        })
    }

    /// Where the origin of the renderer's coordinates lies in the world, m.
    pub fn origin_m(&self) -> DVec3 {
        self.groomed.mesh.origin_m
    }

    /// The guard hairs, to be written to a file; `name` is what they are called there.
    pub fn export<'a>(&'a self, name: &'a str) -> Export<'a> {
        Export { strands: &self.guard.0, origin_m: self.origin_m(), metres_per_unit: self.metres_per_unit, name }
    }

    /// What the renderer needs.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            skin: &self.groomed.mesh,
            fields: &self.groomed.fields,
            skin_factor: self.skin_factor,
            guard: (self.only != Only::Undercoat).then_some((&self.guard.0, &self.guard.1)),
            undercoat: (self.only != Only::Guard).then_some(&self.undercoat),
            scattering: HairScattering::default(),
        }
    }

    /// Renders a picture on the CPU.
    ///
    /// # Errors
    /// As [`hybrid::draw`].
    pub fn draw(&self, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Picture> {
        hybrid::draw(&self.scene(), lighting, camera, settings)
    }

    /// Renders a picture on a device.
    ///
    /// # Errors
    /// As [`device::draw`].
    pub fn draw_on(&self, device: &Device, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Drawn> {
        device::draw(device, &hybrid::prepare(&self.scene(), lighting, settings)?, camera)
    }

    /// Renders what [`Self::draw`] should have drawn, slowly.
    ///
    /// # Errors
    /// As [`reference::draw`].
    pub fn reference(&self, lighting: &Lighting, camera: &Camera, settings: &reference::Settings) -> Result<Film> {
        reference::draw(&self.scene(), lighting, camera, settings)
    }
}

/// How far hair reaches from each vertex, m, as a bake would store it: 0 where none grows.
fn reaches_m(groomed: &Groomed, height_m: f32) -> Vec<f32> {
    let Groomed { mesh, fields, .. } = groomed;
    let mut reaches_m = vec![0.0; mesh.positions_m.len()];
    let furred = mesh.triangles.iter().map(|t| t.map(|v| v as usize)).filter(|t| is_furred(fields, *t));
    furred.flatten().for_each(|v| reaches_m[v] = offset_over_height(fields, v).length() * height_m);
    reaches_m
}

/// Adds a part's skin and fields to those before it.
fn join(all: &mut Groomed, next: Groomed) {
    let (mesh, other): (&mut Mesh, Mesh) = (&mut all.mesh, next.mesh);
    let first = mesh.positions_m.len() as u32;
    let shift = (other.origin_m - mesh.origin_m).as_vec3();
    mesh.positions_m.extend(other.positions_m.iter().map(|&p| p + shift));
    if let (Some(rest), Some(other)) = (&mut mesh.rest_m, other.rest_m) {
        rest.extend(other.iter().map(|&p| p + shift));
    }
    mesh.normals.extend(other.normals);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    mesh.position_class.extend(other.position_class.iter().map(|c| c + first));
    let (fields, other) = (&mut all.fields, next.fields);
    fields.length.extend(other.length);
    fields.density.extend(other.density);
    fields.direction.extend(other.direction);
    fields.lean.extend(other.lean);
    fields.clump.extend(other.clump);
    fields.tint.extend(other.tint);
}
