//! Ribbons of guard hair and rays through undercoat in one tile of the picture.

use super::brush::Brush;
use super::gather::Stroke;
use super::pass::{Band, Pass};
use super::scratch::{Scratch, TileView};
use super::undercoat::{self, PixelJourney};
use crate::data::film::Layers;
use crate::data::strands::Strands;
use crate::hybrid::entrances::Entrances;
use crate::hybrid::flat::{self, Flat, pixel_ray};
use crate::hybrid::resolve::Blending;
use crate::hybrid::skin::NONE;
use crate::hybrid::strands::ribbon::Window;
use crate::math::{Vec2, lanes, radix};
use crate::volume::bins::TILE;
use crate::volume::march::Journey;

impl Pass<'_> {
    /// Gathers the fragments of guard hair: nearest pieces first, so that most of those that hide behind them are never
    /// drawn.
    pub(super) fn gather(&self, place: &TileView<'_>, band: &Band, scratch: &mut Scratch) {
        let Scratch { guard, pieces, spare, fragment_count, .. } = scratch;
        guard.begin(self.settings.opaque, |at| [self.limit_m(place, at), self.clear_m(place, at)]);
        let Some((strands, _)) = &self.guard else { return };
        pieces.clear();
        // Positive floats are ordered as their bits.
        let nearest_m = |piece: u32| band.knots[piece as usize].z_m.min(band.knots[piece as usize + 1].z_m).max(0.0);
        let keyed = |&piece: &u32| u64::from(nearest_m(piece).to_bits()) << 32 | u64::from(piece);
        pieces.extend(band.bins.of(place.in_band).iter().map(keyed));
        radix::sort(pieces, spare);
        let window = Window { from: place.from.map(|v| v as i32), to: place.to.map(|v| v as i32) };
        lanes::run(Brush { pass: self, strands, place, band, pieces, window, guard });
        *fragment_count += guard.count() as u64;
        guard.settle();
        if self.settings.layers != Layers::Light {
            guard.face(|piece| self.stroke(strands, band, piece));
        }
    }

    /// Depth behind which a pixel's skin hides hair wherever in the pixel it stands, m; infinite where there is none.
    fn limit_m(&self, place: &TileView<'_>, at: usize) -> f32 {
        let (x, y) = (place.from[0] + at % TILE, place.from[1] + at / TILE);
        if x >= place.to[0] || y >= place.to[1] {
            return f32::NEG_INFINITY;
        }
        let triangle = place.skin.triangle[at];
        if triangle == NONE {
            return f32::INFINITY;
        }
        let flat = Flat::new(self.corners(triangle));
        let corner_m = |i: usize| {
            let corner = Vec2::new((x + i % 2) as f32, (y + i / 2) as f32);
            let z_m = flat.plane_depth(((corner - self.view.centre_px) / self.view.focal_px).extend(1.0));
            if z_m > 0.0 { z_m } else { f32::INFINITY }
        };
        (0..4).map(corner_m).fold(place.skin.z_m[at], f32::max)
    }

    /// Depth before which hair lies before a pixel's skin wherever in the pixel it stands, m.
    fn clear_m(&self, place: &TileView<'_>, at: usize) -> f32 {
        match place.skin.triangle[at] {
            NONE => f32::INFINITY,
            triangle if self.bare[triangle as usize] => f32::NEG_INFINITY,
            _ => place.skin.z_m[at],
        }
    }

    /// Marches the rays of one tile through the undercoat, as far as what [`Self::gather`] found lets it be seen.
    pub(super) fn march(&self, entrances: &Entrances, place: &TileView<'_>, scratch: &mut Scratch) {
        let Some((shadows, shader)) = &self.undercoat else { return };
        let Scratch { starts, journeys, stretches, opaque_m, guard, step_count, .. } = scratch;
        for (face, corners) in entrances.of_tile(place.in_picture) {
            let flat = Flat::new(corners);
            let [columns, rows] = self.pixels(&flat::reach(&self.view, &corners));
            for y in rows.start.max(place.from[1])..rows.end.min(place.to[1]) {
                for x in columns.start.max(place.from[0])..columns.end.min(place.to[0]) {
                    let at = place.at(x, y);
                    let ray = pixel_ray(&self.view, x, y);
                    if let Some(meeting) = flat.meet(ray)
                        && flat.faces_eye()
                        && meeting.z_m < place.skin.z_m[at]
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
        for (at, ..) in place.pixels() {
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
            journeys.clear();
            for (at, x, y) in place.pixels() {
                let Some(&start) = starts[at].get(rank) else { continue };
                let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let scale = direction.length();
                let far_m = opaque_m[at].min(place.skin.z_m[at]) * scale;
                if start.at_m < far_m {
                    let journey = Journey { origin_m: self.view.eye_m, direction: direction / scale, start, far_m };
                    journeys.push(PixelJourney { pixel: at as u32, z_per_m: 1.0 / scale, journey });
                }
            }
            *step_count += lanes::run(undercoat::Look {
                shadows,
                shader,
                stepping: &self.settings.stepping,
                fragments,
                opaque: self.settings.opaque,
                veiled,
                journeys,
                stretches,
                opaque_m,
                layers: self.settings.layers,
            });
        }
        // Marches of one pixel may pass through one another.
        if most > 1 {
            stretches.iter_mut().for_each(|some| some.sort_by(|a, b| a.from_m.total_cmp(&b.from_m)));
        }
    }

    /// What all fragments of a piece have in common.
    fn stroke(&self, strands: &Strands, band: &Band, piece: u32) -> Stroke {
        let points = strands.points_per_strand;
        let (strand, first) = (band.strands[piece as usize / points] as usize, piece as usize % points);
        let points_m = strands.points_of_m(strand);
        Stroke { tangent: (points_m[first + 1] - points_m[first]).normalize_or_zero(), tint: strands.tint[strand] }
    }
}
