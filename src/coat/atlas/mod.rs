//! Shells sampled on the skin itself: every texel of an atlas holds the hair that grows there (`docs/steps/shells.md`, "On
//! the skin").

pub mod chart_region;
pub mod fins;
pub mod flatten;
mod ground;
pub mod judge;

use crate::coat::fins::texture;
use crate::coat::hair::{TileHair, leaning};
use crate::coat::shells::above::Above;
use crate::coat::shells::deposit::{VoxelLayout, Voxels, mean_slopes};
use crate::coat::shells::encode::{Raw, encode};
use crate::coat::shells::undercoat::{self, Profile};
use crate::coat::shells::{ends, gains};
use crate::coat::tile::{TileRecipe, slab_means, undercoat_shares};
use crate::data::coat::{Sampled, Tile};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Square};
use crate::data::slabs::Slabs;
use crate::data::strands::Strands;
use crate::data::topology::Topology;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::Vec2;
use crate::math::hash::combine;
use chart_region::ChartRegion;
use flatten::{by_triangle, flatten};
use ground::Ground;
use rayon::prelude::*;
use std::ops::Range;

/// Guard hairs over a texel that are more than it can tell apart: from here on one stands for several.
const MOST_PER_TEXEL: f32 = 8.0;
/// Furthest that hair from around a chart is looked for, texels.
const FURTHEST: f32 = 32.0;
/// Edge of the square on which gains are fitted, texels.
const REFERENCE: (usize, usize) = (8, 256);
/// Points along a texel's edge that decide how much of it is skin.
const SAMPLES: usize = 4;
/// Distances between hairs, to each side, over which guard hair is smoothed.
const SMOOTHED: f32 = 2.0;
/// Least share of skin in a texel that its hair is divided by.
const LEAST_SHARE: f32 = 0.25;

/// A skin that carries a part of the atlas.
#[derive(Clone, Copy, Debug)]
pub struct AtlasSkin<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The groom's fields on it.
    pub fields: &'a Fields,
    /// Its charts, in the square.
    pub patches: &'a Patches,
    /// Decides where each hair grows.
    pub seed: u64,
}

/// Guard hair, thinned so that there are not many more hairs than texels.
struct Thinned {
    fibre: Fibre,
    /// Hairs that one stands for.
    thinning: f32,
    /// Least width that a hair is spread over, m.
    width_m: f32,
}

impl Thinned {
    fn new(fibre: &Fibre, texel_m: f32) -> Self {
        let thinning = (fibre.density_per_m2 * texel_m * texel_m / MOST_PER_TEXEL).max(1.0);
        let mut fibre = *fibre;
        fibre.density_per_m2 /= thinning;
        fibre.radius_m *= thinning;
        let distance_m = 1.0 / fibre.density_per_m2.max(1e-6).sqrt();
        Self { fibre, thinning, width_m: if thinning > 1.0 { distance_m } else { 0.0 } }
    }

    /// How far around hair is smoothed to be as dense as it is in the mean: over clumps and single hairs.
    fn reach_texels(&self, texel_m: f32) -> usize {
        let distance_m = SMOOTHED / self.fibre.density_per_m2.max(1e-6).sqrt();
        (distance_m.max(self.fibre.shape.clump.spacing_mm * 1e-3) / texel_m).ceil().min(FURTHEST) as usize
    }

    /// Voxels of it, and what its ends add.
    fn deposit(&self, layout: &VoxelLayout, strands: &Strands, slopes: &[Vec2]) -> (Voxels, Vec<f32>) {
        let mut voxels = Voxels::new(layout.clone());
        let mut ends = vec![0.0; layout.texels() * layout.slabs.count()];
        ends::deposit_with_ends(strands, slopes, (self.width_m, self.thinning), &mut voxels, &mut ends);
        (voxels, ends)
    }
}

/// A layout filled with both kinds of hair.
struct Filled {
    voxels: Voxels,
    ends: Vec<f32>,
    above: Above,
}

impl Filled {
    /// `reach_texels` is how far around it is in the mean.
    fn new(voxels: Voxels, ends: Vec<f32>, reach_texels: usize, skin_share: &[f32]) -> Self {
        let above = Above::new(&voxels.layout, &voxels.extinction, reach_texels, skin_share);
        Self { voxels, ends, above }
    }
}

/// Bakes the atlas of `skins`, whose charts share `square`. `guard` and `undercoat` grow on them; `seed` decides about the
/// square of hair that gains are taken from, and where the hair of the fin texture grows.
pub fn bake(skins: &[AtlasSkin<'_>], square: &Square, hair: [&Fibre; 2], recipe: &TileRecipe, seed: u64) -> Tile {
    let texel_m = square.edge_m / square.texels as f32;
    let guard = Thinned::new(hair[0], texel_m);
    let reference = Reference::new(skins, hair, &guard, recipe, texel_m, seed);
    let height_m = reference.hair.height_m;
    let cut = reference.tile.shells.slabs.clone();
    let slabs = cut.count();
    let layout =
        VoxelLayout { toroidal: false, ..VoxelLayout::tile(square.texels as usize, cut, square.edge_m, height_m) };

    let n = layout.texels();
    let mut all = Filled {
        voxels: Voxels::new(layout.clone()),
        ends: vec![0.0; n * slabs],
        above: Above { voxels: vec![0.0; n * slabs], skin: vec![0.0; n] },
    };
    let mut skin_share = vec![0.0; n];
    for (skin, rectangles) in skins.iter().zip(&square.charts) {
        let strands = grow::skin::grow(&guard.fibre, skin.mesh, skin.fields, combine(skin.seed, 1));
        let skin = Grown {
            skin,
            ranges: by_triangle(&strands, skin.mesh.triangles.len()),
            strands,
            ground: Ground::new(skin.mesh, skin.fields, Undercoat::new(hair[1], Some(Pattern::default()))),
            topology: Topology::new(&skin.mesh.triangles, |v| skin.mesh.position_class[v as usize]),
        };
        let mut own = vec![Vec::new(); rectangles.len()];
        for (t, triangle) in skin.skin.patches.triangles.iter().enumerate() {
            own[skin.skin.patches.patch[triangle[0] as usize] as usize].push(t);
        }
        // Charts lie apart, so each is filled by itself; a few at a time, or their sum would stand in memory twice.
        for (rectangles, own) in rectangles.chunks(64).zip(own.chunks(64)) {
            let charts: Vec<Chart> = rectangles
                .par_iter()
                .zip(own)
                .map(|(&rectangle, own)| skin.chart(&guard, square, rectangle, own, &layout, &reference))
                .collect();
            charts.iter().for_each(|chart| chart.place(&mut all, &mut skin_share));
        }
    }
    let shells = encode(&Raw {
        voxels: &all.voxels,
        ends: &all.ends,
        above: &all.above,
        skin: recipe.skin,
        slopes: &reference.slopes,
        skin_share: &skin_share,
    });
    let mut tile = Tile { sampled: Sampled::Skin, edge_m: square.edge_m, shells, ..reference.tile };
    let gains = &reference.gains;
    tile.shells.gains = (0..tile.shells.albedo.len()).map(|mip| gains[mip.min(gains.len() - 1)].clone()).collect();
    tile
}

/// The same hair on toroidal squares: what gains and slopes are taken from; and the fin texture.
struct Reference {
    /// Every hair, on a tile as a tiled coat has it.
    hair: TileHair,
    slopes: Vec<Vec2>,
    gains: Vec<Vec<[f32; 9]>>,
    /// Thinned as the atlas is, with texels of the atlas's size.
    tile: Tile,
    /// Furthest that a point of a hair is from its root, along the skin, m.
    reach_m: f32,
}

impl Reference {
    fn new(
        skins: &[AtlasSkin<'_>],
        hair: [&Fibre; 2],
        guard: &Thinned,
        recipe: &TileRecipe,
        texel_m: f32,
        seed: u64,
    ) -> Self {
        let across = (recipe.shells.tile_mm * 1e-3 / texel_m).ceil() as usize;
        let size = across.next_power_of_two().clamp(REFERENCE.0, REFERENCE.1);
        let edge_m = size as f32 * texel_m;
        let full = TileHair::grow(hair[0], hair[1], recipe.shells.tile_mm * 1e-3, seed);
        let slabs = Slabs::even(recipe.shells.layers as usize - 1);
        let mut thin = TileHair::grow(&guard.fibre, hair[1], edge_m, seed);
        thin.height_m = full.height_m;
        let lean = leaning(recipe.lean_deg);
        let truth = || {
            let mapped = full.mapped(lean);
            let cut = std::slice::from_ref(&slabs);
            gains::Truth::new(mapped.scene(), (mapped.edge_m, mapped.height_m), cut, lean, recipe.draft).of(&slabs)
        };
        let stack = || {
            let slopes = mean_slopes(&thin.guard, &slabs, full.height_m);
            let layout = VoxelLayout::tile(size, slabs.clone(), edge_m, full.height_m);
            let (mut voxels, mut ends) = guard.deposit(&layout, &thin.guard, &slopes);
            let guard_means = slab_means(&voxels.extinction, slabs.count());
            if let Some(medium) = &thin.undercoat {
                undercoat::add(medium, &slopes, &mut voxels, &mut ends);
            }
            let shares = undercoat_shares(&guard_means, &slab_means(&voxels.extinction, slabs.count()));
            (Filled::new(voxels, ends, 0, &[]), slopes, shares)
        };
        let along_skin = fins::grown(skins, hair, &full, combine(seed, 3));
        let fin_hair = along_skin.as_ref().unwrap_or(&full);
        let fin = || texture::composite(fin_hair, &recipe.fins);
        let ((filled, slopes, shares), (truth, fin)) = rayon::join(stack, || rayon::join(truth, fin));
        let shells = encode(&Raw {
            voxels: &filled.voxels,
            ends: &filled.ends,
            above: &filled.above,
            skin: recipe.skin,
            slopes: &slopes,
            skin_share: &[],
        });
        let fin =
            texture::encode(&fin, fin_hair, &recipe.fins, (&slabs, &slab_means(&filled.above.voxels, slabs.count())));
        let tile = Tile {
            preset: recipe.preset.clone(),
            sampled: Sampled::Square,
            edge_m,
            height_m: full.height_m,
            shells,
            fin,
            levels: vec![],
            looks: recipe.looks(&shares),
        };
        let reach = |s: &Strands| {
            let far = |i: usize| s.points_of_m(i).iter().map(move |p| (*p - s.points_of_m(i)[0]).truncate().length());
            (0..s.len()).flat_map(far).fold(0.0, f32::max)
        };
        let reach_m = reach(&thin.guard);
        let gains = gains::fit(&tile, &truth, lean);
        Self { slopes, gains, tile, reach_m, hair: full }
    }
}

/// A skin with its hair.
struct Grown<'a> {
    skin: &'a AtlasSkin<'a>,
    strands: Strands,
    ranges: Vec<Range<usize>>,
    ground: Ground<'a>,
    topology: Topology,
}

impl Grown<'_> {
    /// Fills one chart with its own hair and that from around it.
    fn chart(
        &self,
        guard: &Thinned,
        square: &Square,
        rectangle: [u32; 4],
        own: &[usize],
        layout: &VoxelLayout,
        reference: &Reference,
    ) -> Chart {
        let AtlasSkin { mesh, fields, patches, .. } = *self.skin;
        let margin = (reference.reach_m / layout.texel_m).ceil().min(FURTHEST) as u32 + 1;
        let region = ChartRegion::new(mesh, &self.topology, patches, own, square.texels, rectangle, margin);
        let layout = VoxelLayout { size: region.size, ..layout.clone() };
        let flat = flatten(&self.strands, &self.ranges, (mesh, fields), &region, layout.texel_m);
        let (mut voxels, mut ends) = guard.deposit(&layout, &flat, &reference.slopes);
        let skin_share: Vec<f32> = (0..layout.texels()).map(|i| skin_share(&region, i)).collect();
        // A texel's values are means over what of it is skin.
        for (i, share) in skin_share.iter().enumerate().filter(|(_, share)| **share > 0.0 && **share < 1.0) {
            let over = 1.0 / share.max(LEAST_SHARE);
            for v in (0..layout.slabs.count()).map(|slab| slab * layout.texels() + i) {
                voxels.extinction[v] *= over;
                voxels.tangent[v] *= over;
                voxels.colour[v] *= over;
                ends[v] *= over;
            }
        }
        if let Some(medium) = &reference.hair.undercoat {
            self.ground.add(&region, &Profile::new(medium, &layout), &mut voxels, &mut ends);
        }
        let filled = Filled::new(voxels, ends, guard.reach_texels(layout.texel_m), &skin_share);
        Chart { rectangle, margin: margin as usize, filled, skin_share }
    }
}

/// How much of a texel is skin.
fn skin_share(region: &ChartRegion, texel: usize) -> f32 {
    let (x, y) = (texel % region.size[0], texel / region.size[0]);
    let at = |i: usize| (i as f32 + 0.5) / SAMPLES as f32;
    let points = (0..SAMPLES * SAMPLES)
        .filter(|i| region.at(Vec2::new(x as f32 + at(i % SAMPLES), y as f32 + at(i / SAMPLES))).is_some());
    points.count() as f32 / (SAMPLES * SAMPLES) as f32
}

/// A chart's texels, `margin` more than its rectangle on every side.
struct Chart {
    rectangle: [u32; 4],
    margin: usize,
    filled: Filled,
    skin_share: Vec<f32>,
}

impl Chart {
    /// Copies the rectangle into the square.
    fn place(&self, all: &mut Filled, skin_share: &mut [f32]) {
        let [left, top, width, height] = self.rectangle.map(|n| n as usize);
        let (from, to) = (self.filled.voxels.layout.clone(), all.voxels.layout.clone());
        for y in 0..height {
            let source = (y + self.margin) * from.size[0] + self.margin;
            let target = (top + y) * to.size[0] + left;
            skin_share[target..target + width].copy_from_slice(&self.skin_share[source..source + width]);
            all.above.skin[target..target + width].copy_from_slice(&self.filled.above.skin[source..source + width]);
            for slab in 0..to.slabs.count() {
                let (s, t) = (slab * from.texels() + source, slab * to.texels() + target);
                let (own, voxels) = (&self.filled.voxels, &mut all.voxels);
                voxels.extinction[t..t + width].copy_from_slice(&own.extinction[s..s + width]);
                voxels.tangent[t..t + width].copy_from_slice(&own.tangent[s..s + width]);
                voxels.colour[t..t + width].copy_from_slice(&own.colour[s..s + width]);
                all.ends[t..t + width].copy_from_slice(&self.filled.ends[s..s + width]);
                all.above.voxels[t..t + width].copy_from_slice(&self.filled.above.voxels[s..s + width]);
            }
        }
    }
}
