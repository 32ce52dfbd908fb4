//! Voxels into textures: mips, dilation, eight bits (the channels of [`ShellStack`]).

use super::above::Above;
use super::deposit::Voxels;
use crate::data::coat::ShellStack;
use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::data::shell::code_above;
use crate::math::{Vec2, Vec3};
use rayon::prelude::*;

/// One texel before coding.
#[derive(Clone, Copy, Debug, Default)]
struct Texel {
    extinction: f32,
    tangent: Vec3,
    /// Weighted by extinction.
    colour: Vec3,
    /// 1 − e^−κ.
    ends: f32,
    /// Hair area above per skin area.
    above: f32,
    /// Share of the texel that is skin.
    weight: f32,
}

/// What the textures are made from.
pub struct Raw<'a> {
    /// Extinction, tangents and colour of all hair.
    pub voxels: &'a Voxels,
    /// κ per voxel.
    pub ends: &'a [f32],
    /// Hair area above.
    pub above: &'a Above,
    /// Skin colour factor, linear.
    pub skin: Vec3,
    /// Mean slope per slab.
    pub slopes: &'a [Vec2],
    /// Share of each texel that is skin; empty where all of it is. What is not takes its values from around it.
    pub skin_share: &'a [f32],
}

/// Builds all mips and codes them; gains are 1.
pub fn encode(raw: &Raw<'_>) -> ShellStack {
    let voxels = raw.voxels;
    let size = voxels.layout.size[0];
    let weight = |texel: usize| raw.skin_share.get(texel).copied().unwrap_or(1.0);
    let mut layers: Vec<Vec<Texel>> = vec![
        raw.above
            .skin
            .iter()
            .enumerate()
            .map(|(i, &above)| Texel {
                extinction: 1.0,
                tangent: Vec3::Z,
                colour: raw.skin,
                ends: 1.0,
                above,
                weight: weight(i),
            })
            .collect(),
    ];
    for slab in 0..voxels.layout.slabs.count() {
        let texel = |i: usize| {
            let v = slab * size * size + i;
            Texel {
                extinction: voxels.extinction[v],
                tangent: voxels.tangent[v],
                colour: voxels.colour[v],
                ends: -libm::expm1f(-raw.ends[v]),
                above: raw.above.voxels[v],
                weight: weight(i),
            }
        };
        layers.push((0..size * size).map(texel).collect());
    }
    let mut slopes = vec![Vec2::ZERO];
    slopes.extend(raw.slopes);
    let mut stack = ShellStack {
        layers: layers.len() as u32,
        slabs: voxels.layout.slabs.clone(),
        size: size as u32,
        gains: Vec::new(),
        slopes,
        extinction_scales_per_m: Vec::new(),
        albedo: Vec::new(),
        medium: Vec::new(),
        ends: Vec::new(),
    };
    let pyramids: Vec<Vec<Vec<Texel>>> = layers.into_par_iter().map(pyramid).collect();
    let colours: Vec<Vec<Vec<Vec3>>> = pyramids.iter().map(|p| dilated(p)).collect();
    for mip in 0..pyramids[0].len() {
        let level =
            |f: &(dyn Fn(usize) -> Image8 + Sync)| (0..pyramids.len()).into_par_iter().map(f).collect::<Vec<_>>();
        let hair = pyramids[1..].iter().flat_map(|pyramid| &pyramid[mip]);
        let scale = hair.map(|t| t.extinction).fold(f32::MIN_POSITIVE, f32::max);
        stack.gains.push(vec![[1.0; 9]; pyramids.len()]);
        stack.extinction_scales_per_m.push(scale);
        stack.albedo.push(level(&|layer| code_albedo(&pyramids[layer][mip], &colours[layer][mip])));
        stack.medium.push(level(&|layer| code_medium(&pyramids[layer][mip], scale)));
        stack.ends.push(level(&|layer| code_ends(&pyramids[layer][mip])));
    }
    stack
}

/// Halves until one texel is left; every value is averaged linearly over what is skin (`docs/steps/shells.md`, mips). Then
/// texels without skin take the values of the next coarser level.
fn pyramid(base: Vec<Texel>) -> Vec<Vec<Texel>> {
    let mut levels = vec![base];
    while levels[levels.len() - 1].len() > 1 {
        let fine = &levels[levels.len() - 1];
        let size = fine.len().isqrt();
        let half = size / 2;
        let coarse = (0..half * half).map(|i| {
            let (x, y) = (2 * (i % half), 2 * (i / half));
            mean([y * size + x, y * size + x + 1, (y + 1) * size + x, (y + 1) * size + x + 1].map(|j| fine[j]))
        });
        let coarse = coarse.collect();
        levels.push(coarse);
    }
    for level in (0..levels.len() - 1).rev() {
        let (finer, coarser) = levels.split_at_mut(level + 1);
        let (fine, coarse) = (&mut finer[level], &coarser[0]);
        let size = fine.len().isqrt();
        for (i, texel) in fine.iter_mut().enumerate().filter(|(_, texel)| texel.weight == 0.0) {
            *texel = Texel { weight: 0.0, ..coarse[i / size / 2 * (size / 2) + i % size / 2] };
        }
    }
    levels
}

/// The mean of four texels over what is skin in them.
fn mean(four: [Texel; 4]) -> Texel {
    let weight: f32 = four.iter().map(|t| t.weight).sum();
    let share = if weight > 0.0 { 1.0 / weight } else { 0.0 };
    Texel {
        extinction: four.iter().map(|t| t.weight * t.extinction).sum::<f32>() * share,
        tangent: four.iter().map(|t| t.weight * t.tangent).sum::<Vec3>() * share,
        colour: four.iter().map(|t| t.weight * t.colour).sum::<Vec3>() * share,
        ends: four.iter().map(|t| t.weight * t.ends).sum::<f32>() * share,
        above: four.iter().map(|t| t.weight * t.above).sum::<f32>() * share,
        weight: 0.25 * weight,
    }
}

/// Straight colour of every level; texels without hair take that of the next coarser level, so that filtering at a
/// hair's edge meets no black.
fn dilated(levels: &[Vec<Texel>]) -> Vec<Vec<Vec3>> {
    let mut colours: Vec<Vec<Vec3>> = Vec::new();
    for level in levels.iter().rev() {
        let size = level.len().isqrt();
        let colour = |(i, t): (usize, &Texel)| {
            if t.extinction > 0.0 {
                return t.colour / t.extinction;
            }
            let parent = |coarse: &Vec<Vec3>| coarse[i / size / 2 * (size / 2) + i % size / 2];
            colours.last().map_or(Vec3::ZERO, parent)
        };
        let filled = level.iter().enumerate().map(colour).collect();
        colours.push(filled);
    }
    colours.reverse();
    colours
}

fn code(texels: usize, channels: u32, pixel: impl Fn(usize) -> [u8; 4]) -> Image8 {
    let size = texels.isqrt() as u32;
    let pixels = (0..texels).flat_map(|i| pixel(i).into_iter().take(channels as usize)).collect();
    Image8 { width: size, height: size, channels, pixels }
}

fn code_albedo(texels: &[Texel], colours: &[Vec3]) -> Image8 {
    code(texels.len(), 4, |i| {
        let c = colours[i].map(|v| srgb_from_linear(v.clamp(0.0, 1.0)));
        [unorm8(c.x), unorm8(c.y), unorm8(c.z), code_above(texels[i].above)]
    })
}

fn code_medium(texels: &[Texel], scale: f32) -> Image8 {
    code(texels.len(), 4, |i| {
        let t = texels[i].tangent / scale;
        [unorm8(texels[i].extinction / scale), signed8(t.x), signed8(t.y), signed8(t.z)]
    })
}

fn code_ends(texels: &[Texel]) -> Image8 {
    code(texels.len(), 1, |i| [unorm8(texels[i].ends), 0, 0, 0])
}

/// [−1, 1] to a byte with 128 for 0.
pub fn signed8(value: f32) -> u8 {
    (value.clamp(-1.0, 1.0) * 127.0 + 128.5) as u8
}
