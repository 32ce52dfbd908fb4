//! The tile of a preset: hair of a square, in stages that are kept.

use super::Task;
use super::steps::Steps;
use crate::coat::hair::{TileHair, leaning};
use crate::coat::judge::{CoverageRow, Effort, coverage_table};
use crate::coat::tile::{RaysTold, TileRecipe, bake_with};
use crate::data::coat::{Tile, TileLooks};
use crate::error::Result;
use crate::fur::groom::fibre::Fibre;
use crate::math::Vec3;
use crate::preset::Preset;
use crate::shade::law::known;
use crate::volume::scene::{HairScattering, crowding};
use std::cell::OnceCell;

/// How closely a tile is looked at when it is judged.
const EFFORT: Effort = Effort { pixels: 32, supersampling: 2 };

/// What is baked of hair of a preset's two kinds.
pub(super) fn recipe(task: &Task<'_>, preset: &Preset, steps: &mut Steps<'_>) -> Result<TileRecipe> {
    let scattering = scattering(preset, task.request.draft, steps)?;
    let fibres = task.fibres(preset);
    Ok(TileRecipe {
        preset: preset.name.clone(),
        shells: preset.shells,
        fins: preset.fins,
        skin: Vec3::from(preset.colour.skin),
        lean_deg: preset.groom.lean_deg,
        looks: Some(TileLooks {
            of: [scattering.guard.packed(), scattering.undercoat.packed()],
            crowding: fibres.each_ref().map(crowding),
            undercoat_share: Vec::new(),
        }),
        draft: task.request.draft,
    })
}

/// How hair of a preset scatters light. A fibre that does not come with the program is solved once, and kept.
fn scattering(preset: &Preset, draft: bool, steps: &mut Steps<'_>) -> Result<HairScattering> {
    let (fibres, film) = (&preset.fibre, preset.wet.film());
    if draft {
        return HairScattering::draft(fibres, &film);
    }
    for parameters in [&fibres.guard, &fibres.undercoat] {
        if known::find(fibres.model, parameters)?.is_none() {
            let solve = || known::scattering(fibres.model, parameters);
            let solved = steps.kept("fibre", &(fibres.model, parameters), |steps| steps.run("fibre", solve))?;
            known::learn(fibres.model, parameters, solved)?;
        }
    }
    HairScattering::new(fibres, &film)
}

/// Hair of both kinds on a tile, grown when something first needs it.
struct Hair {
    fibres: [Fibre; 2],
    edge_m: f32,
    seed: u64,
    grown: OnceCell<TileHair>,
}

impl Hair {
    fn grown(&self, steps: &mut Steps<'_>) -> &TileHair {
        let [guard, undercoat] = &self.fibres;
        let grow = || TileHair::grow(guard, undercoat, self.edge_m, self.seed);
        self.grown.get_or_init(|| steps.run("grow", grow))
    }
}

/// Grows and bakes the tile of a preset, and measures it where that is asked for.
pub(super) fn tile_of(
    task: &Task<'_>,
    preset: &Preset,
    steps: &mut Steps<'_>,
) -> Result<(Tile, Option<Vec<CoverageRow>>)> {
    let (fibres, seed) = (task.fibres(preset), task.request.seed);
    let recipe = recipe(task, preset, steps)?;
    let hair = Hair { fibres, edge_m: recipe.shells.tile_mm * 1e-3, seed, grown: OnceCell::new() };
    let made_from = (&fibres, seed, &recipe);
    let tile = steps.kept("tile", &made_from, |steps| Ok(baked(&hair, &recipe, steps)))?;
    let judge = |steps: &mut Steps<'_>| {
        let hair = hair.grown(steps);
        steps.run("judge", || Ok(coverage_table(hair, &tile, leaning(recipe.lean_deg), EFFORT)))
    };
    // How much hair covers is no matter of its colour.
    let seen = (fibres.each_ref().map(Fibre::colourless), seed, recipe.shells, recipe.lean_deg, EFFORT);
    let accuracy = task.request.judge.then(|| steps.kept("judge", &seen, judge)).transpose()?;
    Ok((tile, accuracy))
}

/// Bakes a tile. What rays tell is kept by itself: it takes most of the time, and another colour changes nothing of it.
fn baked(hair: &Hair, recipe: &TileRecipe, steps: &mut Steps<'_>) -> Tile {
    let grown = hair.grown(steps);
    let [guard, undercoat] = hair.fibres.each_ref().map(Fibre::colourless);
    // Where a level's slabs end hangs on all hair.
    let ends = steps.key("tile-ends", &(guard, undercoat, hair.seed, recipe.shells, recipe.draft));
    let gains = steps.key("tile-gains", &(guard, undercoat, hair.seed, recipe.shells, recipe.lean_deg, recipe.draft));
    let mut told = RaysTold { ends: steps.find(ends.as_ref()), gains: steps.find(gains.as_ref()) };
    let known = told.clone();
    let tile = steps.run("tile", || bake_with(grown, recipe, &mut told));
    if let (None, Some(value)) = (known.ends, &told.ends) {
        steps.keep(ends.as_ref(), value);
    }
    if let (None, Some(value)) = (known.gains, &told.gains) {
        steps.keep(gains.as_ref(), value);
    }
    tile
}
