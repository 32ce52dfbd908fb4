//! A picture of an asset's fur by the hybrid renderer, without baking it.

use super::skin::{self, Groomed};
use super::units::{self, Units};
use crate::asset;
use crate::asset::strands::Export;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::data::light::Directional;
use crate::data::mesh::Mesh;
use crate::error::Result;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::hybrid::device::{self, Device, Drawn};
use crate::hybrid::{self, Picture, Settings};
use crate::math::{DVec3, Vec3};
use crate::preset::Preset;
use crate::reference;
use crate::volume::scene::{HairScattering, Lighting, Scene};
use std::f32::consts::PI;

/// Vertical field of view of cameras that frame, degrees.
const VFOV_DEG: f64 = 34.0;

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
                let index = asset.animation(animation).map_err(|e| e.with_field("--pose"))?;
                Some(asset.pose(index, *seconds)?)
            }
            None => None,
        };
        let mut all: Option<Groomed> = None;
        for (index, part) in asset.parts.iter().enumerate() {
            let mut groomed = skin::groom(&asset, part, preset, &scale)?;
            if !chosen.contains(&index) {
                groomed.fields.density.fill(0.0);
            }
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
        let diagonal_m = scale.diagonal_m as f32;
        let fibre = Fibre::guard(&preset.guard, &preset.colour, diagonal_m);
        let strands = grow::skin::grow(&fibre, &groomed.mesh, &groomed.fields, request.seed);
        Ok(Self {
            guard: (strands, fibre),
            undercoat: Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m),
            skin_factor: Vec3::from(preset.colour.skin),
            only: request.only,
            metres_per_unit: scale.metres_per_unit,
            groomed,
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

    /// A camera at an azimuth and elevation that frames skin and hair; `distance` 1 fills the picture's height or width.
    /// It frames the rest pose, so that it stands still while an animation plays.
    pub fn camera(&self, azimuth_deg: f32, elevation_deg: f32, distance: f32, size: [usize; 2]) -> Camera {
        let mesh = &self.groomed.mesh.at_rest();
        let (low, high) = mesh.bounds_m();
        let hair_m = self.guard.1.longest_m().max(self.undercoat.longest_m());
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.clamp(-89.0, 89.0).to_radians());
        let (sin, cos) = libm::sincosf(elevation);
        let towards = Vec3::new(libm::sinf(azimuth) * cos, sin, libm::cosf(azimuth) * cos);
        let target_m = 0.5 * (low + high);
        // How far each vertex asks the eye to stand back, across and up the picture.
        let forward = -towards;
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let up = right.cross(forward);
        let half = libm::tanf(0.5 * VFOV_DEG.to_radians() as f32);
        let aspect = size[0] as f32 / size[1] as f32;
        let back_m = mesh.positions_m.iter().fold(0.0_f32, |back, &p| {
            let q = p - target_m;
            let reach = ((q.dot(up).abs() + hair_m) / half).max((q.dot(right).abs() + hair_m) / (half * aspect));
            back.max(reach - q.dot(forward))
        });
        let world = |p: Vec3| (mesh.origin_m + p.as_dvec3()).to_array();
        Camera {
            eye: world(target_m + towards * (back_m * distance)),
            target: world(target_m),
            up: [0.0, 1.0, 0.0],
            vfov_deg: VFOV_DEG,
        }
    }
}

/// A key light over the left shoulder of a camera, and a tenth of its light from everywhere.
pub fn studio(camera: &Camera) -> Lighting {
    let [right, up, back] = camera.axes().map(|axis| axis.as_vec3());
    let to_light = (up * 0.8 + back * 0.7 - right * 0.9).normalize();
    let key = Directional { to_light, irradiance: Vec3::splat(2.2 * PI) }.into();
    Lighting { key, fill: Vec::new(), ambient: Vec3::splat(0.6), fill_on_undercoat: false }
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
