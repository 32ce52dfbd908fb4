//! An atlas: hair grown on the parts themselves, charts of all of them in one square.

use super::{CoatedParts, Laid, Steps, Task, recipe, skin};
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
    let (fibres, recipe) = (task.fibres(task.preset), recipe(task.preset));
    let texels = texels.unwrap_or_else(|| (TEXELS.0 * recipe.shells.texture_size).min(TEXELS.1));
    let tile_m = recipe.shells.tile_mm * 1e-3;
    let (mut groomed, mut patches, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    let mut times_ms = Vec::new();
    for &part in task.parts {
        let skin = steps.run("groom", || skin::groom(task.asset, &task.asset.parts[part], task.preset, task.scale))?;
        let method = Parameterisation::Atlas { texels_per_tile: recipe.shells.texture_size, padding_texels: PADDING };
        let start = Instant::now();
        let charts = steps.run("patches", || parameterise(&skin.mesh, &skin.fields.direction, tile_m, method))?;
        times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        warnings.extend(skin.notes.iter().chain(&charts.stats.warnings).cloned());
        groomed.push(skin);
        patches.push(charts);
    }
    let square = steps.run("patches", || fit_atlas(&mut patches, tile_m, texels, PADDING))?;
    let skins: Vec<atlas::AtlasSkin<'_>> = (0..groomed.len())
        .map(|i| atlas::AtlasSkin {
            mesh: &groomed[i].mesh,
            fields: &groomed[i].fields,
            patches: &patches[i],
            seed: task.seed(task.parts[i]),
        })
        .collect();
    let tile =
        steps.run("atlas", || atlas::bake(&skins, &square, [&fibres[0], &fibres[1]], &recipe, task.request.seed));
    let carried = (0..groomed.len())
        .map(|i| {
            let primitive =
                steps.run("coat primitives", || task.coat_primitive(task.parts[i], &groomed[i], &patches[i], &tile));
            // Charts were measured in tiles; the square has its own texels.
            let texels_per_tile = f64::from(tile_m) * f64::from(texels) / f64::from(square.edge_m);
            let laid = Laid {
                material: task.asset.parts[task.parts[i]].material_name.clone(),
                singularities: groomed[i].singularities.clone(),
                measures: Measures::new(&patches[i].stats, texels_per_tile, None),
                ms: times_ms[i],
            };
            (vec![primitive], laid)
        })
        .collect();
    // The largest skin speaks for all: each place means growing its hair again, every single one.
    let area_m2 = |i: &usize| patches[*i].stats.area_m2;
    let largest = (0..groomed.len()).max_by(|a, b| area_m2(a).total_cmp(&area_m2(b)));
    let judged = largest.filter(|_| task.request.judge).map(|i| {
        let (mesh, fields, seed) = (&groomed[i].mesh, &groomed[i].fields, skins[i].seed);
        let furred = |t: usize| mesh.triangles[t].iter().all(|&v| fields.length[v as usize] > 0.0);
        let at = judge::places(mesh, PLACES, seed, furred);
        let carried =
            judge::CoatedSkin { mesh, fields, patches: &patches[i], tile: &tile, hair: [&fibres[0], &fibres[1]], seed };
        steps.run("judge", || judge::surface_tables(&carried, &[at]))
    });
    let accuracy = judged.into_iter().flatten().collect();
    let note = format!(
        "the atlas of {} has {texels}\u{b2} texels of {:.2} mm; `texture size` N changes that",
        task.preset.name,
        square.edge_m / texels as f32 * 1e3
    );
    Ok(CoatedParts { tiles: vec![tile], primitives: carried, accuracy, notes: vec![note], warnings })
}
