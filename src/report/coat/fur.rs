//! The fur that a coat stands for, drawn hair by hair where no picture of it was kept.

use super::keep::{Cost, Drawing, Keep, Of};
use super::key::Key;
use super::views;
use crate::bake::picture::{Grown, PictureRequest};
use crate::coat::fins::FinParameters;
use crate::coat::shells::ShellParameters;
use crate::data::camera::Camera;
use crate::data::film::Layers;
use crate::data::subject::Subject;
use crate::error::Result;
use crate::hybrid::device::{self, Device};
use crate::hybrid::{self, Prepared, Settings};
use crate::metrics::compare::LinearImage;
use crate::preset::Preset;
use crate::stage::camera::Orbit;
use crate::stage::light::Lit;
use crate::stage::rig::Rig;
use crate::volume::scene::Lighting;
use std::sync::OnceLock;
use std::time::Instant;

/// Raised whenever `final` draws another picture of the same fur, so that none of an earlier one is taken for it.
const EPOCH: u32 = 2;

/// What grows and what draws it; it grows when it is first needed.
pub struct Fur {
    request: PictureRequest,
    device: Device,
    size: [u32; 2],
    /// Of all that decides the fur and how it is drawn.
    key: Key,
    subject: Subject,
    hair_m: f32,
    grown: OnceLock<Grown>,
}

/// Lights as they fall from where a camera stands.
pub struct Light {
    /// As the coat has them.
    pub lit: Lit,
    lighting: Lighting,
}

/// Draws fur in one light from one direction, however far.
pub struct Painter<'a> {
    fur: &'a Fur,
    light: &'a Light,
    prepared: Option<Prepared<'a>>,
    /// What a person should know of the drawing, one sentence each.
    pub notes: Vec<String>,
}

impl Fur {
    /// Grows fur.
    ///
    /// # Errors
    /// As [`Grown::new`].
    pub fn new(request: PictureRequest, device: Device, size: [u32; 2]) -> Result<Self> {
        let grown = Grown::new(&request)?;
        let (subject, hair_m) = (grown.subject.clone(), grown.hair_m());
        let key = key(&request, &device)?;
        Ok(Self { request, device, size, key, subject, hair_m, grown: OnceLock::from(grown) })
    }

    /// The same but for where every hair stands.
    ///
    /// # Errors
    /// Where its key cannot be made.
    pub fn of_another_seed(&self) -> Result<Self> {
        let request = PictureRequest { seed: self.request.seed.wrapping_add(1), ..self.request.clone() };
        let key = key(&request, &self.device)?;
        let (device, subject) = (self.device.clone(), self.subject.clone());
        Ok(Self { request, device, key, subject, grown: OnceLock::new(), size: self.size, hair_m: self.hair_m })
    }

    /// What a person should know, one sentence each.
    pub fn notes(&self) -> &[String] {
        self.grown.get().map_or(&[], |grown| &grown.notes)
    }

    /// Length of the preset's guard hair, m.
    pub fn hair_m(&self) -> f32 {
        self.hair_m
    }

    /// The camera of a view.
    pub fn camera(&self, orbit: &Orbit) -> Camera {
        orbit.camera(&self.subject, f64::from(self.size[0]) / f64::from(self.size[1].max(1)))
    }

    /// The lights of view `number` of `most`, whatever its distance.
    pub fn light(&self, rig: Rig, number: usize, most: usize) -> Light {
        let lit = rig.lit(&self.camera(&views::orbit(number, most, 1.0)));
        Light { lighting: Lighting::new(&lit), lit }
    }

    fn grown(&self) -> Result<&Grown> {
        match self.grown.get() {
            Some(grown) => Ok(grown),
            None => {
                let grown = Grown::new(&self.request)?;
                Ok(self.grown.get_or_init(|| grown))
            }
        }
    }
}

impl<'a> Painter<'a> {
    /// Of `fur` in `light`.
    pub fn new(fur: &'a Fur, light: &'a Light) -> Self {
        Self { fur, light, prepared: None, notes: Vec::new() }
    }

    /// The picture by `final`, and whether it had to be drawn; `tell` is called where it is.
    ///
    /// # Errors
    /// As [`Grown::new`] and [`device::draw`]; where it cannot be kept.
    pub fn render(&mut self, camera: &Camera, keep: &mut Keep, tell: &mut dyn FnMut()) -> Result<(Drawing, bool)> {
        let Self { fur, light, .. } = *self;
        let key = fur.key.with(camera).with(&light.lit).with(fur.size);
        if let Some(kept) = keep.get(Of::Render, key, fur.size) {
            return Ok((kept, false));
        }
        tell();
        let start = Instant::now();
        let prepared = match self.prepared.take() {
            Some(prepared) => prepared,
            None => {
                let settings = Settings { layers: Layers::Light, ..Settings::best(fur.size.map(|n| n as usize)) };
                hybrid::prepare(&fur.grown()?.scene(), &light.lighting, &settings)?
            }
        };
        let drawn = device::draw(&fur.device, self.prepared.insert(prepared), camera)?;
        self.notes.extend(drawn.notes);
        let cost = Cost { ms: start.elapsed().as_secs_f64() * 1e3, triangles: None };
        let drawing = Drawing { picture: LinearImage::from(&drawn.picture.film), cost };
        keep.put(Of::Render, key, &drawing)?;
        Ok((drawing, true))
    }
}

/// Of all that decides the fur and how it is drawn: not of what only the coat has.
fn key(request: &PictureRequest, device: &Device) -> Result<Key> {
    let preset = Preset {
        name: String::new(),
        description: String::new(),
        shells: ShellParameters { tile_mm: request.preset.shells.tile_mm, ..ShellParameters::default() },
        fins: FinParameters::default(),
        ..request.preset.clone()
    };
    Key::default()
        .with(EPOCH)
        .asset(&request.input)?
        .preset(&preset)
        .map(|key| key.with(&request.materials).with(request.units).with(request.seed).with(request.only))
        .map(|key| key.with(&request.pose).with(device))
}
