//! Whether a coat's seams show on the tile that it wears (`docs/steps/patch.md`).

use super::wear::evenly;
use crate::data::coat::Tile;
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Seams};
use crate::fur::patch::{PIXEL, Place, compare_seams};
use crate::math::{Mat3, Vec3};
use crate::runtime::cpu::{Stack, View};

/// Angles between ray and normal at which seams are looked at, degrees.
pub const ANGLES_DEG: [f32; 3] = [0.0, 45.0, 75.0];

/// A coat's seams before and after patches were moved against them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeforeAfter {
    /// Every patch at an offset by chance.
    pub by_chance: Seams,
    /// As they are worn.
    pub worn: Seams,
}

/// Looks at the seams of `patches` on `mesh` as `tile` shows them: the luminance of the stack under hair that leans as
/// `offset` does (root to the top of the stack over its height, one per skin vertex, world axes), from [`ANGLES_DEG`] and
/// from the same side on both sides of a seam.
pub fn look(mesh: &Mesh, offset: &[Vec3], patches: &Patches, tile: &Tile) -> Seams {
    compare(mesh, offset, [patches], tile)[0]
}

/// [`look`] before and after patches were moved against seams.
pub fn before_after(mesh: &Mesh, offset: &[Vec3], patches: &Patches, tile: &Tile) -> BeforeAfter {
    if patches.chance_uv.is_empty() {
        let worn = look(mesh, offset, patches, tile);
        return BeforeAfter { by_chance: worn, worn };
    }
    let [worn, by_chance] = compare(mesh, offset, [patches, &patches.by_chance()], tile);
    BeforeAfter { by_chance, worn }
}

fn compare<const N: usize>(mesh: &Mesh, offset: &[Vec3], sets: [&Patches; N], tile: &Tile) -> [Seams; N] {
    let stack = Stack::new(tile);
    let size = tile.shells.size;
    let densities = sets.map(|patches| evenly(mesh, patches, tile.edge_m));
    compare_seams(mesh, sets, tile.edge_m, size, |set, place| {
        let views = ANGLES_DEG.map(|theta| view(place, offset, theta, PIXEL as f32 / size as f32));
        let [a, b] = place.ends.map(|v| densities[set][v as usize]);
        let density = a + (b - a) * place.edge.1;
        place.uv.iter().map(|&uv| views.map(|view| stack.brightness(uv, &view, density))).collect()
    })
}

fn view(place: &Place, offset: &[Vec3], theta_deg: f32, pixel: f32) -> View {
    let (sin, cos) = libm::sincosf(theta_deg.to_radians());
    let ray = -(place.normal * cos + place.azimuth * sin);
    let ([a, b], along) = place.edge;
    let lean = offset[a as usize].lerp(offset[b as usize], along);
    // The skin's frame along the tile: x as u runs, y to its left.
    let x = place.axes[0].normalize_or(place.azimuth);
    let y = place.normal.cross(x);
    let seen = |v: Vec3| Vec3::new(v.dot(x), v.dot(y), v.dot(place.normal));
    let up = seen(lean);
    let up = Vec3::new(up.x, up.y, up.z.max(1e-3));
    View { direction: seen(ray), skin_from_tile: Mat3::from_cols(seen(place.axes[0]), seen(place.axes[1]), up), pixel }
}
