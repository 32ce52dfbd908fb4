//! A picture of a pelt through a camera: bands of rows, and tiles within them (`docs/steps/strands.md`).

use super::bins::{Bins, Grid, Reach, TILE};
use super::flat::{self, Flat, pixel_ray};
use super::march::enter::Entrances;
use super::march::light::UndercoatShader;
use super::march::volume::{Resolution, Volume};
use super::march::{self, Start, Stepping};
use super::pelt::{Lighting, Pelt};
use super::rays::Camera;
use super::resolve::{self, Blending, Face, OPAQUE, Pixel, Stretch};
use super::skin::{self, NONE, SkinTile};
use super::strands::ribbon::{self, Share, Window};
use super::strands::shade::GuardShader;
use super::strands::{Fragment, Knot, Look, project};
use super::view::View;
use crate::data::film::Film;
use crate::data::strands::Strands;
use crate::error::Result;
use crate::fur::undercoat::Undercoat;
use crate::math::fast::exp_negative;
use crate::math::{Vec2, Vec3, sampling};
use rayon::prelude::*;
use std::time::Instant;

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Passes at different places within the pixels, averaged; at least 1. Andersen et al. 2016 use 4.
    pub passes: usize,
    /// How guard hair and undercoat are ordered.
    pub blending: Blending,
    /// How finely rays are followed through undercoat.
    pub stepping: Stepping,
    /// How finely undercoat is stored.
    pub resolution: Resolution,
    /// Memory for the strands of a band of rows, bytes: smaller budgets give more bands and the same picture.
    pub band_bytes: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [512, 512],
            passes: 1,
            blending: Blending::Virtual { fragments: 8 },
            stepping: Stepping::default(),
            resolution: Resolution::default(),
            band_bytes: 256 << 20,
        }
    }
}

/// A step's cost: one row of Andersen et al. 2016, Table 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The step.
    pub name: &'static str,
    /// Time, ms. Steps that run tile by tile are given by their share of the threads' time.
    pub ms: f64,
    /// Memory held at most, bytes.
    pub bytes: usize,
}

/// A picture and what it took.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The film.
    pub film: Film,
    /// Time and memory per step.
    pub rows: Vec<Row>,
    /// Strands drawn, pieces and fragments of them, summed over passes and bands.
    pub counts: Counts,
}

/// How much was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Strands that were not hidden.
    pub strands: u64,
    /// Their pieces.
    pub pieces: u64,
    /// Fragments of guard hair composited.
    pub fragments: u64,
    /// Steps through undercoat.
    pub steps: u64,
    /// Sub-elements filled.
    pub subelements: u64,
}

/// Renders a picture.
///
/// # Errors
/// Names what keeps the camera from looking anywhere, or a scattering parameter out of range.
pub fn draw(pelt: &Pelt<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Picture> {
    let mut picture = Picture { film: Film::default(), rows: Vec::new(), counts: Counts::default() };
    let passes = settings.passes.max(1);
    let normals = pelt.skin.smooth_normals();
    let start = Instant::now();
    let middle = View::new(camera, settings.size, Vec2::ZERO)?;
    let subdivisions = subdivisions(pelt, &middle, &settings.resolution);
    let volume = Volume::new(pelt, &normals, lighting.key.to_light, settings.resolution, subdivisions);
    row(&mut picture, "shell", start, volume.as_ref().map_or(0, |v| v.shell().bytes()));
    for pass in 0..passes {
        let shift = if passes == 1 { Vec2::ZERO } else { sampling::r2(pass as u64, 1 << 63) - 0.5 };
        let view = View::new(camera, settings.size, shift)?;
        let film = Pass::new(pelt, lighting, &normals, volume.as_ref(), view, settings)?.run(&mut picture);
        if pass == 0 { picture.film = film } else { add(&mut picture.film, &film) }
    }
    finish(&mut picture.film, 1.0 / passes as f32);
    if let Some(volume) = &volume {
        let [density, shadow] = volume.bytes();
        picture.rows.push(Row { name: "densities", ms: 0.0, bytes: density });
        picture.rows.push(Row { name: "shadows", ms: 0.0, bytes: shadow });
        picture.counts.subelements = density as u64;
    }
    Ok(picture)
}

/// Subdivisions d per triangle: sub-elements about as large as asked for on the picture, but no finer than what there is
/// to see.
fn subdivisions(pelt: &Pelt<'_>, view: &View, resolution: &Resolution) -> Vec<u8> {
    let Some(fibre) = pelt.undercoat else { return Vec::new() };
    let detail_m = Undercoat::new(fibre, resolution.pattern).detail_m();
    (0..pelt.skin.triangles.len())
        .map(|t| {
            let corners = pelt.skin.corners_m(t);
            let edge_m = (0..3).map(|i| corners[i].distance(corners[(i + 1) % 3])).fold(0.0, f32::max);
            let nearest_m = corners.map(|p| view.camera_from_world(p).z).into_iter().fold(f32::INFINITY, f32::min);
            let wanted_m = resolution.subelement_px * nearest_m.max(view.near_m) / view.focal_px;
            let splits = edge_m / wanted_m.max(detail_m);
            libm::ceilf(libm::log2f(splits.max(1.0))).clamp(0.0, resolution.most_subdivisions.min(10) as f32) as u8
        })
        .collect()
}

struct Pass<'a> {
    pelt: &'a Pelt<'a>,
    lighting: &'a Lighting,
    normals: &'a [Vec3],
    view: View,
    settings: &'a Settings,
    /// The skin's vertices in camera axes.
    skin_camera_m: Vec<Vec3>,
    guard: Option<(&'a Strands, GuardShader<'a>)>,
    undercoat: Option<(&'a Volume<'a>, UndercoatShader<'a>)>,
}

/// The strands of a band, ready to be drawn.
#[derive(Default)]
struct Band {
    strands: Vec<u32>,
    knots: Vec<Knot>,
    looks: Vec<Look>,
    bins: Bins,
}

impl<'a> Pass<'a> {
    fn new(
        pelt: &'a Pelt<'a>,
        lighting: &'a Lighting,
        normals: &'a [Vec3],
        volume: Option<&'a Volume<'a>>,
        view: View,
        settings: &'a Settings,
    ) -> Result<Self> {
        let guard = match pelt.guard {
            Some((strands, _)) => Some((strands, GuardShader::new(*pelt, strands, lighting, normals, view.eye_m)?)),
            None => None,
        };
        let skin_camera_m = pelt.skin.positions_m.iter().map(|&p| view.camera_from_world(p)).collect();
        let undercoat = volume.map(|volume| (volume, UndercoatShader::new(pelt, lighting)));
        Ok(Self { pelt, lighting, normals, view, settings, skin_camera_m, guard, undercoat })
    }

    fn run(&self, picture: &mut Picture) -> Film {
        let [width, height] = self.settings.size;
        let mut film = Film::new(width, height);
        let whole = Grid::whole(self.settings.size);

        let start = Instant::now();
        let triangles = self.pelt.skin.triangles.len();
        let skin_bins = Bins::new(&whole, triangles, |t| flat::reach(&self.view, &self.corners(t as u32)));
        let tiles: Vec<SkinTile> = (0..whole.columns * whole.rows)
            .into_par_iter()
            .map(|tile| {
                let (column, row) = (tile % whole.columns, tile / whole.columns);
                SkinTile::draw(
                    &self.view,
                    column,
                    row,
                    skin_bins.of(tile),
                    |t| self.corners(t),
                    |t| self.pixels(&flat::reach(&self.view, &self.corners(t))),
                )
            })
            .collect();
        row(picture, "base mesh", start, skin_bins.bytes() + tiles.len() * TILE * TILE * 8);

        let start = Instant::now();
        let entrances = self.undercoat.as_ref().map(|(volume, _)| Entrances::new(volume, &self.view, &whole));
        row(picture, "shell entrances", start, entrances.as_ref().map_or(0, Entrances::bytes));

        let start = Instant::now();
        let strand_reach = self.strand_reaches(&whole, &tiles);
        let bands = self.bands(&whole, &strand_reach);
        row(picture, "strand geometry", start, strand_reach.len() * size_of::<Reach>());

        for grid in bands {
            let start = Instant::now();
            let band = self.band(&grid, &strand_reach);
            let bytes = band.knots.len() * (size_of::<Knot>() + size_of::<Look>()) + band.bins.bytes();
            row(picture, "shaded strands", start, bytes);
            picture.counts.strands += band.strands.len() as u64;

            let start = Instant::now();
            let [fragments, steps] = film_rows(&mut film, &grid)
                .map(|mut rows| {
                    let mut scratch = Scratch::default();
                    let row = rows.row;
                    for column in 0..grid.columns {
                        let tile = (grid.first_row + row) * whole.columns + column;
                        if let Some(entrances) = &entrances {
                            self.march_tile(entrances, tile, column, grid.first_row + row, &tiles[tile], &mut scratch);
                        }
                        self.tile(&grid, column, row, &tiles[tile], &band, &mut scratch, &mut rows);
                    }
                    [scratch.fragment_count, scratch.step_count]
                })
                .reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
            row(picture, "march and compositing", start, 0);
            picture.counts.fragments += fragments;
            picture.counts.steps += steps;
            picture.counts.pieces += band.bins.items() as u64;
        }
        film
    }

    fn corners(&self, t: u32) -> [Vec3; 3] {
        self.pelt.skin.triangles[t as usize].map(|v| self.skin_camera_m[v as usize])
    }

    /// Columns and rows of pixels whose middles may lie in `reach`.
    fn pixels(&self, reach: &Reach) -> [std::ops::Range<usize>; 2] {
        [0, 1].map(|axis| {
            let size = self.settings.size[axis];
            let from = (reach.from[axis] - 0.5).ceil().max(0.0) as usize;
            let to = ((reach.to[axis] - 0.5).floor() + 1.0).max(0.0) as usize;
            from.min(size)..to.min(size)
        })
    }

    /// What each strand may touch; nothing where skin hides it.
    fn strand_reaches(&self, whole: &Grid, tiles: &[SkinTile]) -> Vec<Reach> {
        let Some((strands, _)) = &self.guard else { return Vec::new() };
        (0..strands.len())
            .into_par_iter()
            .map_init(Vec::new, |knots, strand| {
                knots.clear();
                project::knots(strands, strand, &self.view, knots);
                let mut all = Reach::NOTHING;
                for pair in knots.windows(2) {
                    let piece = project::reach(&self.view, &pair[0], &pair[1]);
                    all.from = [all.from[0].min(piece.from[0]), all.from[1].min(piece.from[1])];
                    all.to = [all.to[0].max(piece.to[0]), all.to[1].max(piece.to[1])];
                }
                let nearest = knots.iter().map(|k| k.z_m).fold(f32::INFINITY, f32::min);
                let (columns, mut rows) = whole.touched(&all);
                let seen =
                    rows.any(|row| columns.clone().any(|column| nearest < tiles[row * whole.columns + column].far_m));
                if seen { all } else { Reach::NOTHING }
            })
            .collect()
    }

    /// Cuts the picture into bands of whole tile rows whose strands fit the budget.
    fn bands(&self, whole: &Grid, reaches: &[Reach]) -> Vec<Grid> {
        let points = self.guard.as_ref().map_or(0, |(strands, _)| strands.points_per_strand);
        let per_strand = points * (size_of::<Knot>() + size_of::<Look>() + 12);
        let mut starting = vec![0_usize; whole.rows];
        let mut crossing = vec![0_isize; whole.rows + 1];
        for rows in reaches.iter().map(|reach| whole.touched(reach).1).filter(|rows| !rows.is_empty()) {
            starting[rows.start] += 1;
            crossing[rows.start] += 1;
            crossing[rows.end] -= 1;
        }
        let mut bands = Vec::new();
        let (mut first, mut held, mut running) = (0, 0_usize, 0_isize);
        for row in 0..whole.rows {
            let entered = running.max(0) as usize;
            if row > first && (held + starting[row]) * per_strand > self.settings.band_bytes {
                bands.push(Grid { first_row: first, rows: row - first, ..*whole });
                (first, held) = (row, entered);
            }
            held += starting[row];
            running += crossing[row];
            // Strands that end above the next row are no longer carried.
            running = running.max(0);
        }
        bands.push(Grid { first_row: first, rows: whole.rows - first, ..*whole });
        bands
    }

    fn band(&self, grid: &Grid, reaches: &[Reach]) -> Band {
        let Some((strands, shader)) = &self.guard else {
            return Band { bins: Bins::new(grid, 0, |_| Reach::NOTHING), ..Band::default() };
        };
        let visible: Vec<u32> = (0..reaches.len() as u32)
            .into_par_iter()
            .filter(|&s| {
                let (columns, rows) = grid.touched(&reaches[s as usize]);
                !columns.is_empty() && !rows.is_empty()
            })
            .collect();
        const CHUNK: usize = 512;
        let parts: Vec<(Vec<Knot>, Vec<Look>)> = visible
            .par_chunks(CHUNK)
            .map(|chunk| {
                let size = chunk.len() * strands.points_per_strand;
                let (mut knots, mut looks) = (Vec::with_capacity(size), Vec::with_capacity(size));
                for &strand in chunk {
                    project::knots(strands, strand as usize, &self.view, &mut knots);
                    shader.strand(strand as usize, &mut looks);
                }
                (knots, looks)
            })
            .collect();
        let size = visible.len() * strands.points_per_strand;
        let (mut knots, mut looks) = (Vec::with_capacity(size), Vec::with_capacity(size));
        for (some_knots, some_looks) in parts {
            knots.extend(some_knots);
            looks.extend(some_looks);
        }
        let points = strands.points_per_strand;
        let bins = Bins::new(grid, knots.len(), |i| {
            if i % points == points - 1 {
                return Reach::NOTHING;
            }
            project::reach(&self.view, &knots[i], &knots[i + 1])
        });
        Band { strands: visible, knots, looks, bins }
    }

    /// Draws one tile, over the undercoat that [`Self::march_tile`] found there.
    #[expect(clippy::too_many_arguments, reason = "the tile's place and its inputs, each of another kind")]
    fn tile(
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
        let Scratch { pixels, stretches, opaque_m, fragment_count, .. } = scratch;
        pixels.iter_mut().for_each(Vec::clear);
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
                    if z_m < opaque_m[at] && before_skin {
                        let Share { coverage, along, .. } = share;
                        pixels[at].push(Fragment { z_m, id, coverage, knot: piece, along });
                        *fragment_count += 1;
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
    fn march_tile(
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
        let Scratch { starts, stretches, opaque_m, step_count, .. } = scratch;
        starts.iter_mut().for_each(Vec::clear);
        stretches.iter_mut().for_each(Vec::clear);
        opaque_m.fill(f32::INFINITY);
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
                let through = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let direction = self.view.direction(through);
                let scale = direction.length();
                let ray =
                    PixelRay { direction: direction / scale, z_per_m: 1.0 / scale, far_m: skin_tile.z_m[at] * scale };
                for &start in &starts[at] {
                    let opaque = self.march_pixel(volume, shader, &ray, start, &mut stretches[at], step_count);
                    opaque_m[at] = opaque_m[at].min(opaque);
                }
                stretches[at].sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
            }
        }
    }

    /// Adds the stretches of one march; returns the depth from which undercoat hides everything.
    fn march_pixel(
        &self,
        volume: &Volume<'_>,
        shader: &UndercoatShader<'_>,
        ray: &PixelRay,
        start: Start,
        stretches: &mut Vec<Stretch>,
        step_count: &mut u64,
    ) -> f32 {
        let groups = match self.settings.blending {
            Blending::Virtual { fragments } => fragments.clamp(1, 64) as f32,
            Blending::Simplified { .. } => 1.0,
        };
        let mut through = 1.0_f32;
        let mut group = Group::default();
        let (eye_m, stepping) = (self.view.eye_m, &self.settings.stepping);
        march::march(volume, eye_m, ray.direction, start, ray.far_m, stepping, |step| {
            *step_count += 1;
            let left = through * exp_negative(-step.depth);
            let (albedo, radiance) = shader.look(volume, step, ray.direction);
            group.add(step, through - left, albedo, radiance);
            // A new virtual fragment at equal parts of what the march hides in the end.
            if ((1.0 - left) * groups).floor() > ((1.0 - through) * groups).floor() {
                stretches.extend(group.take(ray.z_per_m));
            }
            through = left;
            through > OPAQUE
        });
        let end_m = group.to_m.max(stretches.last().map_or(0.0, |s| s.to_m / ray.z_per_m)) * ray.z_per_m;
        stretches.extend(group.take(ray.z_per_m));
        if through > OPAQUE { f32::INFINITY } else { end_m }
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
            z_m: fragment.z_m,
            radiance: a.radiance.lerp(b.radiance, fragment.along),
            albedo: a.albedo.lerp(b.albedo, fragment.along),
            tangent: (of_strand[piece + 1] - of_strand[piece]).normalize_or_zero(),
            normal: Vec3::ZERO,
        };
        // Opacity curves too much to go linearly between a strand's few points.
        (face, strands.profile.opacity_at((piece as f32 + fragment.along) / (points - 1) as f32))
    }
}

/// The ray through a pixel's middle.
struct PixelRay {
    direction: Vec3,
    /// Depth along the optical axis per distance along the ray.
    z_per_m: f32,
    /// Where skin hides the rest, m along the ray.
    far_m: f32,
}

/// Steps of a march on their way to become one virtual fragment.
#[derive(Default)]
struct Group {
    from_m: f32,
    to_m: f32,
    depth: f32,
    weight: f32,
    radiance: Vec3,
    albedo: Vec3,
    tangent: Vec3,
}

impl Group {
    fn add(&mut self, step: &march::Step, weight: f32, albedo: Vec3, radiance: Vec3) {
        if self.depth == 0.0 {
            self.from_m = step.from_m;
        }
        self.to_m = step.from_m + step.length_m;
        self.depth += step.depth;
        self.weight += weight;
        self.radiance += weight * radiance;
        self.albedo += weight * albedo;
        self.tangent += weight * step.hair;
    }

    fn take(&mut self, z_per_m: f32) -> Option<Stretch> {
        let group = std::mem::take(self);
        let scale = 1.0 / group.weight;
        (group.depth > 0.0 && scale.is_finite()).then(|| Stretch {
            from_m: group.from_m * z_per_m,
            to_m: group.to_m * z_per_m,
            depth: group.depth,
            radiance: group.radiance * scale,
            albedo: group.albedo * scale,
            tangent: group.tangent * scale,
        })
    }
}

/// What a tile's pixels hold, kept between tiles for its memory.
struct Scratch {
    pixels: Vec<Vec<Fragment>>,
    starts: Vec<Vec<Start>>,
    stretches: Vec<Vec<Stretch>>,
    /// Depth from which undercoat hides everything, m.
    opaque_m: Vec<f32>,
    fragment_count: u64,
    step_count: u64,
}

impl Default for Scratch {
    fn default() -> Self {
        const SIZE: usize = TILE * TILE;
        Self {
            pixels: vec![Vec::new(); SIZE],
            starts: vec![Vec::new(); SIZE],
            stretches: vec![Vec::new(); SIZE],
            opaque_m: vec![f32::INFINITY; SIZE],
            fragment_count: 0,
            step_count: 0,
        }
    }
}

fn row(picture: &mut Picture, name: &'static str, start: Instant, bytes: usize) {
    let ms = start.elapsed().as_secs_f64() * 1e3;
    match picture.rows.iter_mut().find(|row| row.name == name) {
        Some(row) => {
            row.ms += ms;
            row.bytes = row.bytes.max(bytes);
        }
        None => picture.rows.push(Row { name, ms, bytes }),
    }
}

/// One row of tiles of a film, to be filled by one thread.
struct FilmRows<'a> {
    /// Row of tiles within the band.
    row: usize,
    width: usize,
    radiance: &'a mut [Vec3],
    alpha: &'a mut [f32],
    depth_m: &'a mut [f32],
    albedo: &'a mut [Vec3],
    tangent: &'a mut [Vec3],
    normal: &'a mut [Vec3],
    guard: &'a mut [f32],
    undercoat: &'a mut [f32],
}

impl FilmRows<'_> {
    /// Depths are still weighted by alpha: passes add up, [`finish`] divides.
    fn set(&mut self, y: usize, x: usize, pixel: &Pixel, depth_scale: f32) {
        let at = y * self.width + x;
        self.radiance[at] = pixel.radiance;
        self.alpha[at] = pixel.alpha;
        self.depth_m[at] = pixel.z_m * depth_scale;
        self.albedo[at] = pixel.albedo;
        self.tangent[at] = pixel.tangent;
        self.normal[at] = pixel.normal;
        self.guard[at] = pixel.guard;
        self.undercoat[at] = pixel.undercoat;
    }
}

fn film_rows<'a>(film: &'a mut Film, grid: &Grid) -> impl IndexedParallelIterator<Item = FilmRows<'a>> {
    let width = film.width;
    let (from, to) = (grid.first_row * TILE * width, ((grid.first_row + grid.rows) * TILE).min(film.height) * width);
    let size = TILE * width;
    (
        film.radiance[from..to].par_chunks_mut(size),
        film.alpha[from..to].par_chunks_mut(size),
        film.depth_m[from..to].par_chunks_mut(size),
        film.albedo[from..to].par_chunks_mut(size),
        film.tangent[from..to].par_chunks_mut(size),
        film.normal[from..to].par_chunks_mut(size),
        film.guard[from..to].par_chunks_mut(size),
        film.undercoat[from..to].par_chunks_mut(size),
    )
        .into_par_iter()
        .enumerate()
        .map(move |(row, (radiance, alpha, depth_m, albedo, tangent, normal, guard, undercoat))| FilmRows {
            row,
            width,
            radiance,
            alpha,
            depth_m,
            albedo,
            tangent,
            normal,
            guard,
            undercoat,
        })
}

fn add(sum: &mut Film, film: &Film) {
    fn all<T: Copy + std::ops::AddAssign>(sum: &mut [T], values: &[T]) {
        sum.iter_mut().zip(values).for_each(|(s, &v)| *s += v);
    }
    all(&mut sum.radiance, &film.radiance);
    all(&mut sum.alpha, &film.alpha);
    all(&mut sum.depth_m, &film.depth_m);
    all(&mut sum.albedo, &film.albedo);
    all(&mut sum.tangent, &film.tangent);
    all(&mut sum.normal, &film.normal);
    all(&mut sum.guard, &film.guard);
    all(&mut sum.undercoat, &film.undercoat);
}

/// Scales sums over passes to means, and depths to means over what was hit.
fn finish(film: &mut Film, scale: f32) {
    for (depth, &alpha) in film.depth_m.iter_mut().zip(&film.alpha) {
        *depth = if alpha > 0.0 { *depth / alpha } else { 0.0 };
    }
    if scale != 1.0 {
        for layer in [&mut film.radiance, &mut film.albedo, &mut film.tangent, &mut film.normal] {
            layer.iter_mut().for_each(|v| *v *= scale);
        }
        for layer in [&mut film.alpha, &mut film.guard, &mut film.undercoat] {
            layer.iter_mut().for_each(|v| *v *= scale);
        }
    }
}
