//! What decides a coat beside its input: choices as people make them, and the recipe that they come to.

use super::units::Units;
use super::{Method, Request};
use crate::asset::Reading;
use crate::asset::axes::{Axis, Upright};
use crate::asset::coat::Fallback;
use crate::error::{Error, Result};
use crate::preset::Preset;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How the skin is laid out in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// Lapped patches.
    #[default]
    Lapped,
    /// Charts with texels of their own.
    Atlas,
    /// The asset's own coordinates.
    Uv,
}

/// What a coat is to be drawn by, in a word: how many slabs and texels it can do with. What is chosen beside it goes before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// As presets say.
    #[default]
    Desktop,
    /// Two eyes at a high rate.
    Vr,
    /// Files that are waited for.
    Web,
    /// Little memory, few reads.
    Phone,
}

impl Target {
    /// Layers and texels along a tile's edge, where they are others than the preset's.
    fn shells(self) -> Option<[u32; 2]> {
        match self {
            Self::Desktop => None,
            Self::Vr => Some([9, 128]),
            Self::Web => Some([9, 64]),
            Self::Phone => Some([4, 64]),
        }
    }

    /// What viewers without the extension see.
    fn fallback(self) -> Fallback {
        Fallback::Shells(match self {
            Self::Desktop | Self::Vr => 8,
            Self::Web => 4,
            Self::Phone => 2,
        })
    }
}

/// What was chosen, by name where things have names.
#[derive(Clone, Debug, PartialEq)]
pub struct Choices {
    /// `[MATERIAL=]NAME|FILE`; `fox` for what none of them names.
    pub presets: Vec<String>,
    /// `table.key=value`, applied in order to every preset.
    pub settings: Vec<String>,
    /// Materials to fur; empty for all that are not by name bare.
    pub materials: Vec<String>,
    /// What a unit of the file means.
    pub units: Units,
    /// Texture coordinates.
    pub layout: Layout,
    /// Which set of the asset's own coordinates; the first where none is named.
    pub uv_set: Option<usize>,
    /// Instead of every preset's layers.
    pub layers: Option<u32>,
    /// Instead of every preset's texels; of the whole atlas where there is one.
    pub texture_size: Option<u32>,
    /// Decides all that is random.
    pub seed: u64,
    /// What viewers without the extension see; what the target says where nothing is chosen.
    pub fallback: Option<Fallback>,
    /// What the coat is to be drawn by.
    pub target: Target,
    /// Which axis of the file is up; glTF's where none is named.
    pub up: Option<Axis>,
    /// Which of them its front looks along.
    pub forward: Option<Axis>,
    /// Whether coarser levels of detail are furred too.
    pub lods: bool,
}

impl Default for Choices {
    fn default() -> Self {
        Self {
            presets: Vec::new(),
            settings: Vec::new(),
            materials: Vec::new(),
            units: Units::Auto,
            layout: Layout::Lapped,
            uv_set: None,
            layers: None,
            texture_size: None,
            seed: 0,
            fallback: None,
            target: Target::Desktop,
            up: None,
            forward: None,
            lods: false,
        }
    }
}

/// All that decides a coat beside its input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Preset of all materials without one of their own.
    pub preset: Preset,
    /// Presets of single materials, by name.
    pub presets: Vec<(String, Preset)>,
    /// Materials to fur; empty for all that are not by name bare.
    pub materials: Vec<String>,
    /// What a unit of the file means.
    pub units: Units,
    /// Texture coordinates.
    pub method: Method,
    /// Decides all that is random.
    pub seed: u64,
    /// What viewers without the extension see.
    pub fallback: Fallback,
    /// How the file's axes lie, where not as glTF's.
    #[serde(default)]
    pub upright: Option<Upright>,
    /// Whether coarser levels of detail are furred too.
    #[serde(default)]
    pub lods: bool,
    /// See [`Request::draft`].
    pub draft: bool,
}

impl Choices {
    /// Reads the presets and sets what is to be set.
    ///
    /// # Errors
    /// Where a preset cannot be read, a setting is not valid, or two choices cannot both be.
    pub fn recipe(&self) -> Result<Recipe> {
        let mut preset = None;
        let mut presets: Vec<(String, Preset)> = Vec::new();
        for choice in &self.presets {
            let (material, name) = split_choice(choice);
            let chosen = self.adjusted(Preset::load(name)?)?;
            let doubled = match material {
                Some(material) if presets.iter().any(|(m, _)| m == material) => Some(material),
                Some(material) => {
                    presets.push((material.to_owned(), chosen));
                    None
                }
                None => preset.replace(chosen).map(|_| "all materials"),
            };
            if let Some(material) = doubled {
                return Err(Error::usage("two presets are given for the same material")
                    .with_parameter("preset")
                    .with_found(format!("{choice}, after another one for {material}"))
                    .with_expected("one preset for all materials, and one for each material by name"));
            }
        }
        let preset = match preset {
            Some(preset) => preset,
            None => self.adjusted(Preset::load("fox")?)?,
        };
        if self.uv_set.is_some() && self.layout != Layout::Uv {
            return Err(Error::usage("a UV set is chosen, but not used")
                .with_parameter("uv set")
                .with_hint("add `parameterisation` uv"));
        }
        Ok(Recipe {
            preset,
            presets,
            materials: self.materials.clone(),
            units: self.units,
            method: match self.layout {
                Layout::Lapped => Method::Lapped,
                Layout::Atlas => Method::Atlas { texels: self.texture_size },
                Layout::Uv => Method::Uv(self.uv_set.unwrap_or(0)),
            },
            seed: self.seed,
            fallback: self.fallback.unwrap_or(self.target.fallback()),
            upright: Upright::of(self.up, self.forward)?,
            lods: self.lods,
            draft: false,
        })
    }

    /// `preset` with what was chosen instead.
    fn adjusted(&self, preset: Preset) -> Result<Preset> {
        let mut preset = preset;
        if let Some([layers, texels]) = self.target.shells() {
            (preset.shells.layers, preset.shells.texture_size) = (layers, texels);
        }
        let mut preset = preset.with_settings(&self.settings)?;
        preset.shells.layers = self.layers.unwrap_or(preset.shells.layers);
        preset.shells.texture_size = self.texture_size.unwrap_or(preset.shells.texture_size);
        preset.checked()
    }
}

impl Recipe {
    /// The presets, that of all materials first.
    pub fn all_presets(&self) -> impl Iterator<Item = &Preset> {
        std::iter::once(&self.preset).chain(self.presets.iter().map(|(_, preset)| preset))
    }

    /// How its inputs are read.
    pub fn reading(&self) -> Reading {
        Reading { upright: self.upright.map(Upright::turn), lods: self.lods, ..Reading::default() }
    }

    /// A bake of `input` into `out`.
    pub fn request(&self, input: &str, out: &Path, judge: bool) -> Request {
        Request {
            input: input.to_owned(),
            reading: self.reading(),
            out: out.to_owned(),
            preset: self.preset.clone(),
            presets: self.presets.clone(),
            materials: self.materials.clone(),
            units: self.units,
            method: self.method,
            seed: self.seed,
            fallback: self.fallback,
            judge,
            cache: None,
            draft: self.draft,
        }
    }
}

/// `[MATERIAL=]NAME|FILE`: what is a preset as it stands has no material.
pub fn split_choice(choice: &str) -> (Option<&str>, &str) {
    match choice.split_once('=') {
        Some((material, name)) if Preset::source_of(choice).is_err() => (Some(material), name),
        _ => (None, choice),
    }
}
