//! Floor 8: the pipeline, from an asset to the same asset with a coat.

mod atlas;
mod comb;
pub mod picture;
mod regions;
mod skin;
pub mod units;

use crate::asset::coat::{Fallback, refuse_second, write_coat};
use crate::asset::{self, Asset, Part};
use crate::coat::axes::axes;
use crate::coat::hair::{TileHair, leaning};
use crate::coat::judge::{CoverageRow, Effort, coverage_table};
use crate::coat::measures::Measures;
use crate::coat::primitive::coat_primitive;
use crate::coat::seams::{WINDOWS, before_after};
use crate::coat::tile::{TileRecipe, bake as bake_tile};
use crate::data::coat::{Blend, Coat, CoatPrimitive, Tile};
use crate::data::patches::Patches;
use crate::error::{Error, Result};
use crate::fur::field::Singularity;
use crate::fur::groom::fibre::Fibre;
use crate::fur::patch::{Parameterisation, parameterise};
use crate::math::Vec3;
use crate::math::hash::combine;
use crate::metrics::timing;
use crate::preset::Preset;
use skin::Groomed;
use std::path::{Path, PathBuf};
use std::time::Instant;
use units::{Scale, Units};

/// How to choose texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Lapped patches.
    Lapped,
    /// Charts with texels of their own, hair sampled on the skin.
    Atlas {
        /// Texels along the edge of the square that holds them; none for four times the preset's tile.
        texels: Option<u32>,
    },
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
    /// Comb and parameterisation of each furred part.
    pub laid: Vec<Laid>,
    /// Coverage of each tile against its strands, when asked for.
    pub accuracy: Vec<Vec<CoverageRow>>,
    /// Time per step, in order.
    pub steps: timing::Steps,
}

/// How one primitive's hair lies.
#[derive(Clone, Debug)]
pub struct Laid {
    /// Its material.
    pub material: String,
    /// Where its comb has no direction.
    pub singularities: Vec<Singularity>,
    /// How well the texture lies; its seams where the bake is judged.
    pub measures: Measures,
    /// Wall time of laying it out, ms.
    pub ms: f64,
}

/// Measures steps and tells of them.
struct Steps<'a> {
    tell: &'a mut dyn FnMut(&'static str),
    steps: timing::Steps,
}

impl Steps<'_> {
    fn run<T>(&mut self, name: &'static str, step: impl FnOnce() -> T) -> T {
        (self.tell)(name);
        let start = Instant::now();
        let result = step();
        self.steps.add_since(name, start, 0);
        result
    }
}

/// Bakes and writes. `tell` hears the name of each step as it begins.
///
/// # Errors
/// When the input cannot be used, names something that is not there, or the output cannot be written.
pub fn bake(request: &Request, tell: &mut dyn FnMut(&'static str)) -> Result<Baked> {
    let mut steps = Steps { tell, steps: timing::Steps::default() };
    let asset = steps.run("read", || asset::load(&request.input))?;
    refuse_second(&asset)?;
    refuse_own_input(&request.input, &request.out)?;
    let chosen = asset::select(&asset.parts, &request.materials)?;
    for (material, _) in &request.presets {
        if !asset.parts.iter().any(|part| &part.material_name == material) {
            return Err(Error::usage("a preset is for a material that the asset does not have")
                .with_parameter("preset")
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
        laid: Vec::new(),
        accuracy: Vec::new(),
        steps: timing::Steps::default(),
    };
    // One tile per preset; primitives with the same preset share it.
    let mut tiles: Vec<(&Preset, Vec<usize>)> = Vec::new();
    for &index in &chosen {
        let preset = preset_of(request, &asset.parts[index]);
        match tiles.iter_mut().find(|(of_tile, _)| *of_tile == preset) {
            Some((_, parts)) => parts.push(index),
            None => tiles.push((preset, vec![index])),
        }
    }
    let mut carried: Vec<(usize, Vec<CoatPrimitive>, Laid)> = Vec::new();
    for (preset, parts) in &tiles {
        let task = Task { asset: &asset, preset, parts, request, scale: &scale };
        let coated = match request.method {
            Method::Atlas { texels } => atlas::coat_parts(&task, texels, &mut steps)?,
            Method::Lapped => coat_parts(&task, |seed| Parameterisation::Lapped { seed }, &mut steps)?,
            Method::Uv(set) => coat_parts(&task, |_| Parameterisation::Uv { set }, &mut steps)?,
        };
        let first = coat.tiles.len();
        let numbered = |primitive: CoatPrimitive| CoatPrimitive {
            tile: first + primitive.tile,
            blend: primitive.blend.map(|blend| Blend { tile: first + blend.tile, ..blend }),
            ..primitive
        };
        warnings.extend(coated.tiles.iter().filter_map(|t| units::length_warning(t.height_m, scale.diagonal_m)));
        notes.extend(coated.notes);
        for warning in coated.warnings {
            // What is said of the whole asset is said once.
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        baked.accuracy.extend(coated.accuracy);
        coat.tiles.extend(coated.tiles);
        carried.extend(
            parts
                .iter()
                .zip(coated.primitives)
                .map(|(&index, (primitives, laid))| (index, primitives.into_iter().map(numbered).collect(), laid)),
        );
    }
    carried.sort_by_key(|(index, ..)| *index);
    for (_, primitives, laid) in carried {
        coat.primitives.extend(primitives);
        baked.laid.push(laid);
    }
    notes.extend(steps.run("write", || write_coat(&asset, &coat, request.fallback, &request.out))?);
    baked.coat = coat;
    (baked.notes, baked.warnings) = (notes, warnings);
    baked.steps = steps.steps;
    Ok(baked)
}

/// Parts that one tile is made for.
struct Task<'a> {
    asset: &'a Asset,
    preset: &'a Preset,
    /// Their indices.
    parts: &'a [usize],
    request: &'a Request,
    scale: &'a Scale,
}

/// Tiles and what carries them.
struct CoatedParts {
    /// The preset's own, then those of its regions.
    tiles: Vec<Tile>,
    /// Per part of the task; tiles are numbered as above.
    primitives: Vec<(Vec<CoatPrimitive>, Laid)>,
    /// Per tile, where asked for.
    accuracy: Vec<Vec<CoverageRow>>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

impl Task<'_> {
    /// Guard hair and undercoat of a preset.
    fn fibres(&self, preset: &Preset) -> [Fibre; 2] {
        let diagonal_m = self.scale.diagonal_m as f32;
        [
            Fibre::guard(&preset.guard, &preset.colour, diagonal_m),
            Fibre::undercoat(&preset.undercoat, &preset.colour, diagonal_m),
        ]
    }

    /// Decides what is random on a part.
    fn seed(&self, part: usize) -> u64 {
        combine(self.request.seed, part as u64)
    }

    /// What a part carries.
    fn coat_primitive(&self, part: usize, groomed: &Groomed, patches: &Patches, tile: &Tile) -> CoatPrimitive {
        let at = &self.asset.parts[part];
        let local = |v, offset_m| at.local_offset(v, offset_m, self.scale.metres_per_unit);
        let axes = axes(&groomed.mesh, &groomed.fields.direction, patches);
        let carried = coat_primitive(&groomed.mesh, &groomed.fields, &axes, patches, tile, self.seed(part), local);
        CoatPrimitive { mesh: at.mesh, primitive: at.primitive, ..carried }
    }
}

fn recipe(preset: &Preset) -> TileRecipe {
    TileRecipe {
        preset: preset.name.clone(),
        shells: preset.shells,
        fins: preset.fins,
        skin: Vec3::from(preset.colour.skin),
        lean_deg: preset.groom.lean_deg,
    }
}

/// Grows and bakes the tile of a preset, and measures it where that is asked for.
fn tile_of(task: &Task<'_>, preset: &Preset, steps: &mut Steps<'_>) -> (Tile, Option<Vec<CoverageRow>>) {
    let ([guard, undercoat], recipe, request) = (task.fibres(preset), recipe(preset), task.request);
    let edge_m = recipe.shells.tile_mm * 1e-3;
    let hair = steps.run("grow", || TileHair::grow(&guard, &undercoat, edge_m, request.seed));
    let tile = steps.run("tile", || bake_tile(&hair, &recipe));
    let judge = || {
        let effort = Effort { pixels: 32, supersampling: 2 };
        coverage_table(&hair, &tile, leaning(recipe.lean_deg), effort)
    };
    let accuracy = request.judge.then(|| steps.run("judge", judge));
    (tile, accuracy)
}

/// Bakes the tiles of a preset and its regions, and puts them on each part over patches of its own.
fn coat_parts(task: &Task<'_>, method: impl Fn(u64) -> Parameterisation, steps: &mut Steps<'_>) -> Result<CoatedParts> {
    let (others, request) = (regions::presets(task.preset)?, task.request);
    let (mut tiles, mut accuracy) = (Vec::new(), Vec::new());
    for preset in std::iter::once(task.preset).chain(&others) {
        let (tile, rows) = tile_of(task, preset, steps);
        tiles.push(tile);
        accuracy.extend(rows);
    }
    let (mut carried, mut warnings) = (Vec::new(), Vec::new());
    for &part in task.parts {
        let groomed =
            steps.run("groom", || skin::groom(task.asset, &task.asset.parts[part], task.preset, task.scale))?;
        let (direction, edge_m) = (&groomed.fields.direction, tiles[0].edge_m);
        let start = Instant::now();
        let patches =
            steps.run("patches", || parameterise(&groomed.mesh, direction, edge_m, method(task.seed(part))))?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        warnings.extend(groomed.notes.iter().chain(&patches.stats.warnings).cloned());
        let seams = request.judge.then(|| {
            steps.run("judge seams", || {
                let axes = axes(&groomed.mesh, &groomed.fields.direction, &patches);
                before_after(&groomed.mesh, &groomed.offsets(), &axes, &patches, &tiles[0], WINDOWS).into()
            })
        });
        let primitives = if others.is_empty() {
            vec![steps.run("coat primitives", || task.coat_primitive(part, &groomed, &patches, &tiles[0]))]
        } else {
            regions::wear_all(task, part, &groomed, &patches, (&others, &tiles), steps)?
        };
        let laid = Laid {
            material: task.asset.parts[part].material_name.clone(),
            singularities: groomed.singularities,
            measures: Measures::new(&patches.stats, f64::from(tiles[0].shells.size), seams),
            ms,
        };
        carried.push((primitives, laid));
    }
    Ok(CoatedParts { tiles, primitives: carried, accuracy, notes: Vec::new(), warnings })
}

fn preset_of<'a>(request: &'a Request, part: &Part) -> &'a Preset {
    let own = request.presets.iter().find(|(material, _)| *material == part.material_name);
    own.map_or(&request.preset, |(_, preset)| preset)
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
            .with_parameter("output")
            .with_found(out.display())
            .with_expected("another file")
            .with_hint("name a new file with `output`"));
    }
    Ok(())
}
