//! What a report on a coat is of: an asset, how it is furred, and how large its pictures are.

use crate::asset::Reading;
use crate::asset::coat::Fallback;
use crate::bake::bake;
use crate::bake::picture::{Only, PictureRequest};
use crate::bake::recipe::Choices;
use crate::cli::axes::AxesArgs;
use crate::cli::console::Console;
use crate::cli::recipe::{LayoutName, UnitName};
use crate::cli::stage::size;
use crate::error::Result;
use crate::gpu::Choice;
use crate::hybrid::device::Device;
use crate::preset::Preset;
use crate::report::coat::keep::Keep;
use crate::report::coat::key::Key;
use clap::Args;
use std::path::PathBuf;

/// What a report on a coat is of.
#[derive(Debug, Args)]
pub struct Subject {
    /// A .glb, .gltf or .obj file, or sample:NAME
    pub input: String,
    /// The report to write; a .csv, a .svg, a .png and a folder .parts go beside it
    #[arg(short, long, value_name = "OUT.json")]
    pub output: PathBuf,
    /// A built-in preset or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "fox")]
    pub preset: String,
    /// Change a value of the preset; repeatable
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    settings: Vec<String>,
    /// Fur this material alone; repeatable
    #[arg(long = "material", value_name = "NAME")]
    materials: Vec<String>,
    /// What one unit of the file is
    #[arg(long, value_enum, default_value_t = UnitName::Auto)]
    units: UnitName,
    /// How the skin is laid out in the plane, as `bake` does it
    #[arg(long, value_enum, default_value_t = LayoutName::Lapped)]
    parameterisation: LayoutName,
    /// Layers, the opaque skin included: overrides the preset's shells.layers
    #[arg(long, value_name = "N")]
    layers: Option<u32>,
    /// Texels along a tile's edge, or along the atlas's: overrides the preset's shells.texture_size
    #[arg(long, value_name = "N")]
    texture_size: Option<u32>,
    #[command(flatten)]
    axes: AxesArgs,
    /// Where random numbers start
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Pixels of each picture
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: String,
    /// What draws fur, as in `render`; the coat is drawn by the adapter named here, or by any there is
    #[arg(long, value_name = "auto|cpu|gpu[:NAME]", default_value = "auto")]
    pub device: String,
}

impl Subject {
    /// Pixels of each picture.
    ///
    /// # Errors
    /// Where they cannot be read.
    pub fn size(&self) -> Result<[u32; 2]> {
        size(&self.size)
    }

    /// What draws fur, and what draws the coat.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn devices(&self) -> Result<(Device, Choice)> {
        let device: Device = self.device.parse()?;
        let choice = match &device {
            Device::Gpu(choice) => choice.clone(),
            Device::Auto | Device::Cpu => Choice::Auto,
        };
        Ok((device, choice))
    }

    /// The preset, with what is set.
    ///
    /// # Errors
    /// As [`Preset::load`].
    pub fn preset(&self) -> Result<Preset> {
        Preset::load(&self.preset)?.with_settings(&self.settings)
    }

    /// Where finished pictures are kept.
    ///
    /// # Errors
    /// As [`Keep::open`].
    pub fn keep(&self) -> Result<Keep> {
        Keep::open(&self.output.with_extension("parts"))
    }

    /// The coat's file, baked where this program has not baked the same before; and what decides it.
    ///
    /// # Errors
    /// As [`bake`].
    pub fn baked(&self, keep: &mut Keep, console: &Console) -> Result<(Key, PathBuf)> {
        let recipe = Choices {
            presets: vec![self.preset.clone()],
            settings: self.settings.clone(),
            materials: self.materials.clone(),
            units: self.units.units(),
            layout: self.parameterisation.layout(),
            layers: self.layers,
            texture_size: self.texture_size,
            seed: self.seed,
            fallback: Some(Fallback::None),
            up: self.axes.up,
            forward: self.axes.forward,
            ..Choices::default()
        };
        let recipe = recipe.recipe()?;
        let key = Key::default().program()?.asset(&self.input)?.preset(&recipe.preset)?;
        let key = key.with((&recipe.materials, recipe.units, recipe.method, recipe.seed, recipe.upright));
        let out = keep.coat_file(key);
        if !out.is_file() {
            let baked = bake(&recipe.request(&self.input, &out, false), &mut |_| {})?;
            baked.warnings.iter().for_each(|warning| console.warning(warning));
        }
        Ok((key, out))
    }

    /// Which way up the asset is.
    ///
    /// # Errors
    /// As [`AxesArgs::reading`].
    pub fn reading(&self) -> Result<Reading> {
        self.axes.reading()
    }

    /// The fur that the coat stands for.
    ///
    /// # Errors
    /// As [`AxesArgs::reading`].
    pub fn picture(&self, preset: Preset) -> Result<PictureRequest> {
        Ok(PictureRequest {
            input: self.input.clone(),
            reading: self.reading()?,
            preset,
            materials: self.materials.clone(),
            units: self.units.units(),
            seed: self.seed,
            only: Only::Hybrid,
            pose: None,
        })
    }
}
