//! The fin texture's texels: a slab of hair composited along the skin.

use super::FinParameters;
use crate::cast::Caster;
use crate::cast::Rays;
use crate::coat::hair::TileHair;
use crate::coat::shells::encode::signed8;
use crate::data::coat::FinTexture;
use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::data::ray::DepthRange;
use crate::data::ray::Ray;
use crate::data::shell::{Slabs, code_above};
use crate::math::Vec3;

/// Rays per texel edge.
const SUPERSAMPLING: usize = 2;

/// One texel, premultiplied by opacity.
#[derive(Clone, Copy, Default)]
struct Texel {
    albedo: Vec3,
    tangent: Vec3,
    alpha: f32,
}

/// One mip level.
struct Level {
    width: usize,
    height: usize,
    texels: Vec<Texel>,
}

/// The mips of a fin texture before coding.
pub struct Slab(Vec<Level>);

/// Composites the slab 0 ≤ y < thickness of the tile, seen along +y.
pub fn composite(hair: &TileHair, parameters: &FinParameters) -> Slab {
    let [width, height] = [parameters.texture_width as usize, parameters.texture_height as usize];
    Slab(pyramid(Level { width, height, texels: cast(hair, width, height, parameters.thickness_mm * 1e-3) }))
}

/// Codes a slab. `slab_above` is the shells' mean hair area above per slab of `slabs`; each row
/// takes that of its height.
pub fn encode(
    slab: &Slab,
    hair: &TileHair,
    parameters: &FinParameters,
    (slabs, slab_above): (&Slabs, &[f32]),
) -> FinTexture {
    let levels = &slab.0;
    FinTexture {
        size: [parameters.texture_width, parameters.texture_height],
        width_m: hair.edge_m,
        thickness_m: parameters.thickness_mm * 1e-3,
        albedo: levels.iter().map(|level| code(level, |t, _| albedo(t))).collect(),
        tangent: levels
            .iter()
            .map(|level| {
                code(level, |t, row| {
                    let up = 1.0 - (row as f32 + 0.5) / level.height as f32;
                    let slab = slabs.at(up);
                    let m = t.tangent.normalize_or(Vec3::Z) * (t.tangent.length() / t.alpha.max(1e-6)).min(1.0);
                    [signed8(m.x), signed8(m.y), signed8(m.z), code_above(slab_above[slab])]
                })
            })
            .collect(),
    }
}

fn cast(hair: &TileHair, width: usize, height: usize, thickness_m: f32) -> Vec<Texel> {
    let (fine_width, fine_height) = (width * SUPERSAMPLING, height * SUPERSAMPLING);
    let ray = |i: usize| {
        let x = ((i % fine_width) as f32 + 0.5) / fine_width as f32;
        let z = 1.0 - ((i / fine_width) as f32 + 0.5) / fine_height as f32;
        Ray { origin_m: Vec3::new(x * hair.edge_m, 0.0, z * hair.height_m), direction: Vec3::Y }
    };
    let rays: Vec<Ray> = (0..fine_width * fine_height).map(ray).collect();
    let range = DepthRange { near_m: 0.0, far_m: thickness_m };
    let film = Caster::new(hair.scene()).render(&Rays::Texels { rays: &rays, size: [fine_width, fine_height] }, range);
    let share = 1.0 / (SUPERSAMPLING * SUPERSAMPLING) as f32;
    let mut texels = vec![Texel::default(); width * height];
    for i in 0..rays.len() {
        let texel = &mut texels[i / fine_width / SUPERSAMPLING * width + i % fine_width / SUPERSAMPLING];
        texel.albedo += film.albedo[i] * share;
        texel.tangent += film.tangent[i] * share;
        texel.alpha += film.alpha[i] * share;
    }
    texels
}

/// Halves until one texel is left. Texels without hair take colour and tangent of the next coarser level at a weight
/// too small to see, so that filtering at a hair's edge meets no black.
fn pyramid(base: Level) -> Vec<Level> {
    let mut levels = vec![base];
    while levels[levels.len() - 1].texels.len() > 1 {
        let fine = &levels[levels.len() - 1];
        let (width, height) = ((fine.width / 2).max(1), (fine.height / 2).max(1));
        let (step_x, step_y) = (fine.width / width, fine.height / height);
        let texel = |i: usize| {
            let mut sum = Texel::default();
            for y in 0..step_y {
                for x in 0..step_x {
                    let t = &fine.texels[(i / width * step_y + y) * fine.width + i % width * step_x + x];
                    let share = 1.0 / (step_x * step_y) as f32;
                    sum.albedo += t.albedo * share;
                    sum.tangent += t.tangent * share;
                    sum.alpha += t.alpha * share;
                }
            }
            sum
        };
        let texels = (0..width * height).map(texel).collect();
        levels.push(Level { width, height, texels });
    }
    for coarse in (1..levels.len()).rev() {
        let (finer, coarser) = levels.split_at_mut(coarse);
        let (fine, coarse) = (&mut finer[finer.len() - 1], &coarser[0]);
        for i in 0..fine.texels.len() {
            if fine.texels[i].alpha <= 0.0 {
                let (x, y) = (i % fine.width * coarse.width / fine.width, i / fine.width * coarse.height / fine.height);
                let from = coarse.texels[y * coarse.width + x];
                let weight = 1e-6 / from.alpha.max(1e-6);
                fine.texels[i] = Texel { albedo: from.albedo * weight, tangent: from.tangent * weight, alpha: 1e-6 };
            }
        }
    }
    levels
}

fn albedo(texel: &Texel) -> [u8; 4] {
    let c = (texel.albedo / texel.alpha.max(1e-6)).map(|v| srgb_from_linear(v.clamp(0.0, 1.0)));
    [unorm8(c.x), unorm8(c.y), unorm8(c.z), unorm8(texel.alpha)]
}

fn code(level: &Level, pixel: impl Fn(&Texel, usize) -> [u8; 4]) -> Image8 {
    let pixels = level.texels.iter().enumerate().flat_map(|(i, t)| pixel(t, i / level.width)).collect();
    Image8 { width: level.width as u32, height: level.height as u32, channels: 4, pixels }
}
