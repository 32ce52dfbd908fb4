//! Floor 7: the pipeline, from an asset to the same asset with a coat.

pub mod picture;
mod skin;
pub mod units;

use crate::asset::coat::{Fallback, refuse_second, write_coat};
use crate::asset::{self, Part};
use crate::coat::judge::{Effort, Row, coverage_table};
use crate::coat::tile::{TileHair, TileRecipe, bake as bake_tile, leaning};
use crate::coat::wear::wear;
use crate::data::coat::{Coat, Tile};
use crate::data::patches::Stats;
use crate::error::{Error, Result};
use crate::fur::groom::fibre::Fibre;
use crate::fur::patch::{Parameterisation, parameterise};
use crate::math::Vec3;
use crate::math::hash::combine;
use crate::preset::Preset;
use std::path::{Path, PathBuf};
use std::time::Instant;
use units::Units;

/// How to choose texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Lapped patches.
    Lapped,
    /// Unique charts.
    Atlas,
    /// The asset's own set.
    Uv(usize),
}

/// What to bake.
#[derive(Clone, Debug)]
pub struct Request {
    /// A file, or `sample:NAME`.
    pub input: String,
    /// Where the result goes.
    pub out: PathBuf,
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
    /// Whether to measure the result against its strands.
    pub judge: bool,
}

/// One step's time.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// Step.
    pub name: &'static str,
    /// Wall time, ms.
    pub ms: f64,
}

/// What was baked.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The coat.
    pub coat: Coat,
    /// What was decided for the user, one sentence each.
    pub notes: Vec<String>,
    /// What may not be as the user expects, one sentence each.
    pub warnings: Vec<String>,
    /// Materials that got fur.
    pub materials: Vec<String>,
    /// Bounding diagonal that lengths refer to, m.
    pub diagonal_m: f64,
    /// Parameterisation of each coat primitive.
    pub patches: Vec<Stats>,
    /// Coverage of each tile against its strands, when asked for.
    pub accuracy: Vec<Vec<Row>>,
    /// Time per step, in order.
    pub timings: Vec<Timing>,
}

/// Measures steps and tells of them.
struct Steps<'a> {
    tell: &'a mut dyn FnMut(&'static str),
    timings: Vec<Timing>,
}

impl Steps<'_> {
    fn run<T>(&mut self, name: &'static str, step: impl FnOnce() -> T) -> T {
        (self.tell)(name);
        let start = Instant::now();
        let result = step();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        match self.timings.iter_mut().find(|t| t.name == name) {
            Some(timing) => timing.ms += ms,
            None => self.timings.push(Timing { name, ms }),
        }
        result
    }
}

/// Bakes and writes. `tell` hears the name of each step as it begins.
///
/// # Errors
/// When the input cannot be used, names something that is not there, or the output cannot be written.
pub fn bake(request: &Request, tell: &mut dyn FnMut(&'static str)) -> Result<Baked> {
    let mut steps = Steps { tell, timings: Vec::new() };
    let asset = steps.run("read", || asset::load(&request.input))?;
    refuse_second(&asset)?;
    refuse_own_input(&request.input, &request.out)?;
    let chosen = asset::select(&asset.parts, &request.materials)?;
    for (material, _) in &request.presets {
        if !asset.parts.iter().any(|part| &part.material_name == material) {
            return Err(Error::usage("a preset is for a material that the asset does not have")
                .with_field("--preset")
                .with_found(material)
                .with_expected(names(asset.parts.iter()).join(", ")));
        }
    }
    let scale = units::scale(request.units, &request.preset, &asset, request.input.starts_with("sample:"))?;
    let mut notes: Vec<String> = scale.note.iter().cloned().collect();
    let mut warnings = asset.warnings.clone();
    let mut coat = Coat { metres_per_unit: scale.metres_per_unit, ..Coat::default() };
    let mut baked = Baked {
        coat: Coat::default(),
        notes: Vec::new(),
        warnings: Vec::new(),
        materials: names(chosen.iter().map(|&i| &asset.parts[i])),
        diagonal_m: scale.diagonal_m,
        patches: Vec::new(),
        accuracy: Vec::new(),
        timings: Vec::new(),
    };
    // One tile per preset; primitives with the same preset share it.
    let mut tiles: Vec<&Preset> = Vec::new();
    for &index in &chosen {
        let part = &asset.parts[index];
        let own = request.presets.iter().find(|(material, _)| *material == part.material_name);
        let preset = own.map_or(&request.preset, |(_, preset)| preset);
        let tile = match tiles.iter().position(|&p| p == preset) {
            Some(tile) => tile,
            None => {
                let (tile, rows) = tile_of(preset, scale.diagonal_m as f32, request, &mut steps);
                warnings.extend(units::length_warning(tile.height_m, scale.diagonal_m));
                coat.tiles.push(tile);
                baked.accuracy.extend(rows);
                tiles.push(preset);
                tiles.len() - 1
            }
        };
        let groomed = steps.run("groom", || skin::groom(&asset, part, preset, scale.metres_per_unit))?;
        warnings.extend(groomed.notes);
        let textures = &coat.tiles[tile];
        let seed = combine(request.seed, index as u64);
        let method = method_of(request.method, preset, seed);
        let patches =
            steps.run("patches", || parameterise(&groomed.mesh, &groomed.fields.direction, textures.edge_m, method))?;
        warnings.extend(patches.stats.warnings.iter().cloned());
        let mut worn = steps.run("wear", || {
            wear(&groomed.mesh, &groomed.fields, &patches, textures, seed, |v, offset_m| {
                part.local_offset(v, offset_m, scale.metres_per_unit)
            })
        });
        (worn.mesh, worn.primitive, worn.tile) = (part.mesh, part.primitive, tile);
        coat.primitives.push(worn);
        baked.patches.push(patches.stats);
    }
    notes.extend(steps.run("write", || write_coat(&asset, &coat, request.fallback, &request.out))?);
    baked.coat = coat;
    (baked.notes, baked.warnings) = (notes, warnings);
    baked.timings = steps.timings;
    Ok(baked)
}

fn method_of(method: Method, preset: &Preset, seed: u64) -> Parameterisation {
    match method {
        Method::Lapped => Parameterisation::Lapped { seed },
        Method::Uv(set) => Parameterisation::Uv { set },
        // Charts keep the texels free that the second mip needs; below it neighbouring hair looks alike anyway.
        Method::Atlas => Parameterisation::Atlas { texels_per_tile: preset.shells.texture_size, padding_texels: 4 },
    }
}

/// Grows and bakes a preset's tile for a mesh of this bounding diagonal.
fn tile_of(preset: &Preset, diagonal_m: f32, request: &Request, steps: &mut Steps<'_>) -> (Tile, Option<Vec<Row>>) {
    let guard = Fibre::guard(&preset.guard, &preset.colour, diagonal_m);
    let undercoat = Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m);
    let recipe = TileRecipe {
        preset: preset.name.clone(),
        shells: preset.shells,
        fins: preset.fins,
        skin: Vec3::from(preset.colour.skin),
        lean_deg: preset.groom.lean_deg,
    };
    let hair = steps.run("grow", || TileHair::grow(&guard, &undercoat, preset.shells.tile_mm * 1e-3, request.seed));
    let tile = steps.run("tile", || bake_tile(&hair, &recipe));
    let judge = || {
        let effort = Effort { pixels: 32, supersampling: 2 };
        coverage_table(&hair, &tile, leaning(recipe.lean_deg), effort)
    };
    let rows = request.judge.then(|| steps.run("judge", judge));
    (tile, rows)
}

fn names<'a>(parts: impl Iterator<Item = &'a Part>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for part in parts {
        if !names.contains(&part.material_name) {
            names.push(part.material_name.clone());
        }
    }
    names
}

/// Fails before the work, not after it, when the output is the input.
fn refuse_own_input(input: &str, out: &Path) -> Result<()> {
    let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if same(Path::new(input), out) {
        return Err(Error::usage("the output would overwrite the input")
            .with_field("--output")
            .with_found(out.display())
            .with_expected("another file")
            .with_hint("name a new file with -o"));
    }
    Ok(())
}
