//! Floor 6: every step's parameters in one place, as TOML.

pub mod keys;
mod path;
mod settings;
mod wet;

use crate::coat::fins::FinParameters;
use crate::coat::shells::ShellParameters;
use crate::error::{Error, Result};
use crate::fur::groom::{Colour, Groom, Guard, Length, Undercoat};
use crate::shade::fibre::Fibres;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

pub use wet::Wet;

/// Images over the mesh's first UV set, named relative to the preset's file; each multiplies or replaces a field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Maps {
    /// Grey: factor on density.
    pub density: Option<PathBuf>,
    /// Grey: factor on length.
    pub length: Option<PathBuf>,
    /// RG: comb direction in tangent space, 128/255 for zero; alpha: factor on length.
    pub comb: Option<PathBuf>,
    /// sRGB: hair colour.
    pub colour: Option<PathBuf>,
    /// Grey: factor on clump strength.
    pub clump: Option<PathBuf>,
}

/// Another preset on a part of the skin, with a smooth passage into it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Region {
    /// Built-in preset or file (relative to this one), whose hair grows there.
    pub preset: String,
    /// Grey image over the first UV set: how much of that preset is there. Without it and `material`, the vertex attribute
    /// `_FUR_REGION`.
    pub map: Option<PathBuf>,
    /// Material that is all that preset's; what lies beside it passes into it over `reach`.
    pub material: Option<String>,
    /// How far the passage beside a material reaches, 20 mm without it.
    pub reach: Option<Length>,
}

impl Region {
    /// Checks that its place is told once, and how far it reaches.
    fn check(&self, number: usize) -> Result<()> {
        let fault = |key: &str, found: String, expected: &str| {
            Err(Error::usage("a region's place is not clear")
                .with_field(format!("regions[{number}].{key}"))
                .with_found(found)
                .with_expected(expected))
        };
        if let (Some(map), Some(_)) = (&self.map, &self.material) {
            return fault("map", map.display().to_string(), "a map or a material");
        }
        match self.reach {
            Some(_) if self.material.is_none() => {
                fault("reach", "no material".into(), "a material that it reaches beyond")
            }
            Some(reach) if !(reach.metres(1.0) > 0.0 && reach.metres(1.0) < 1e4) => {
                fault("reach", format!("{reach:?}"), "a length above 0")
            }
            _ => Ok(()),
        }
    }
}

/// A coat's recipe: one table per step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Preset {
    /// Name shown and stored; the file's name where empty.
    pub name: String,
    /// One line on what it is.
    pub description: String,
    /// Bounding diagonal of the animal or thing that the lengths describe, m; every preset must give it.
    #[schemars(range(min = 0.001, max = 1000.0))]
    pub size_m: f32,
    /// Guard hair.
    pub guard: Guard,
    /// Undercoat.
    pub undercoat: Undercoat,
    /// How hair lies.
    pub groom: Groom,
    /// Colour.
    pub colour: Colour,
    /// What hairs are made of, and so how they scatter light.
    pub fibre: Fibres,
    /// Water in it.
    pub wet: Wet,
    /// Groom maps.
    pub maps: Maps,
    /// Shell textures.
    pub shells: ShellParameters,
    /// Fin texture.
    pub fins: FinParameters,
    /// `[[regions]]`, at most 8, later ones over earlier ones: `preset`, the name or file (relative to this one) of what grows there,
    /// and `map`, a grey image over the first UV set that says how much of it; or `material`, which it covers, and `reach`, how far what
    /// lies beside passes into it; without either the vertex attribute `_FUR_REGION`.
    pub regions: Vec<Region>,
}

/// Presets are written by hand: anything larger than this many bytes is another kind of file.
const LARGEST_FILE: u64 = 1 << 20;

const BUILT_IN: &[(&str, &str)] = &[
    ("bear", include_str!("../../presets/bear.toml")),
    ("fox", include_str!("../../presets/fox.toml")),
    ("grass", include_str!("../../presets/grass.toml")),
    ("mink", include_str!("../../presets/mink.toml")),
    ("otter-wet", include_str!("../../presets/otter-wet.toml")),
    ("plush", include_str!("../../presets/plush.toml")),
    ("rabbit", include_str!("../../presets/rabbit.toml")),
    ("sheep", include_str!("../../presets/sheep.toml")),
    ("short-cat", include_str!("../../presets/short-cat.toml")),
];

impl Preset {
    /// Names of the built-in presets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// Names of the built-in presets, and what each says it is.
    pub fn descriptions() -> impl Iterator<Item = (&'static str, String)> {
        BUILT_IN.iter().map(|(name, text)| {
            let table: toml::Table = toml::from_str(text).unwrap_or_default();
            (*name, table.get("description").and_then(toml::Value::as_str).unwrap_or_default().to_owned())
        })
    }

    /// The text of a built-in preset's file.
    pub fn source(name: &str) -> Option<&'static str> {
        BUILT_IN.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
    }

    /// The TOML text behind a built-in preset's name or a file's path; a built-in name wins.
    ///
    /// # Errors
    /// Where there is neither, naming the presets there are, or the file cannot be read.
    pub fn source_of(name_or_file: &str) -> Result<String> {
        if let Some(text) = Self::source(name_or_file) {
            return Ok(text.to_owned());
        }
        let path = Path::new(name_or_file);
        let unreadable = |what: &str| Error::input(what).with_file(path);
        match std::fs::metadata(path) {
            Ok(about) if about.len() > LARGEST_FILE => Err(unreadable("the preset file is too large")
                .with_found(format!("{} bytes", about.len()))
                .with_expected(format!("at most {LARGEST_FILE} bytes"))),
            Ok(_) => std::fs::read_to_string(path)
                .map_err(|e| unreadable("the preset file cannot be read").with_found(e).with_expected("UTF-8 text")),
            Err(_) => Err(Error::usage("there is no such preset")
                .with_parameter("preset")
                .with_found(name_or_file)
                .with_expected(format!("a TOML file or one of {}", Self::names().collect::<Vec<_>>().join(", ")))
                .with_hint("`furrier presets list` says what each is")),
        }
    }

    /// The built-in preset of that name, or the one in that file: checked, named, its groom maps found relative to the
    /// file.
    ///
    /// # Errors
    /// As [`Self::source_of`] and [`Self::from_toml`].
    pub fn load(name_or_file: &str) -> Result<Self> {
        let text = Self::source_of(name_or_file)?;
        if Self::source(name_or_file).is_some() {
            return Self::from_toml(&text);
        }
        let path = Path::new(name_or_file);
        let mut preset = Self::from_toml(&text).map_err(|e| e.with_file(path))?;
        if preset.name.is_empty() {
            preset.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let maps = &mut preset.maps;
        for map in [&mut maps.density, &mut maps.length, &mut maps.comb, &mut maps.colour, &mut maps.clump] {
            *map = map.take().map(|relative| folder.join(relative));
        }
        for region in &mut preset.regions {
            region.map = region.map.take().map(|relative| folder.join(relative));
            if Self::source(&region.preset).is_none() {
                region.preset = folder.join(&region.preset).to_string_lossy().into_owned();
            }
        }
        Ok(preset)
    }

    /// Reads a preset from TOML. Unknown keys fail; every number is checked against its range.
    ///
    /// # Errors
    /// Names the key and line, or the value out of range.
    pub fn from_toml(text: &str) -> Result<Self> {
        let preset: Self = toml::from_str(text).map_err(|e| {
            Error::usage("the preset is not valid")
                .with_found(e.to_string().trim_end())
                .with_hint("`furrier presets show fox` prints a valid one, `furrier presets keys` every key")
        })?;
        preset.checked()
    }

    /// Checks every number against its documented range.
    ///
    /// # Errors
    /// Names the first key out of range.
    pub fn checked(self) -> Result<Self> {
        keys::check(&self)?;
        for (i, whorl) in self.groom.whorls.iter().enumerate() {
            whorl.check(&format!("groom.whorls[{i}]"))?;
        }
        for (i, stroke) in self.groom.strokes.iter().enumerate() {
            stroke.check(&format!("groom.strokes[{i}]"))?;
        }
        for (i, parting) in self.groom.partings.iter().enumerate() {
            parting.check(&format!("groom.partings[{i}]"))?;
        }
        if self.regions.len() > 8 {
            return Err(Error::usage("a preset has too many regions")
                .with_field("regions")
                .with_found(self.regions.len())
                .with_expected("at most 8"));
        }
        for (i, region) in self.regions.iter().enumerate() {
            region.check(i)?;
        }
        Ok(self)
    }
}
