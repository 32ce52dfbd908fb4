//! Ribbons, undercoat and skin of one tile in one order.

use super::film::FilmRows;
use super::gather::Gathered;
use super::pass::Pass;
use super::scratch::{Scratch, TileView};
use crate::data::film::Layers;
use crate::hybrid::flat::{Flat, pixel_ray};
use crate::hybrid::resolve::{self, Appearance, Blending};
use crate::hybrid::settings::Settings;
use crate::hybrid::skin::{self, NONE};
use crate::hybrid::strands::Fragment;
use crate::math::{Vec2, Vec3, lanes};
use crate::volume::bins::TILE;

impl Pass<'_> {
    /// Puts what a tile's pixels hold into one order and colours the film.
    pub(super) fn compose(&self, tile: &TileView<'_>, scratch: &Scratch, out: &mut FilmRows<'_>) {
        lanes::run(Compose { pass: self, tile, scratch, out });
    }

    #[inline(always)]
    fn compose_pixels(&self, tile: &TileView<'_>, scratch: &Scratch, out: &mut FilmRows<'_>) {
        let Settings { layers, blending, opaque, .. } = *self.settings;
        for (at, x, y) in tile.pixels() {
            scratch.guard.call((at + 1) % (TILE * TILE));
            let skin_face = || self.skin_face(x, y, tile.skin.triangle[at]);
            let face = |f: &Fragment| self.hair_face(f, &scratch.guard);
            let (mut fragments, virtual_fragments) = (scratch.guard.of(at), &scratch.virtual_fragments[at]);
            if let Blending::Simplified { .. } = blending {
                // Hair thins the undercoat before it, but only as far as that lets it be seen.
                fragments = &fragments[..fragments.partition_point(|f| f.z_m() <= scratch.opaque_m[at])];
            }
            let pixel = resolve::composite(layers, fragments, virtual_fragments, blending, opaque, skin_face, face);
            let depth_scale = pixel_ray(&self.view, x, y).length();
            out.add(y - tile.from[1], x, &pixel, depth_scale);
        }
    }

    fn skin_face(&self, x: usize, y: usize, triangle: u32) -> Option<Appearance> {
        if triangle == NONE {
            return None;
        }
        let meeting = Flat::new(self.corners(triangle)).meet(pixel_ray(&self.view, x, y))?;
        let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let (b, z_m) = (meeting.barycentric, meeting.z_m);
        Some(skin::shade(self.prepared, triangle, b, direction, z_m))
    }

    #[inline(always)]
    fn hair_face(&self, fragment: &Fragment, guard: &Gathered) -> Appearance {
        let ribbon_row = guard.ribbon_row(fragment);
        let Some((strands, _)) = self.guard.as_ref().filter(|_| self.settings.layers != Layers::Light) else {
            return Appearance { radiance: ribbon_row.radiance, ..Appearance::default() };
        };
        let surface = guard.surface(ribbon_row);
        Appearance {
            z_m: fragment.z_m(),
            radiance: ribbon_row.radiance,
            albedo: surface.tint * strands.profile.ramp_at(guard.along(fragment)),
            tangent: surface.tangent,
            normal: Vec3::ZERO,
        }
    }
}

/// Colours the pixels of a tile, by the instructions of the machine at hand.
struct Compose<'a, 'p, 'f> {
    pass: &'a Pass<'p>,
    tile: &'a TileView<'a>,
    scratch: &'a Scratch,
    out: &'a mut FilmRows<'f>,
}

impl lanes::Work for Compose<'_, '_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<I: lanes::Isa>(self) {
        self.pass.compose_pixels(self.tile, self.scratch, self.out);
    }
}
