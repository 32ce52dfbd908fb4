//! An atlas: hair grown on the parts themselves, charts of all of them in one square.

use super::steps::Steps;
use super::tiles::recipe;
use super::{CoatedParts, Laid, Task, finest};
use crate::coat::atlas::{self, judge};
use crate::coat::measures::Measures;
use crate::error::{Error, Result};
use crate::fur::patch::{Parameterisation, fit_atlas, parameterise};
use std::time::Instant;

/// Texels that charts keep free around themselves: the second mip's, below which neighbouring hair looks alike anyway.
const PADDING: u32 = 4;
/// Texels along the square's edge over those along a preset's tile, where none are asked for, and the most of them then.
const TEXELS: (u32, u32) = (4, 2048);

/// Places that a report looks at.
const PLACES: usize = 8;

/// Bakes the atlas of the task's parts and puts it on them.
pub(super) fn coat_parts(task: &Task<'_>, texels: Option<u32>, steps: &mut Steps<'_>) -> Result<CoatedParts> {
    if let Some(region) = task.preset.regions.first() {
        return Err(Error::usage("an atlas cannot have regions")
            .with_field("regions")
            .with_found(&region.preset)
            .with_expected("a preset without regions")
            .with_hint("use `parameterisation` lapped or uv"));
    }
    let fibres = task.fibres(task.preset);
    let recipe = recipe(task, task.preset, steps)?;
    let texels = texels.unwrap_or_else(|| (TEXELS.0 * recipe.shells.texture_size).min(TEXELS.1));
    let tile_m = recipe.shells.tile_mm * 1e-3;
    let all = task.groom(task.preset, steps)?;
    let groomed = steps.run("groom", || all.cut(|part| task.parts.contains(&(part as usize))));
    let (mesh, fields) = (groomed.mesh(), &groomed.fields);
    let method = Parameterisation::Atlas { texels_per_tile: recipe.shells.texture_size, padding_texels: PADDING };
    let start = Instant::now();
    let (patches, square) = steps.kept("patches", &(mesh, &fields.direction, tile_m, method, texels), |steps| {
        steps.run("patches", || {
            let mut patches = [parameterise(mesh, &fields.direction, tile_m, method)?];
            let square = fit_atlas(&mut patches, tile_m, texels, PADDING)?;
            let [patches] = patches;
            Ok((patches, square))
        })
    })?;
    let patches = &patches;
    let ms = start.elapsed().as_secs_f64() * 1e3;
    let warnings = groomed.notes.iter().chain(&patches.stats.warnings).cloned().collect();
    let seed = task.request.seed;
    let skin = atlas::AtlasSkin { mesh, fields, patches, seed };
    let made_from = (mesh, fields, patches, &square, &fibres, &recipe, seed);
    let tile = steps.kept("atlas", &made_from, |steps| {
        steps.run("atlas", || Ok(atlas::bake(&[skin], &square, [&fibres[0], &fibres[1]], &recipe, seed)))
    })?;
    let carried = steps.run("coat primitives", || task.coat_primitives(&groomed, patches, &tile));
    // Charts were measured in tiles; the square has its own texels.
    let texels_per_tile = f64::from(tile_m) * f64::from(texels) / f64::from(square.edge_m);
    let laid = Laid {
        material: task.materials(task.parts),
        singularities: groomed.singularities.clone(),
        measures: Measures::new(&patches.stats, texels_per_tile, None),
        ms,
    };
    let judge = || {
        let furred = |t: usize| mesh.triangles[t].iter().all(|&v| fields.length[v as usize] > 0.0);
        let at = judge::places(mesh, PLACES, skin.seed, furred);
        let carried =
            judge::CoatedSkin { mesh, fields, patches, tile: &tile, hair: [&fibres[0], &fibres[1]], seed: skin.seed };
        Ok(judge::surface_tables(&carried, &[at]))
    };
    let judged =
        task.request.judge.then(|| steps.kept("judge", &(made_from, PLACES), |steps| steps.run("judge", judge)));
    let accuracy = judged.transpose()?.unwrap_or_default();
    let note = format!(
        "the atlas of {} has {texels}\u{b2} texels of {:.2} mm; `texture size` N changes that",
        task.preset.name,
        square.edge_m / texels as f32 * 1e3
    );
    let texel_m = square.edge_m / texels as f32;
    let mut notes = finest::notes(&groomed, &laid.material, &carried, task.request.method, Some(texel_m));
    notes.push(note);
    Ok(CoatedParts { tiles: vec![tile], primitives: carried, laid: vec![laid], accuracy, notes, warnings })
}
