//! Floor 8: the pipeline, from an asset to the same asset with a coat.

mod atlas;
mod comb;
mod cut;
mod extent;
mod fan;
mod finest;
pub mod picture;
pub mod recipe;
mod regions;
mod request;
pub mod seen;
mod sets;
mod skin;
mod steps;
mod textures;
mod tiles;
mod unfollowed;
pub mod units;
mod wear;
mod weld;

use crate::asset::coat::{Packed, check_output, refuse_second, write_packed};
use crate::asset::{self, Asset, Part};
use crate::coat::axes::axes;
use crate::coat::judge::CoverageRow;
use crate::coat::measures::Measures;
use crate::coat::seams::{WINDOWS, before_after};
use crate::coat::summary::draw_calls_note;
use crate::data::coat::{Blend, Coat, CoatPrimitive, Tile};
use crate::error::{Error, Result};
use crate::fur::groom::fibre::Fibre;
use crate::fur::patch::{Parameterisation, need_uv_set, parameterise};
use crate::metrics::timing;
use crate::preset::Preset;
use skin::{Groomed, Role};
use std::path::Path;
use std::time::Instant;
use steps::Steps;
use textures::Textures;
use tiles::tile_of;
use unfollowed::variants;
use units::Scale;
use weld::Skin;

pub use request::{Baked, Laid, Method, Request};
pub use steps::{Cached, Uses};

/// Bakes and writes. `tell` hears the name of each step as it begins.
///
/// # Errors
/// When the input cannot be used, names something that is not there, or the output cannot be written.
pub fn bake(request: &Request, tell: &mut dyn FnMut(&'static str)) -> Result<Baked> {
    let mut steps = Steps::new(tell, request.cache.clone());
    check_output(&request.out, &[])?;
    let asset = read(request, &mut steps)?;
    // Before the long work.
    refuse_own_input(&request.input, &request.out)?;
    check_output(&request.out, &asset.document.files)?;
    let (asset, mut baked) = dress(asset, request, &mut steps)?;
    let pack = |tile: &Tile| steps.kept("textures", tile, |steps| steps.run("textures", || Packed::new(tile)));
    let textures = baked.coat.tiles.iter().map(pack).collect::<Result<Vec<_>>>()?;
    let write = || write_packed(&asset, &baked.coat, &textures, request.fallback, &request.out);
    baked.notes.extend(steps.run("write", write)?);
    baked.notes.extend(draw_calls_note(&baked.coat));
    Ok(done(baked, steps))
}

/// Bakes, and writes nothing: the asset as it was read, with the pictures that the coat shows, and the coat.
///
/// # Errors
/// When the input cannot be used or names something that is not there.
pub fn coat(request: &Request, tell: &mut dyn FnMut(&'static str)) -> Result<(Asset, Baked)> {
    let mut steps = Steps::new(tell, request.cache.clone());
    let asset = read(request, &mut steps)?;
    let (asset, baked) = dress(asset, request, &mut steps)?;
    Ok((asset, done(baked, steps)))
}

/// The same for an asset that was read as the request says, and wears nothing.
///
/// # Errors
/// As [`coat`].
pub fn coat_of(asset: Asset, request: &Request, tell: &mut dyn FnMut(&'static str)) -> Result<(Asset, Baked)> {
    check_files(request)?;
    let mut steps = Steps::new(tell, request.cache.clone());
    let (asset, baked) = dress(asset, request, &mut steps)?;
    Ok((asset, done(baked, steps)))
}

/// Whether the files are there that presets name.
fn check_files(request: &Request) -> Result<()> {
    std::iter::once(&request.preset)
        .chain(request.presets.iter().map(|(_, preset)| preset))
        .try_for_each(regions::check_files)
}

/// The input, which must not wear a coat.
fn read(request: &Request, steps: &mut Steps<'_>) -> Result<Asset> {
    check_files(request)?;
    let asset = steps.run("read", || asset::load_as(&request.input, &request.reading))?;
    refuse_second(&asset)?;
    Ok(asset)
}

/// With what the steps tell at their end.
fn done(mut baked: Baked, steps: Steps<'_>) -> Baked {
    let (times, cached, warnings) = steps.done();
    baked.warnings.extend(warnings);
    Baked { steps: times, cached, ..baked }
}

/// Grows the asset's coat.
fn dress(mut asset: Asset, request: &Request, steps: &mut Steps<'_>) -> Result<(Asset, Baked)> {
    let wetted = |(material, preset): &(String, Preset)| (material.clone(), preset.wetted());
    let presets = request.presets.iter().map(wetted).collect();
    let request = &Request { preset: request.preset.wetted(), presets, ..request.clone() };
    let selection = asset::select(&asset.parts, &request.materials)?;
    let chosen = selection.parts;
    for (material, _) in &request.presets {
        if !asset.parts.iter().any(|part| &part.material_name == material) {
            return Err(Error::usage("a preset is for a material that the asset does not have")
                .with_parameter("preset")
                .with_found(material)
                .with_expected(names(asset.parts.iter()).join(", ")));
        }
    }
    if let Method::Uv(set) = request.method {
        need_uv_set(set, chosen.iter().map(|&i| asset.parts[i].stored.uv_sets.len()).max().unwrap_or(0))?;
    }
    let finest = sets::finest(&asset, &chosen);
    let scale = units::scale(request.units, &request.preset, &asset, &finest, request.input.starts_with("sample:"))?;
    let mut notes: Vec<String> = asset.notes.iter().cloned().chain(selection.note).chain(scale.note.clone()).collect();
    let mut warnings = [&asset.warnings[..], &selection.warnings, &variants(&asset, &chosen), &scale.warnings].concat();
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
        cached: None,
    };
    // One tile per preset; primitives with the same preset share it. An atlas is one level's alone.
    let mut tiles: Vec<(&Preset, Vec<usize>)> = Vec::new();
    let atlas = matches!(request.method, Method::Atlas { .. });
    for &index in &chosen {
        let preset = preset_of(request, &asset.parts[index]);
        let apart = |parts: &[usize]| atlas && asset.parts[parts[0]].level != asset.parts[index].level;
        match tiles.iter_mut().find(|(of_tile, parts)| *of_tile == preset && !apart(parts)) {
            Some((_, parts)) => parts.push(index),
            None => tiles.push((preset, vec![index])),
        }
    }
    for (preset, parts) in &tiles {
        regions::check_places(&asset, parts, preset)?;
    }
    let hair_m = Fibre::guard(&request.preset.guard, &request.preset.colour, scale.diagonal_m as f32).length_m;
    let skin =
        steps.run("weld", || weld::join(&asset, |part| chosen.contains(&part), scale.metres_per_unit, hair_m))?;
    let mut carried: Vec<(usize, CoatPrimitive)> = Vec::new();
    for (preset, parts) in &tiles {
        let has_uv = parts.iter().any(|&part| !asset.parts[part].stored.uv_sets.is_empty());
        // Regions mix lengths and densities at vertices, and colours of presets of their own.
        let textures = Textures::new(&mut asset.document, preset, has_uv && preset.regions.is_empty())?;
        let task = Task { asset: &asset, skin: &skin, preset, parts, request, scale: &scale, textures: &textures };
        let coated = match request.method {
            Method::Atlas { texels } => atlas::coat_parts(&task, texels, steps)?,
            Method::Lapped => coat_parts(&task, |seed| Parameterisation::Lapped { seed }, steps)?,
            Method::Uv(set) => coat_parts(&task, |_| Parameterisation::Uv { set }, steps)?,
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
        carried.extend(coated.primitives.into_iter().map(|(index, primitive)| (index, numbered(primitive))));
        baked.laid.extend(coated.laid);
    }
    carried.sort_by_key(|(index, _)| *index);
    coat.primitives.extend(carried.into_iter().map(|(_, primitive)| primitive));
    Ok((asset, Baked { coat, notes, warnings, ..baked }))
}

/// Parts that one tile is made for.
struct Task<'a> {
    asset: &'a Asset,
    /// All parts as one surface.
    skin: &'a Skin,
    preset: &'a Preset,
    /// Their indices.
    parts: &'a [usize],
    request: &'a Request,
    scale: &'a Scale,
    /// What coats show of pictures.
    textures: &'a Textures,
}

/// Tiles and what carries them.
struct CoatedParts {
    /// The preset's own, then those of its regions.
    tiles: Vec<Tile>,
    /// Each with its part; tiles are numbered as above.
    primitives: Vec<(usize, CoatPrimitive)>,
    laid: Vec<Laid>,
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

    /// The skin with this preset's fields, all of it: what has no hair is part of the surface.
    fn groom(&self, preset: &Preset, steps: &mut Steps<'_>) -> Result<Groomed> {
        let role = |part: usize| if self.parts.contains(&part) { Role::Furred } else { Role::Aside };
        steps.around("groom", |steps| skin::groom(self.asset, self.skin, role, preset, self.scale, steps))
    }

    /// What some of the task's parts are called.
    fn materials(&self, parts: &[usize]) -> String {
        names(parts.iter().map(|&part| &self.asset.parts[part])).join(", ")
    }
}

/// Bakes the tiles of a preset and its regions, and puts them on each part over patches of its own.
fn coat_parts(task: &Task<'_>, method: impl Fn(u64) -> Parameterisation, steps: &mut Steps<'_>) -> Result<CoatedParts> {
    let (others, request) = (regions::presets(task.preset)?, task.request);
    // Maps and regions that cannot be read are told before the long work.
    let all = task.groom(task.preset, steps)?;
    // An asset's own coordinates are every part's by itself; passages between presets need all parts.
    let alone = matches!(request.method, Method::Uv(_)) && others.is_empty();
    let sets = sets::laid_out_together(task.asset, task.parts, alone);
    let cut = |parts: &[usize]| all.cut(|part| parts.contains(&(part as usize)));
    let share = |parts: &Vec<usize>| regions::shares(task, &cut(parts));
    let shares: Vec<_> = if others.is_empty() { Vec::new() } else { sets.iter().map(share).collect::<Result<_>>()? };
    let (mut tiles, mut accuracy) = (Vec::new(), Vec::new());
    for preset in std::iter::once(task.preset).chain(&others) {
        let (tile, rows) = tile_of(task, preset, steps)?;
        tiles.push(tile);
        accuracy.extend(rows);
    }
    let (mut carried, mut warnings, mut laid, mut notes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (set, parts) in sets.iter().enumerate() {
        let groomed = steps.run("groom", || cut(parts));
        let (direction, edge_m) = (&groomed.fields.direction, tiles[0].edge_m);
        let start = Instant::now();
        let (mesh, method) = (groomed.mesh(), method(request.seed));
        let patches = steps.kept("patches", &(mesh, direction, edge_m, method), |steps| {
            steps.run("patches", || parameterise(mesh, direction, edge_m, method))
        })?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        warnings.extend(groomed.notes.iter().chain(&patches.stats.warnings).cloned());
        let judge_seams = |steps: &mut Steps<'_>| {
            let offsets = groomed.offsets();
            steps.kept("judge-seams", &(mesh, &offsets, direction, &patches, &tiles[0], WINDOWS), |steps| {
                steps.run("judge seams", || {
                    let axes = axes(mesh, direction, &patches);
                    Ok(before_after(mesh, &offsets, &axes, &patches, &tiles[0], WINDOWS))
                })
            })
        };
        let seams = request.judge.then(|| judge_seams(steps)).transpose()?.map(Into::into);
        let worn = if others.is_empty() {
            steps.run("coat primitives", || task.coat_primitives(&groomed, &patches, &tiles[0]))
        } else {
            regions::wear_all((task, parts), &groomed, &patches, (&others, &tiles, &shares[set]), steps)?
        };
        notes.extend(finest::notes(&groomed, &task.materials(parts), &worn, request.method, None));
        carried.extend(worn);
        laid.push(Laid {
            material: task.materials(parts),
            singularities: groomed.singularities,
            measures: Measures::new(&patches.stats, f64::from(tiles[0].shells.size), seams),
            ms,
        });
    }
    Ok(CoatedParts { tiles, primitives: carried, laid, accuracy, notes, warnings })
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
