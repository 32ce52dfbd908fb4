//! Floor 6: every step's parameters in one place, as TOML.

use crate::coat::fins::FinParameters;
use crate::coat::shells::ShellParameters;
use crate::error::{Error, Result};
use crate::fur::groom::{Colour, Groom, Guard, Undercoat};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

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

/// A coat's recipe: one table per step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Preset {
    /// Name shown and stored; the file's name where empty.
    pub name: String,
    /// One line on what it is.
    pub description: String,
    /// Bounding diagonal of the animal or thing that the lengths describe, m.
    pub size_m: f32,
    /// Guard hair.
    pub guard: Guard,
    /// Undercoat.
    pub undercoat: Undercoat,
    /// How hair lies.
    pub groom: Groom,
    /// Colour.
    pub colour: Colour,
    /// Groom maps.
    pub maps: Maps,
    /// Shell textures.
    pub shells: ShellParameters,
    /// Fin texture.
    pub fins: FinParameters,
}

const BUILT_IN: &[(&str, &str)] = &[
    ("bear", include_str!("../presets/bear.toml")),
    ("fox", include_str!("../presets/fox.toml")),
    ("grass", include_str!("../presets/grass.toml")),
    ("mink", include_str!("../presets/mink.toml")),
    ("otter-wet", include_str!("../presets/otter-wet.toml")),
    ("plush", include_str!("../presets/plush.toml")),
    ("rabbit", include_str!("../presets/rabbit.toml")),
    ("sheep", include_str!("../presets/sheep.toml")),
    ("short-cat", include_str!("../presets/short-cat.toml")),
];

impl Preset {
    /// Names of the built-in presets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// The text of a built-in preset's file.
    pub fn source(name: &str) -> Option<&'static str> {
        BUILT_IN.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
    }

    /// Reads a preset from TOML. Unknown keys fail; every number is checked against its range.
    ///
    /// # Errors
    /// Names the key and line, or the value out of range.
    pub fn from_toml(text: &str) -> Result<Self> {
        let preset: Self = toml::from_str(text).map_err(|e| {
            Error::usage("the preset is not valid")
                .with_found(e.to_string().trim_end())
                .with_hint("`furrier presets show fox` prints a valid one; docs/presets.md lists every key")
        })?;
        preset.checked()
    }

    /// Checks every number against its documented range.
    ///
    /// # Errors
    /// Names the first key out of range.
    pub fn checked(self) -> Result<Self> {
        let (g, u) = (&self.guard, &self.undercoat);
        let ranges = [
            ("size_m", self.size_m, 1e-3, 1e3),
            ("guard.density_per_cm2", g.density_per_cm2, 0.0, 1e6),
            ("guard.diameter_um", g.diameter_um, 0.1, 1e5),
            ("guard.taper", g.taper, 0.0, 1.0),
            ("guard.tip_transparency", g.tip_transparency, 0.0, 1.0),
            ("undercoat.density_per_cm2", u.density_per_cm2, 0.0, 1e6),
            ("undercoat.diameter_um", u.diameter_um, 0.1, 1e5),
            ("groom.lean_deg", self.groom.lean_deg, 0.0, 75.0),
            ("groom.gravity", self.groom.gravity, 0.0, 1.0),
            ("colour.variation", self.colour.variation, 0.0, 1.0),
        ];
        let shapes = [("guard", &g.shape, g.length), ("undercoat", &u.shape, u.length)].into_iter().flat_map(
            |(table, s, length)| {
                let length = match length {
                    crate::fur::groom::Length::Mm(mm) => ("length.mm", mm, 1e-3, 1e4),
                    crate::fur::groom::Length::Relative(share) => ("length.relative", share, 1e-5, 2.0),
                };
                [
                    length,
                    ("shape.length_variation", s.length_variation, 0.0, 0.5),
                    ("shape.bend_deg", s.bend_deg, 0.0, 120.0),
                    ("shape.jitter_deg", s.jitter_deg, 0.0, 45.0),
                    ("shape.noise", s.noise, 0.0, 0.5),
                    ("shape.curl.radius_mm", s.curl.radius_mm, 0.0, 1e3),
                    ("shape.curl.turns", s.curl.turns, 0.0, 20.0),
                    ("shape.clump.spacing_mm", s.clump.spacing_mm, 1e-2, 1e3),
                    ("shape.clump.strength", s.clump.strength, 0.0, 1.0),
                ]
                .map(|(key, value, low, high)| (format!("{table}.{key}"), value, low, high))
            },
        );
        let colours = [
            ("colour.tint", vec![self.colour.tint]),
            ("colour.guard", self.colour.guard.to_vec()),
            ("colour.undercoat", self.colour.undercoat.to_vec()),
            ("colour.skin", vec![self.colour.skin]),
        ];
        let colours = colours.into_iter().flat_map(|(key, rows)| {
            rows.into_iter().flatten().map(|v| (key.to_owned(), v, 0.0, 1.0)).collect::<Vec<_>>()
        });
        let plain = ranges.into_iter().map(|(key, v, low, high)| (key.to_owned(), v, low, high));
        for (key, value, low, high) in plain.chain(shapes).chain(colours) {
            if !(low..=high).contains(&value) {
                return Err(Error::usage("a preset value is out of range")
                    .with_field(key)
                    .with_found(value)
                    .with_expected(format!("a number from {low} to {high}")));
            }
        }
        self.shells.check()?;
        self.fins.check()?;
        Ok(self)
    }
}
