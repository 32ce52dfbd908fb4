//! How well a tile's stack reproduces its strands: coverage and structure, angle by angle, beside the usual constant α.

use super::hair::TileHair;
use super::shells::gains::directions;
use crate::cast::Caster;
use crate::cast::Rays;
use crate::data::coat::Tile;
use crate::data::ray::DepthRange;
use crate::data::shell::{Incidence, Stack, slab_optical_depth};
use crate::math::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Angles between ray and normal that are judged, degrees.
pub const ANGLES_DEG: [f32; 6] = [0.0, 20.0, 40.0, 60.0, 75.0, 85.0];

/// One angle's result: coverages in [0, 1], errors as root mean square after a 4 × 4 box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoverageRow {
    /// Angle between ray and skin normal, degrees.
    pub theta_deg: f32,
    /// Mean coverage of the strands, ray cast.
    pub strands: f32,
    /// Mean coverage of the stack.
    pub stack: f32,
    /// Mean coverage of the same stack with each texel's α from straight above.
    pub constant: f32,
    /// Structure error of the stack.
    pub rmse: f32,
    /// Structure error with constant α.
    pub rmse_constant: f32,
}

/// Edge of a pixel, in texels.
const PIXEL: f32 = 15.0 / 16.0;

/// How closely to look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Effort {
    /// Pixels along the edge of the square looked at, a multiple of 4; one pixel is 15/16 of a texel of mip 0.
    pub pixels: usize,
    /// Rays per pixel edge.
    pub supersampling: usize,
}

/// Judges a tile mapped by `skin_from_tile` (identity: no lean). The strands are those of `hair` under the same map.
pub fn coverage_table(hair: &TileHair, tile: &Tile, skin_from_tile: Mat3, effort: Effort) -> Vec<CoverageRow> {
    let mapped = hair.mapped(skin_from_tile);
    let caster = Caster::new(mapped.scene());
    let stack = Stack::new(tile);
    let top_m = mapped.height_m;
    ANGLES_DEG.map(|theta| row(&caster, &stack, tile, top_m, theta, skin_from_tile, effort)).to_vec()
}

fn row(
    caster: &Caster<'_>,
    stack: &Stack<'_>,
    tile: &Tile,
    top_m: f32,
    theta_deg: f32,
    skin_from_tile: Mat3,
    effort: Effort,
) -> CoverageRow {
    let n = effort.pixels;
    // Nearly a texel: pixels must not all sit on texels' middles, where filtering blurs nothing.
    let pixel = PIXEL / tile.shells.size as f32;
    let edge_m = tile.edge_m * pixel * n as f32;
    let (mut truth, mut ours, mut constant) = (Vec::new(), Vec::new(), Vec::new());
    for direction in directions(theta_deg).step_by(2) {
        let rays = Rays::Tile { edge_m, top_m, direction, size: [n, n], supersampling: effort.supersampling };
        let film = caster.render(&rays, DepthRange { near_m: 0.0, far_m: top_m / -direction.z });
        truth.extend(film.alpha);
        let seen = Incidence::new(direction, skin_from_tile, pixel);
        let shift = direction.truncate() / -direction.z * top_m / tile.edge_m;
        for i in 0..n * n {
            let uv = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) * pixel + shift;
            ours.push(stack.coverage(uv, &seen));
            constant.push(constant_coverage(stack, tile, uv, &seen, pixel));
        }
    }
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    CoverageRow {
        theta_deg,
        strands: mean(&truth),
        stack: mean(&ours),
        constant: mean(&constant),
        rmse: box_rmse(&truth, &ours, n),
        rmse_constant: box_rmse(&truth, &constant, n),
    }
}

/// The usual shells: every texel's opacity is what it is from straight above, fetched without widening.
fn constant_coverage(stack: &Stack<'_>, tile: &Tile, uv: Vec2, seen: &Incidence, pixel: f32) -> f32 {
    let above = Incidence::new(Vec3::NEG_Z, Mat3::IDENTITY, pixel);
    let depth: f32 = (1..tile.shells.layers as usize)
        .map(|layer| {
            // Fetched where the view ray meets the layer, as if seen from above.
            let texel = stack.fetch_middle(layer, stack.middle(layer, uv, seen), &above);
            stack.gain(layer, &above) * slab_optical_depth(&texel, &above, stack.slab_m(layer))
        })
        .sum();
    -libm::expm1f(-depth)
}

/// Root mean square difference of two stacks of n × n pictures, each averaged over 4 × 4 pixels first.
pub fn box_rmse(a: &[f32], b: &[f32], n: usize) -> f32 {
    let blocks = n / 4;
    let mut sums = vec![0.0_f32; a.len() / (n * n) * blocks * blocks];
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        let (picture, row, column) = (i / (n * n), i / n % n, i % n);
        sums[(picture * blocks + row / 4) * blocks + column / 4] += (x - y) / 16.0;
    }
    (sums.iter().map(|s| s * s).sum::<f32>() / sums.len() as f32).sqrt()
}
