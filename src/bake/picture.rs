//! A picture of an asset's fur by the hybrid renderer, without baking it.

use super::skin::{self, Groomed, Role};
use super::steps::Steps;
use super::unfollowed::variants;
use super::units::{self, Units};
use super::weld;
use crate::asset::strands::Export;
use crate::asset::{self, Asset, Part, Pose, Reading};
use crate::coat::hair::TileHair;
use crate::coat::primitive::{is_furred, offset_over_height};
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::data::subject::Subject;
use crate::error::Result;
use crate::fur::groom::fibre::Fibre;
use crate::fur::groom::refine::{Finest, refine};
use crate::fur::grow;
use crate::hybrid::device::{self, Device, Drawn};
use crate::hybrid::{self, Picture, Settings};
use crate::math::{DMat3, DVec3, Vec3};
use crate::preset::Preset;
use crate::reference;
use crate::reference::walk::{self, Walked};
use crate::volume::scene::{HairScattering, Lighting, Scene};

/// The finest that what is painted is told apart in undercoat, in parts of what is furred: hair carries a colour further than that
/// from its root.
const FINEST: f32 = 250.0;
/// Most triangles that the skin is cut into for it.
const MOST_TRIANGLES: usize = 400_000;

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
#[derive(Clone, Debug, PartialEq)]
pub struct PictureRequest {
    /// A file, or `sample:NAME`.
    pub input: String,
    /// How it is read.
    pub reading: Reading,
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
    scattering: HairScattering,
    skin_factor: Vec3,
    only: Only,
    metres_per_unit: f64,
    /// As in [`Reading::upright`].
    upright: Option<DMat3>,
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
        let asset = asset::load_as(&request.input, &request.reading)?;
        let selection = asset::select(&asset.parts, &request.materials)?;
        let chosen = selection.parts;
        let preset = &request.preset.wetted();
        let scale = units::scale(request.units, preset, &asset, &chosen, request.input.starts_with("sample:"))?;
        let mut notes = asset.warnings.clone();
        notes.extend(selection.note);
        notes.extend(selection.warnings);
        notes.extend(variants(&asset, &chosen));
        notes.extend(scale.note.iter().chain(&scale.warnings).cloned());
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
        let furred = |part: usize| chosen.contains(&part);
        let skin = weld::join(&asset, furred, scale.metres_per_unit, fibre.length_m)?;
        let role = |part: usize| if furred(part) { Role::Furred } else { Role::Bare };
        let whole = skin::groom(&asset, &skin, role, preset, &scale, &mut Steps::new(&mut |_| (), None))?;
        let hair_m = reaches_m(&asset, &whole, tile.height_m);
        let groomed = shown(&asset, whole, pose.as_ref(), scale.metres_per_unit)?;
        notes.extend(groomed.notes.iter().cloned());
        let mut groomed = groomed;
        let finest = Finest { edge_m: diagonal_m / FINEST, triangles: MOST_TRIANGLES };
        let mut strands = grow::skin::grow(&fibre, groomed.mesh(), &groomed.fields, request.seed);
        if let Some(refined) = refine(groomed.mesh(), &groomed.fields, finest) {
            refined.move_roots(&mut strands.roots);
            if refined.coarse {
                notes.push(
                    "a texture is finer than undercoat can show: its finest detail is seen on guard hair alone".into(),
                );
            }
            groomed.skin.mesh = refined.mesh;
            groomed.fields = refined.fields;
        }
        Ok(Self {
            guard: (strands, fibre),
            undercoat,
            scattering: HairScattering::new(&preset.fibre, &preset.wet.film())?,
            skin_factor: Vec3::from(preset.colour.skin),
            only: request.only,
            metres_per_unit: scale.metres_per_unit,
            upright: asset.scene.upright,
            groomed,
            subject: asset.subject(scale.metres_per_unit, |part, v| hair_m[part][v])?,
            notes,
        })
    }

    /// Where the origin of the renderer's coordinates lies in the world, m.
    pub fn origin_m(&self) -> DVec3 {
        self.groomed.mesh().origin_m
    }

    /// Length of the preset's guard hair, m.
    pub fn hair_m(&self) -> f32 {
        self.guard.1.length_m
    }

    /// The guard hairs, to be written to a file; `name` is what they are called there.
    pub fn export<'a>(&'a self, name: &'a str) -> Export<'a> {
        Export {
            strands: &self.guard.0,
            origin_m: self.origin_m(),
            metres_per_unit: self.metres_per_unit,
            file_from_world: self.upright.map_or(DMat3::IDENTITY, |turn| turn.transpose()),
            name,
        }
    }

    /// What the renderer needs.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            skin: self.groomed.mesh(),
            fields: &self.groomed.fields,
            skin_factor: self.skin_factor,
            guard: (self.only != Only::Undercoat).then_some((&self.guard.0, &self.guard.1)),
            undercoat: (self.only != Only::Guard).then_some(&self.undercoat),
            scattering: &self.scattering,
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

    /// Follows light through the same hair from scattering to scattering.
    ///
    /// # Errors
    /// As [`walk::draw`].
    pub fn walk(&self, lighting: &Lighting, camera: &Camera, settings: &walk::Settings) -> Result<Walked> {
        walk::draw(&self.scene(), lighting, camera, settings)
    }
}

/// How far hair reaches from each vertex of each part, m, as a bake would store it: 0 where none grows.
fn reaches_m(asset: &Asset, groomed: &Groomed, height_m: f32) -> Vec<Vec<f32>> {
    let mut reaches_m: Vec<Vec<f32>> = asset.parts.iter().map(|part| vec![0.0; part.vertices()]).collect();
    let triangles = groomed.mesh().triangles.iter().map(|t| t.map(|v| v as usize));
    for v in triangles.filter(|t| is_furred(&groomed.fields, *t)).flatten() {
        let (part, stored) = groomed.skin.stored[v];
        let reach_m = &mut reaches_m[part as usize][stored as usize];
        *reach_m = reach_m.max(offset_over_height(&groomed.fields, v).length() * height_m);
    }
    reaches_m
}

/// The skin as the scene shows it: in a pose, once more for every further node of a mesh, and without what is hidden.
fn shown(asset: &Asset, rest: Groomed, pose: Option<&Pose>, metres_per_unit: f64) -> Result<Groomed> {
    let seen = |part: &Part| part.nodes.iter().copied().filter(|&node| !asset.scene.hidden[node]).collect();
    let nodes: Vec<Vec<usize>> = asset.parts.iter().map(seen).collect();
    let most = nodes.iter().map(Vec::len).max().unwrap_or(0);
    let at_rest = asset.rest_pose()?;
    let as_it_is = asset.parts.iter().zip(&nodes).all(|(part, nodes)| nodes.first() == part.nodes.first());
    let mut all: Option<Groomed> = None;
    for number in 0..most {
        let node = |part: usize| nodes[part][number];
        let here = |part: u32| nodes[part as usize].len() > number;
        let next = match (number, pose) {
            (0, None) if as_it_is => rest.clone(),
            (0, Some(pose)) if as_it_is => rest.pose(asset, pose, node, metres_per_unit)?,
            (_, pose) => rest.cut(here).pose(asset, pose.unwrap_or(&at_rest), node, metres_per_unit)?,
        };
        match &mut all {
            None => all = Some(next),
            Some(all) => all.append(next),
        }
    }
    Ok(all.unwrap_or(rest))
}
