//! Ribbons of guard hair and rays through undercoat in one tile of the picture.

use super::gather::SegmentSurface;
use super::pass::{Pass, StrandBand};
use super::rasterise::Rasteriser;
use super::scratch::{Scratch, TileView};
use super::undercoat::{self, PixelRay};
use crate::data::film::Layers;
use crate::data::strands::Strands;
use crate::hybrid::entrances::Entrances;
use crate::hybrid::flat::{self, Flat, pixel_ray};
use crate::hybrid::resolve::Blending;
use crate::hybrid::skin::NONE;
use crate::hybrid::strands::ribbon::Window;
use crate::math::{Vec2, lanes, radix};
use crate::volume::bins::TILE;
use crate::volume::march::MarchRay;

impl Pass<'_> {
    /// Gathers the fragments of guard hair: nearest segments first, so that most of those that hide behind them are never
    /// drawn.
    pub(super) fn gather(&self, tile: &TileView<'_>, band: &StrandBand, scratch: &mut Scratch) {
        let Scratch { guard, segments, spare, fragment_count, .. } = scratch;
        guard.begin(self.settings.opaque, |at| [self.limit_m(tile, at), self.clear_m(tile, at)]);
        let Some((strands, _)) = &self.guard else { return };
        segments.clear();
        // Positive floats are ordered as their bits.
        let nearest_m = |segment: u32| {
            band.ribbon_points[segment as usize].z_m.min(band.ribbon_points[segment as usize + 1].z_m).max(0.0)
        };
        let keyed = |&segment: &u32| u64::from(nearest_m(segment).to_bits()) << 32 | u64::from(segment);
        segments.extend(band.bins.of(tile.in_band).iter().map(keyed));
        radix::sort(segments, spare);
        let window = Window { from: tile.from.map(|v| v as i32), to: tile.to.map(|v| v as i32) };
        lanes::run(Rasteriser { pass: self, strands, tile, band, segments, window, guard });
        *fragment_count += guard.count() as u64;
        guard.settle();
        if self.settings.layers != Layers::Light {
            guard.face(|segment| self.surface(strands, band, segment));
        }
    }

    /// Depth behind which a pixel's skin hides hair wherever in the pixel it stands, m; infinite where there is none.
    fn limit_m(&self, tile: &TileView<'_>, at: usize) -> f32 {
        let (x, y) = (tile.from[0] + at % TILE, tile.from[1] + at / TILE);
        if x >= tile.to[0] || y >= tile.to[1] {
            return f32::NEG_INFINITY;
        }
        let triangle = tile.skin.triangle[at];
        if triangle == NONE {
            return f32::INFINITY;
        }
        let flat = Flat::new(self.corners(triangle));
        let corner_m = |i: usize| {
            let corner = Vec2::new((x + i % 2) as f32, (y + i / 2) as f32);
            let z_m = flat.plane_depth(((corner - self.view.centre_px) / self.view.focal_px).extend(1.0));
            if z_m > 0.0 { z_m } else { f32::INFINITY }
        };
        (0..4).map(corner_m).fold(tile.skin.z_m[at], f32::max)
    }

    /// Depth before which hair lies before a pixel's skin wherever in the pixel it stands, m.
    fn clear_m(&self, tile: &TileView<'_>, at: usize) -> f32 {
        match tile.skin.triangle[at] {
            NONE => f32::INFINITY,
            triangle if self.bare[triangle as usize] => f32::NEG_INFINITY,
            _ => tile.skin.z_m[at],
        }
    }

    /// Marches the rays of one tile through the undercoat, as far as what [`Self::gather`] found lets it be seen.
    pub(super) fn march(&self, entrances: &Entrances, tile: &TileView<'_>, scratch: &mut Scratch) {
        let Some((shadows, shader)) = &self.undercoat else { return };
        let Scratch { starts, rays, virtual_fragments, opaque_m, guard, step_count, .. } = scratch;
        for (face, corners) in entrances.of_tile(tile.in_picture) {
            let flat = Flat::new(corners);
            let [columns, rows] = self.pixels(&flat::reach(&self.view, &corners));
            for y in rows.start.max(tile.from[1])..rows.end.min(tile.to[1]) {
                for x in columns.start.max(tile.from[0])..columns.end.min(tile.to[0]) {
                    let at = tile.at(x, y);
                    let ray = pixel_ray(&self.view, x, y);
                    if let Some(meeting) = flat.meet(ray)
                        && flat.faces_eye()
                        && meeting.z_m < tile.skin.z_m[at]
                    {
                        let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)).normalize();
                        let ray_m = [self.view.eye_m, direction];
                        let at_m = meeting.z_m * ray.length();
                        starts[at].push(entrances.start(
                            shadows.volume.shell(),
                            face,
                            meeting.barycentric,
                            at_m,
                            ray_m,
                        ));
                    }
                }
            }
        }
        let mut most = 0;
        for (at, ..) in tile.pixels() {
            let starts = &mut starts[at];
            starts.extend(entrances.around_eye());
            // Faces that meet on a ray give one entrance each: the next march begins where the last one ended.
            starts.sort_unstable_by(|a, b| a.at_m.total_cmp(&b.at_m).then(a.triangle.cmp(&b.triangle)));
            starts.dedup_by(|next, kept| next.at_m - kept.at_m < 1e-6 * kept.at_m);
            most = most.max(starts.len());
            if let Blending::Virtual { .. } = self.settings.blending {
                opaque_m[at] = guard.limit_m(at);
            }
        }
        let (fragments, veiled) = match self.settings.blending {
            Blending::Virtual { fragments } => (fragments, Some(&*guard)),
            Blending::Simplified { .. } => (1, None),
        };
        // The first march of every pixel, then the second: what lies behind an opaque one is not followed.
        for rank in 0..most {
            rays.clear();
            for (at, x, y) in tile.pixels() {
                let Some(&start) = starts[at].get(rank) else { continue };
                let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let scale = direction.length();
                let far_m = opaque_m[at].min(tile.skin.z_m[at]) * scale;
                if start.at_m < far_m {
                    let march_ray = MarchRay { origin_m: self.view.eye_m, direction: direction / scale, start, far_m };
                    rays.push(PixelRay { pixel: at as u32, z_per_m: 1.0 / scale, march_ray });
                }
            }
            *step_count += lanes::run(undercoat::EyeRays {
                shadows,
                shader,
                stepping: &self.settings.stepping,
                fragments,
                opaque: self.settings.opaque,
                veiled,
                rays,
                virtual_fragments,
                opaque_m,
                layers: self.settings.layers,
            });
        }
        // Marches of one pixel may pass through one another.
        if most > 1 {
            virtual_fragments.iter_mut().for_each(|some| some.sort_by(|a, b| a.from_m.total_cmp(&b.from_m)));
        }
    }

    /// What all fragments of a segment have in common.
    fn surface(&self, strands: &Strands, band: &StrandBand, segment: u32) -> SegmentSurface {
        let points = strands.points_per_strand;
        let (strand, first) = (band.strands[segment as usize / points] as usize, segment as usize % points);
        let points_m = strands.points_of_m(strand);
        SegmentSurface {
            tangent: (points_m[first + 1] - points_m[first]).normalize_or_zero(),
            tint: strands.tint[strand],
        }
    }
}
