//! Whether a coat's seams show on the tile that it carries (`docs/steps/patch.md`).

use super::axes::Stand;
use crate::data::coat::Tile;
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Seams};
use crate::data::shell::{Incidence, Stack, slab_optical_depth};
use crate::fur::patch::{PIXEL, SeamPoint, compare_seams};

pub use crate::fur::patch::WINDOWS;
use crate::math::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Angles between ray and normal at which seams are looked at, degrees.
pub const ANGLES_DEG: [f32; 3] = [0.0, 45.0, 75.0];

/// A coat's seams before and after patches were moved against them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeforeAfter {
    /// Every patch at an offset by chance.
    pub by_chance: Seams,
    /// As they lie on the skin.
    pub on_skin: Seams,
}

/// Looks at the seams of `patches` on `mesh` as `tile` shows them: the luminance of the stack under hair that leans as
/// `offset` does (root to the top of the stack over its height) and stands along `axis` (see [`axes`](super::axes::axes)),
/// both one per skin vertex in world axes, from [`ANGLES_DEG`] and from the same side on both sides of a seam.
pub fn measure_coat(mesh: &Mesh, offset: &[Vec3], axis: &[Vec3], patches: &Patches, tile: &Tile) -> Seams {
    compare(mesh, offset, axis, [patches], tile, WINDOWS)[0]
}

/// [`measure_coat`] before and after patches were moved against seams, through so many `windows` (say [`WINDOWS`]) each.
pub fn before_after(
    mesh: &Mesh,
    offset: &[Vec3],
    axis: &[Vec3],
    patches: &Patches,
    tile: &Tile,
    windows: usize,
) -> BeforeAfter {
    if patches.chance_uv.is_empty() {
        let [on_skin] = compare(mesh, offset, axis, [patches], tile, windows);
        return BeforeAfter { by_chance: on_skin, on_skin };
    }
    let [on_skin, by_chance] = compare(mesh, offset, axis, [patches, &patches.by_chance()], tile, windows);
    BeforeAfter { by_chance, on_skin }
}

fn compare<const N: usize>(
    mesh: &Mesh,
    offset: &[Vec3],
    axis: &[Vec3],
    sets: [&Patches; N],
    tile: &Tile,
    windows: usize,
) -> [Seams; N] {
    let stack = Stack::new(tile);
    let size = tile.shells.size;
    compare_seams(mesh, sets, tile.edge_m, size, windows, |_, place| {
        let views = ANGLES_DEG.map(|theta| seen_at(place, offset, axis, theta, PIXEL as f32 / size as f32));
        place.uv.iter().map(|&uv| views.map(|seen| brightness(&stack, tile, uv, &seen))).collect()
    })
}

fn seen_at(place: &SeamPoint, offset: &[Vec3], axis: &[Vec3], theta_deg: f32, pixel: f32) -> Incidence {
    let (sin, cos) = libm::sincosf(theta_deg.to_radians());
    let ray = -(place.normal * cos + place.azimuth * sin);
    let ([a, b], along) = place.edge;
    let between = |field: &[Vec3]| field[a as usize].lerp(field[b as usize], along);
    let (axis, up) = (between(axis), between(offset));
    Stand { normal: place.normal, axis, up, texture: place.axes, spread: 1.0 }.seen(ray, pixel)
}

/// What lies behind hair that lets less than this through is not looked at.
const HIDDEN: f32 = 1e-3;

/// Luminance that leaves a tile's stack towards the eye along the view ray through `uv`, under a light of radiosity 1 above:
/// slabs from the outside in, each by its opacity, then the skin.
fn brightness(stack: &Stack<'_>, tile: &Tile, uv: Vec2, seen: &Incidence) -> f32 {
    let (mut through, mut light) = (1.0, 0.0);
    for layer in (1..tile.shells.layers as usize).rev() {
        if through < HIDDEN {
            return light;
        }
        let texel = stack.fetch_nearest(layer, stack.middle(layer, uv, seen), seen);
        let clear = libm::expf(-stack.gain(layer, seen) * slab_optical_depth(&texel, seen, stack.slab_m(layer)));
        light += through * (1.0 - clear) * texel.brightness;
        through *= clear;
    }
    light + through * stack.skin(uv).brightness
}
