//! Gains: an eye for which a pixel is a texel of some mip sees as much through the stack as through its strands, at every
//! angle and by every mip.

use crate::{coats, twins};
use furrier::cast::{Caster, Rays};
use furrier::coat::fins::FinParameters;
use furrier::coat::hair::TileHair;
use furrier::coat::shells::ShellParameters;
use furrier::coat::tile::{TileRecipe, bake};
use furrier::data::coat::Tile;
use furrier::data::shell::{Incidence, Stack};
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Undercoat};
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Mat3, Vec2, Vec3};
use furrier::runtime::Show;
use furrier::runtime::gpu::Renderer;

/// Between the angles at which gains are stored, degrees.
const ANGLES_DEG: [f32; 4] = [5.0, 28.0, 42.0, 65.0];

/// Other ways round than those that gains are fitted along.
fn directions(theta_deg: f32) -> impl Iterator<Item = Vec3> {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    (0..5).map(move |i| {
        let (s, c) = ((i as f32 + 0.6) * std::f32::consts::TAU / 5.0).sin_cos();
        Vec3::new(sin * c, sin * s, -cos)
    })
}

/// A tile of both kinds of hair whose texels are wider than its hairs.
fn hair() -> TileHair {
    let colour = Colour::default();
    let guard = Fibre::guard(&Guard { density_per_cm2: 200.0, ..Guard::default() }, &colour, 1.0);
    let undercoat = Fibre::undercoat(&Undercoat { density_per_cm2: 400.0, ..Undercoat::default() }, &colour, 1.0);
    TileHair::grow(&guard, &undercoat, 8e-3, 7)
}

/// The tile of [`hair`], and what passes through its strands at each of [`ANGLES_DEG`], in the mean.
pub fn tile_and_truth() -> (Tile, [f64; 4]) {
    let hair = hair();
    let shells = ShellParameters { tile_mm: 8.0, texture_size: 32, layers: 8 };
    let recipe = TileRecipe {
        preset: "test".into(),
        shells,
        fins: FinParameters::default(),
        skin: Vec3::splat(0.5),
        lean_deg: 0.0,
        looks: None,
        draft: false,
    };
    let caster = Caster::new(hair.scene());
    let (edge_m, top_m) = (hair.edge_m, hair.height_m);
    let truth = ANGLES_DEG.map(|theta| {
        let through = |direction: Vec3| {
            let rays = Rays::Tile { edge_m, top_m, direction, size: [64; 2], supersampling: 1 };
            caster.seen_through(&rays, &[top_m / -direction.z])[0]
        };
        directions(theta).map(through).sum::<f64>() / 5.0
    });
    (bake(&hair, &recipe), truth)
}

/// How much more or less passes through the stack by mip `mip` than through its strands, at the angle where most.
pub fn off(tile: &Tile, truth: &[f64; 4], mip: usize) -> f64 {
    let stack = Stack::new(tile);
    let pixel = (1 << mip) as f32 / tile.shells.size as f32;
    let each = ANGLES_DEG.iter().zip(truth).map(|(&theta, truth)| {
        let mut sum = 0.0;
        for direction in directions(theta) {
            let view = Incidence::new(direction, Mat3::IDENTITY, pixel);
            let at = |i: u32| Vec2::new((i % 40) as f32 + 0.5, (i / 40) as f32 + 0.5) / 40.0;
            sum += (0..1600).map(|i| f64::from(1.0 - stack.coverage(at(i), &view))).sum::<f64>();
        }
        (sum / 8000.0 - truth).abs()
    });
    each.fold(0.0, f64::max)
}

/// One point of coverage.
pub const BOUND: f64 = 0.01;

#[test]
fn every_mip_lets_through_what_strands_do() {
    let (tile, truth) = tile_and_truth();
    for mip in 0..tile.shells.gains.len() {
        let off = off(&tile, &truth, mip);
        println!("mip {mip}: {off:.4} off {truth:.3?}, gains {:.3?}", tile.shells.gains[mip]);
        assert!(off < BOUND, "mip {mip}: {off}");
    }
}

/// [`off`] of what the graphics device draws, where its pixel is a texel of the mip.
pub fn off_on_device(tile: &Tile, truth: &[f64; 4], mip: usize) -> f64 {
    let tiles = std::slice::from_ref(tile);
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let renderer = Renderer::new(&gpu, tiles, 1).unwrap();
    let seen_m = tile.edge_m * (twins::PIXELS << mip) as f32 / tile.shells.size as f32;
    // Slanting rays pass nowhere beside it.
    let plane = coats::plane(seen_m + 20.0 * tile.edge_m, 40, 0.0, tile);
    let show = Show { skin: false, shells: true, fins: false };
    let each = ANGLES_DEG.iter().zip(truth).map(|(&theta, truth)| {
        let through = |direction| {
            let frame = twins::oblique(direction, seen_m);
            1.0 - renderer.prepare(&plane.scene(tiles)).unwrap().draw(&frame, show).unwrap().picture.coverage()
        };
        (directions(theta).map(through).sum::<f64>() / 5.0 - truth).abs()
    });
    each.fold(0.0, f64::max)
}

#[test]
fn every_mip_lets_through_what_strands_do_on_the_device() {
    let (tile, truth) = tile_and_truth();
    // Pixels as large as the tile would all meet it at one place.
    for mip in 0..tile.shells.gains.len() - 1 {
        let off = off_on_device(&tile, &truth, mip);
        println!("mip {mip}: {off:.4} off");
        assert!(off < BOUND, "mip {mip}: {off}");
    }
}
