//! One tile of the picture: rays through undercoat, ribbons of guard hair, and both in one order.

use super::film::FilmRows;
use super::pass::{Band, Pass};
use super::undercoat::{Look, PixelJourney};
use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3, lanes};
use crate::render::bins::{Grid, TILE};
use crate::render::flat::{self, Flat, pixel_ray};
use crate::render::march::enter::Entrances;
use crate::render::march::{Journey, Start};
use crate::render::resolve::{self, Blending, Face, Stretch};
use crate::render::skin::{self, NONE, SkinTile};
use crate::render::strands::ribbon::{self, Share, Window};
use crate::render::strands::{Fragment, Knot};

impl Pass<'_> {
    /// Draws one tile, over the undercoat that [`Self::march_tile`] found there.
    #[expect(clippy::too_many_arguments, reason = "the tile's place and its inputs, each of another kind")]
    pub(super) fn tile(
        &self,
        grid: &Grid,
        column: usize,
        row: usize,
        skin_tile: &SkinTile,
        band: &Band,
        scratch: &mut Scratch,
        out: &mut FilmRows<'_>,
    ) {
        let [width, height] = self.settings.size;
        let (x0, y0) = (column * TILE, (grid.first_row + row) * TILE);
        let window = Window {
            from: [x0 as i32, y0 as i32],
            to: [(x0 + TILE).min(width) as i32, (y0 + TILE).min(height) as i32],
        };
        let Scratch { pixels, stretches, opaque_m, trim_at, fragment_count, .. } = scratch;
        if let Some((strands, _)) = &self.guard {
            let points = strands.points_per_strand;
            for &piece in band.bins.of(row * grid.columns + column) {
                let (a, b) = (&band.knots[piece as usize], &band.knots[piece as usize + 1]);
                let id = strands.id[band.strands[piece as usize / points] as usize];
                ribbon::rasterise(a, b, window, |share| {
                    let [x, y] = share.pixel.map(|v| v as usize);
                    let at = (y - y0) * TILE + x - x0;
                    let z_m = a.z_m + share.along * (b.z_m - a.z_m);
                    let before_skin =
                        z_m < skin_tile.z_m[at] || self.before_skin(a, b, &share, z_m, skin_tile.triangle[at]);
                    if z_m <= opaque_m[at] && before_skin {
                        let Share { coverage, along, .. } = share;
                        pixels[at].push(Fragment::new(z_m, id, coverage, piece, along));
                        *fragment_count += 1;
                        if pixels[at].len() == trim_at[at] {
                            let opaque = resolve::trim(&mut pixels[at], |f| self.opacity(strands, f));
                            opaque_m[at] = opaque_m[at].min(opaque);
                            trim_at[at] = TRIM_AT.max(2 * pixels[at].len());
                        }
                    }
                });
            }
        }
        for y in y0..(y0 + TILE).min(height) {
            for x in x0..(x0 + TILE).min(width) {
                let at = (y - y0) * TILE + x - x0;
                let fragments = &mut pixels[at];
                resolve::order(fragments);
                let skin_face = self.skin_face(x, y, skin_tile.triangle[at]);
                let face = |f: &Fragment| match &self.guard {
                    Some((strands, _)) => self.hair_face(strands, band, f),
                    None => (Face::default(), 0.0),
                };
                let pixel =
                    resolve::composite(fragments, &stretches[at], self.settings.blending, skin_face.as_ref(), face);
                let depth_scale = pixel_ray(&self.view, x, y).length();
                out.set(y - y0, x, &pixel, depth_scale);
            }
        }
    }

    /// Marches the rays of one tile through the undercoat.
    pub(super) fn march_tile(
        &self,
        entrances: &Entrances,
        tile: usize,
        column: usize,
        row: usize,
        skin_tile: &SkinTile,
        scratch: &mut Scratch,
    ) {
        let Some((volume, shader)) = &self.undercoat else { return };
        let [width, height] = self.settings.size;
        let (x0, y0) = (column * TILE, row * TILE);
        let Scratch { starts, journeys, stretches, opaque_m, step_count, .. } = scratch;
        for (face, corners) in entrances.of_tile(tile) {
            let flat = Flat::new(corners);
            let [columns, rows] = self.pixels(&flat::reach(&self.view, &corners));
            for y in rows.start.max(y0)..rows.end.min(y0 + TILE) {
                for x in columns.start.max(x0)..columns.end.min(x0 + TILE) {
                    let at = (y - y0) * TILE + x - x0;
                    let ray = pixel_ray(&self.view, x, y);
                    if let Some(meeting) = flat.meet(ray)
                        && flat.faces_eye()
                        && meeting.z_m < skin_tile.z_m[at]
                    {
                        starts[at].push(entrances.start(face, meeting.barycentric, meeting.z_m * ray.length()));
                    }
                }
            }
        }
        journeys.clear();
        for y in y0..(y0 + TILE).min(height) {
            for x in x0..(x0 + TILE).min(width) {
                let at = (y - y0) * TILE + x - x0;
                starts[at].extend(entrances.around_eye());
                if starts[at].is_empty() {
                    continue;
                }
                // Faces that meet on a ray give one entrance each: the next march begins where the last one ended.
                starts[at].sort_unstable_by(|a, b| a.at_m.total_cmp(&b.at_m).then(a.triangle.cmp(&b.triangle)));
                starts[at].dedup_by(|next, kept| next.at_m - kept.at_m < 1e-6 * kept.at_m);
                let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let scale = direction.length();
                journeys.extend(starts[at].iter().map(|&start| PixelJourney {
                    pixel: at as u32,
                    z_per_m: 1.0 / scale,
                    journey: Journey {
                        origin_m: self.view.eye_m,
                        direction: direction / scale,
                        start,
                        far_m: skin_tile.z_m[at] * scale,
                    },
                }));
            }
        }
        let fragments = match self.settings.blending {
            Blending::Virtual { fragments } => fragments,
            Blending::Simplified { .. } => 1,
        };
        *step_count += lanes::run(Look {
            volume,
            shader,
            stepping: &self.settings.stepping,
            fragments,
            journeys,
            stretches,
            opaque_m,
        });
        // Rays of one pixel may be followed side by side.
        stretches.iter_mut().for_each(|some| some.sort_by(|a, b| a.from_m.total_cmp(&b.from_m)));
    }

    /// Whether a hair that lies behind the skin of a pixel's middle lies before the skin of its own place: on slanting
    /// skin, half of the roots would else be lost.
    fn before_skin(&self, a: &Knot, b: &Knot, share: &Share, z_m: f32, triangle: u32) -> bool {
        let at = |from: f32, to: f32, pixel: i32| {
            (from + share.linear * (to - from)).clamp(pixel as f32, (pixel + 1) as f32)
        };
        let pixel = Vec2::new(at(a.x, b.x, share.pixel[0]), at(a.y, b.y, share.pixel[1]));
        let ray = ((pixel - self.view.centre_px) / self.view.focal_px).extend(1.0);
        triangle != NONE && z_m < Flat::new(self.corners(triangle)).plane_depth(ray)
    }

    fn skin_face(&self, x: usize, y: usize, triangle: u32) -> Option<Face> {
        if triangle == NONE {
            return None;
        }
        let meeting = Flat::new(self.corners(triangle)).meet(pixel_ray(&self.view, x, y))?;
        let direction = self.view.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let (b, z_m) = (meeting.barycentric, meeting.z_m);
        Some(skin::look(self.pelt, self.lighting, self.normals, triangle, b, direction, z_m))
    }

    fn hair_face(&self, strands: &Strands, band: &Band, fragment: &Fragment) -> (Face, f32) {
        let (at, points) = (fragment.knot as usize, strands.points_per_strand);
        let (a, b) = (&band.looks[at], &band.looks[at + 1]);
        let of_strand = strands.points_of_m(band.strands[at / points] as usize);
        let piece = at % points;
        let face = Face {
            z_m: fragment.z_m(),
            radiance: a.radiance.lerp(b.radiance, fragment.along),
            albedo: a.albedo.lerp(b.albedo, fragment.along),
            tangent: (of_strand[piece + 1] - of_strand[piece]).normalize_or_zero(),
            normal: Vec3::ZERO,
        };
        (face, self.opacity(strands, fragment))
    }

    /// A hair's own opacity: it curves too much to go linearly between a strand's few points.
    fn opacity(&self, strands: &Strands, fragment: &Fragment) -> f32 {
        let points = strands.points_per_strand;
        let piece = fragment.knot as usize % points;
        self.opacity.at((piece as f32 + fragment.along) / (points - 1) as f32)
    }
}

/// Fragments of a pixel from which on it pays to look for an opaque front.
const TRIM_AT: usize = 48;

/// What a tile's pixels hold, kept between tiles for its memory.
pub(super) struct Scratch {
    pixels: Vec<Vec<Fragment>>,
    starts: Vec<Vec<Start>>,
    journeys: Vec<PixelJourney>,
    stretches: Vec<Vec<Stretch>>,
    /// Depth from which undercoat hides everything, m.
    opaque_m: Vec<f32>,
    /// How many fragments a pixel gathers before those behind an opaque front are left out.
    trim_at: Vec<usize>,
    pub(super) fragment_count: u64,
    pub(super) step_count: u64,
}

impl Scratch {
    /// Forgets the last tile.
    pub(super) fn clear(&mut self) {
        self.pixels.iter_mut().for_each(Vec::clear);
        self.starts.iter_mut().for_each(Vec::clear);
        self.stretches.iter_mut().for_each(Vec::clear);
        self.opaque_m.fill(f32::INFINITY);
        self.trim_at.fill(TRIM_AT);
    }
}

impl Default for Scratch {
    fn default() -> Self {
        const SIZE: usize = TILE * TILE;
        Self {
            pixels: vec![Vec::new(); SIZE],
            starts: vec![Vec::new(); SIZE],
            journeys: Vec::new(),
            stretches: vec![Vec::new(); SIZE],
            opaque_m: vec![f32::INFINITY; SIZE],
            trim_at: vec![TRIM_AT; SIZE],
            fragment_count: 0,
            step_count: 0,
        }
    }
}
