//! The flags that say how a coat is baked, whatever it is baked on.

use super::axes::AxesArgs;
use crate::asset::Reading;
use crate::asset::coat::Fallback;
use crate::bake::recipe::{Choices, Layout, Target, split_choice};
use crate::bake::units::Units;
use crate::error::Result;
use crate::preset::Preset;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What decides a coat beside its input.
#[derive(Clone, Debug, Args)]
pub struct RecipeArgs {
    /// A built-in preset or a TOML file, for every furred material or for the one named; repeatable. Default: fox
    #[arg(long = "preset", value_name = "[MATERIAL=]NAME|FILE")]
    presets: Vec<String>,
    /// Change one value of every preset used; repeatable
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    settings: Vec<String>,
    /// Fur the material of this name; repeatable. Default: all but transparent ones, cards cut out by alpha, and those named as
    /// eyes, nose, mouth, teeth, claws, hooves, horns, whiskers, glasses, ground and the like
    #[arg(long = "material", value_name = "NAME")]
    materials: Vec<String>,
    /// What one unit of the file is; auto takes what is furred to be as large as what the preset describes; where that is a small
    /// part of a figure, as a hat is, it takes the unit that makes the figure as large as an animal or a person
    #[arg(long, value_enum, default_value_t = UnitName::Auto)]
    units: UnitName,
    /// How the skin is laid out in the plane: patches grown along the hair, charts with texels of their own, or the
    /// asset's own UVs
    #[arg(long, value_enum, default_value_t = LayoutName::Lapped)]
    parameterisation: LayoutName,
    /// The UV set that `--parameterisation uv` takes [default: 0]
    #[arg(long, value_name = "N")]
    uv_set: Option<usize>,
    /// Layers, the opaque skin included: overrides every preset's shells.layers
    #[arg(long, value_name = "N")]
    layers: Option<u32>,
    /// Texels along a tile's edge: overrides every preset's shells.texture_size. With `--parameterisation atlas`, those
    /// along the edge of the whole atlas [default there: four times the preset's]
    #[arg(long, value_name = "N")]
    texture_size: Option<u32>,
    /// Where random numbers start; the same seed gives the same bytes
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// What programs without the extension show: the bare skin, or N shells as plain meshes [default: shells:8]
    #[arg(long, value_name = "none|shells:N")]
    fallback: Option<Fallback>,
    /// What the coat is to be drawn by: sets layers, texels and fallback, where nothing else does. desktop: as the preset says;
    /// vr: 9 layers; web: 9 layers of 64 texels, shells:4; phone: 4 layers of 64 texels, shells:2
    #[arg(long, value_enum, default_value_t)]
    target: TargetName,
    /// Fur coarser levels of detail too (names such as `Beast_LOD1` beside `Beast_LOD0`, or MSFT_lod), each by itself
    #[arg(long)]
    lods: bool,
    #[command(flatten)]
    axes: AxesArgs,
}

impl RecipeArgs {
    /// The files among the presets.
    pub fn preset_files(&self) -> Vec<PathBuf> {
        let names = self.presets.iter().map(|choice| split_choice(choice).1);
        names.filter(|name| Preset::source(name).is_none()).map(PathBuf::from).collect()
    }

    /// Whether anything about hair was chosen.
    pub fn chosen(&self) -> bool {
        !self.presets.is_empty() || !self.settings.is_empty()
    }

    /// How the input is read, apart from its coat.
    ///
    /// # Errors
    /// As [`AxesArgs::reading`].
    pub fn reading(&self) -> Result<Reading> {
        self.axes.reading()
    }

    /// What was chosen.
    pub fn choices(&self) -> Choices {
        Choices {
            presets: self.presets.clone(),
            settings: self.settings.clone(),
            materials: self.materials.clone(),
            units: self.units.units(),
            layout: self.parameterisation.layout(),
            uv_set: self.uv_set,
            layers: self.layers,
            texture_size: self.texture_size,
            seed: self.seed,
            fallback: self.fallback,
            target: self.target.target(),
            up: self.axes.up,
            forward: self.axes.forward,
            lods: self.lods,
        }
    }
}

/// Targets by name.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TargetName {
    #[default]
    Desktop,
    Vr,
    Web,
    Phone,
}

impl TargetName {
    /// What it stands for.
    fn target(self) -> Target {
        match self {
            Self::Desktop => Target::Desktop,
            Self::Vr => Target::Vr,
            Self::Web => Target::Web,
            Self::Phone => Target::Phone,
        }
    }
}

/// Units by name.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum UnitName {
    Auto,
    M,
    Cm,
    Mm,
    In,
}

impl UnitName {
    /// What it stands for.
    pub fn units(self) -> Units {
        match self {
            Self::Auto => Units::Auto,
            Self::M => Units::Metres,
            Self::Cm => Units::Centimetres,
            Self::Mm => Units::Millimetres,
            Self::In => Units::Inches,
        }
    }
}

/// Layouts by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LayoutName {
    Lapped,
    Atlas,
    Uv,
}

impl LayoutName {
    /// What it stands for.
    pub fn layout(self) -> Layout {
        match self {
            Self::Lapped => Layout::Lapped,
            Self::Atlas => Layout::Atlas,
            Self::Uv => Layout::Uv,
        }
    }
}
