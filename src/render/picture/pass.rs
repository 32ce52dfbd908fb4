//! From the skin to the film, band by band. Pixels are samples here: the film averages them.

use super::film::film_rows;
use super::tile::{Place, Scratch};
use super::{Picture, Settings, mean_row, row, shares};
use crate::data::film::Film;
use crate::data::strands::Strands;
use crate::error::Result;
use crate::math::Vec3;
use crate::math::lanes::Vec3Row;
use crate::render::bins::{Bins, Grid, Reach, TILE};
use crate::render::flat::{self, Flat};
use crate::render::march::enter::Entrances;
use crate::render::march::light::UndercoatShader;
use crate::render::march::volume::Volume;
use crate::render::mean::MeanShadow;
use crate::render::pelt::{Lighting, Pelt};
use crate::render::skin::SkinTile;
use crate::render::strands::shade::GuardShader;
use crate::render::strands::thin::Thinning;
use crate::render::strands::{Knot, project};
use crate::render::table::Table;
use crate::render::view::View;
use rayon::prelude::*;
use std::time::Instant;

/// What is drawn, and through which view.
pub(super) struct Pass<'a> {
    pub(super) pelt: &'a Pelt<'a>,
    pub(super) lighting: &'a Lighting,
    pub(super) normals: &'a [Vec3],
    pub(super) mean: Option<&'a MeanShadow<'a>>,
    pub(super) view: View,
    pub(super) settings: &'a Settings,
    thinning: Thinning,
    /// The skin's vertices in camera axes.
    pub(super) skin_camera_m: Vec<Vec3>,
    /// Triangles seen from their bare side.
    pub(super) bare: Vec<bool>,
    pub(super) guard: Option<(&'a Strands, GuardShader<'a>)>,
    pub(super) undercoat: Option<(&'a Volume<'a>, UndercoatShader<'a>)>,
    /// Opacity of a guard hair along it.
    pub(super) opacity: Table,
    /// One over the pieces of a strand.
    pub(super) per_piece: f32,
}

/// The strands of a band, ready to be drawn.
#[derive(Default)]
pub(super) struct Band {
    pub(super) strands: Vec<u32>,
    pub(super) knots: Vec<Knot>,
    /// Logarithms of radiance, one row for each strand.
    pub(super) looks: Vec<Vec3Row>,
    /// Source index of each strand.
    pub(super) ids: Vec<u32>,
    pub(super) bins: Bins,
}

impl<'a> Pass<'a> {
    #[expect(clippy::too_many_arguments, reason = "the picture's parts, each of another kind")]
    pub(super) fn new(
        pelt: &'a Pelt<'a>,
        lighting: &'a Lighting,
        normals: &'a [Vec3],
        volume: Option<&'a Volume<'a>>,
        mean: Option<&'a MeanShadow<'a>>,
        view: View,
        thinning: Thinning,
        settings: &'a Settings,
    ) -> Result<Self> {
        let guard = match pelt.guard {
            Some((strands, _)) => {
                Some((strands, GuardShader::new(*pelt, strands, lighting, normals, mean, volume, view.eye_m)?))
            }
            None => None,
        };
        let skin_camera_m: Vec<Vec3> = pelt.skin.positions_m.iter().map(|&p| view.camera_from_world(p)).collect();
        let corners = |triangle: &[u32; 3]| triangle.map(|v| skin_camera_m[v as usize]);
        let bare = pelt.skin.triangles.iter().map(|triangle| !Flat::new(corners(triangle)).faces_eye()).collect();
        let undercoat = volume.map(|volume| (volume, UndercoatShader::new(pelt, lighting, mean)));
        let opacity = Table::new(|s| pelt.guard.map_or(1.0, |(strands, _)| strands.profile.opacity_at(s)));
        let pieces = pelt.guard.map_or(1, |(strands, _)| strands.points_per_strand - 1);
        let per_piece = 1.0 / pieces as f32;
        Ok(Self {
            pelt,
            lighting,
            normals,
            mean,
            view,
            settings,
            thinning,
            skin_camera_m,
            bare,
            guard,
            undercoat,
            opacity,
            per_piece,
        })
    }

    pub(super) fn run(&self, picture: &mut Picture) -> Film {
        let Settings { size, layers, .. } = *self.settings;
        let mut film = Film::of_layers(size[0], size[1], layers);
        let [width, height] = self.view.size;
        let whole = Grid::whole(self.view.size);

        let start = Instant::now();
        let triangles = self.pelt.skin.triangles.len();
        let skin_bins = Bins::new(&whole, triangles, |t| flat::reach(&self.view, &self.corners(t as u32)));
        let skin_tile = |tile: usize| {
            let (column, row) = (tile % whole.columns, tile / whole.columns);
            let pixels = |t| self.pixels(&flat::reach(&self.view, &self.corners(t)));
            SkinTile::draw(&self.view, column, row, skin_bins.of(tile), |t| self.corners(t), pixels)
        };
        // Drawn again where it is needed: all tiles at once would take eight bytes per sample.
        let far_m: Vec<f32> =
            (0..whole.columns * whole.rows).into_par_iter().map(|tile| skin_tile(tile).far_m).collect();
        row(picture, "base mesh", start, skin_bins.bytes() + size_of_val(&far_m[..]));

        let start = Instant::now();
        let entrances = self.undercoat.as_ref().map(|(volume, _)| Entrances::new(volume, &self.view, &whole));
        row(picture, "shell entrances", start, entrances.as_ref().map_or(0, Entrances::bytes));

        let start = Instant::now();
        let strand_reach = self.strand_reaches(&whole, &far_m);
        let bands = self.bands(&whole, &strand_reach);
        row(picture, "strand geometry", start, strand_reach.len() * size_of::<Reach>());

        for grid in bands {
            let (start, mean_ms) = (Instant::now(), self.mean_ms());
            let band = self.band(&grid, &strand_reach);
            let bytes = size_of_val(&band.knots[..]) + size_of_val(&band.looks[..]) + band.bins.bytes();
            row(picture, "shaded strands", start, bytes);
            mean_row(picture, "shaded strands", self.mean, mean_ms);
            picture.counts.strands += band.strands.len() as u64;

            let (start, mean_ms) = (Instant::now(), self.mean_ms());
            let mut rows = film_rows(&mut film, &grid, self.settings.edge_samples());
            // The longest first: none is left to one thread at the end.
            rows.sort_by_key(|rows| std::cmp::Reverse(band.bins.items_of(rows.row * grid.columns, grid.columns)));
            let [fragments, steps, ribbons_ns, march_ns, compositing_ns] = rows
                .into_iter()
                .par_bridge()
                .map(|mut rows| {
                    let mut scratch = Scratch::default();
                    let row = rows.row;
                    for column in 0..grid.columns {
                        let in_picture = (grid.first_row + row) * whole.columns + column;
                        let from = [column * TILE, (grid.first_row + row) * TILE];
                        let to = [(from[0] + TILE).min(width), (from[1] + TILE).min(height)];
                        let in_band = row * grid.columns + column;
                        let skin = skin_tile(in_picture);
                        let place = Place { in_band, in_picture, from, to, skin: &skin };
                        scratch.clear();
                        let begun = Instant::now();
                        self.gather(&place, &band, &mut scratch);
                        let gathered = Instant::now();
                        if let Some(entrances) = &entrances {
                            self.march(entrances, &place, &mut scratch);
                        }
                        let marched = Instant::now();
                        self.compose(&place, &scratch, &mut rows);
                        let times = [gathered - begun, marched - gathered, marched.elapsed()];
                        for (spent_ns, time) in scratch.spent_ns.iter_mut().zip(times) {
                            *spent_ns += time.as_nanos() as u64;
                        }
                    }
                    let [ribbons_ns, march_ns, compositing_ns] = scratch.spent_ns;
                    [scratch.fragment_count, scratch.step_count, ribbons_ns, march_ns, compositing_ns]
                })
                .reduce(|| [0; 5], |a, b| std::array::from_fn(|i| a[i] + b[i]));
            let parts = [("ribbons", ribbons_ns), ("march", march_ns), ("compositing", compositing_ns)];
            shares(picture, start, parts);
            mean_row(picture, "march", self.mean, mean_ms);
            picture.counts.fragments += fragments;
            picture.counts.steps += steps;
            picture.counts.pieces += band.bins.items() as u64;
        }
        film
    }

    fn mean_ms(&self) -> f64 {
        self.mean.map_or(0.0, MeanShadow::filling_ms)
    }

    pub(super) fn corners(&self, t: u32) -> [Vec3; 3] {
        self.pelt.skin.triangles[t as usize].map(|v| self.skin_camera_m[v as usize])
    }

    /// Columns and rows of pixels whose middles may lie in `reach`.
    pub(super) fn pixels(&self, reach: &Reach) -> [std::ops::Range<usize>; 2] {
        [0, 1].map(|axis| {
            let size = self.view.size[axis];
            let from = (reach.from[axis] - 0.5).ceil().max(0.0) as usize;
            let to = ((reach.to[axis] - 0.5).floor() + 1.0).max(0.0) as usize;
            from.min(size)..to.min(size)
        })
    }

    /// What each strand may touch; nothing where skin hides it.
    fn strand_reaches(&self, whole: &Grid, far_m: &[f32]) -> Vec<Reach> {
        let Some((strands, _)) = &self.guard else { return Vec::new() };
        let knots = || vec![Knot::default(); strands.points_per_strand];
        (0..strands.len())
            .into_par_iter()
            .map_init(knots, |knots, strand| {
                let widening = self.thinning.widening(strands, strand);
                if widening <= 0.0 {
                    return Reach::NOTHING;
                }
                project::knots(strands, strand, widening, &self.view, knots);
                let all = project::whole_reach(&self.view, knots);
                let nearest = knots.iter().map(|k| k.z_m).fold(f32::INFINITY, f32::min);
                let (columns, mut rows) = whole.touched(&all);
                let seen = rows.any(|row| columns.clone().any(|column| nearest < far_m[row * whole.columns + column]));
                if seen { all } else { Reach::NOTHING }
            })
            .collect()
    }

    /// Cuts the picture into bands of whole tile rows whose strands fit the budget.
    fn bands(&self, whole: &Grid, reaches: &[Reach]) -> Vec<Grid> {
        let points = self.guard.as_ref().map_or(0, |(strands, _)| strands.points_per_strand);
        let per_strand = points * (size_of::<Knot>() + 12) + size_of::<Vec3Row>() + 8;
        // By row: strands that start there, and how many more start than have ended above.
        let none = || vec![(0_usize, 0_isize); whole.rows + 1];
        let counts = reaches.par_iter().fold(none, |mut counts, reach| {
            let rows = whole.touched(reach).1;
            if !rows.is_empty() {
                counts[rows.start].0 += 1;
                counts[rows.start].1 += 1;
                counts[rows.end].1 -= 1;
            }
            counts
        });
        let counts = counts.reduce(none, |mut all, some| {
            for (all, some) in all.iter_mut().zip(some) {
                *all = (all.0 + some.0, all.1 + some.1);
            }
            all
        });
        let mut bands = Vec::new();
        let (mut first, mut held, mut running) = (0, 0_usize, 0_isize);
        for (row, &(starting, crossing)) in counts[..whole.rows].iter().enumerate() {
            let entered = running.max(0) as usize;
            if row > first && (held + starting) * per_strand > self.settings.band_bytes {
                bands.push(Grid { first_row: first, rows: row - first, ..*whole });
                (first, held) = (row, entered);
            }
            held += starting;
            running += crossing;
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
        shader.prepare(&visible);
        const CHUNK: usize = 512;
        let points = strands.points_per_strand;
        let size = visible.len() * points;
        // Memory of zeros comes page by page to the threads that first write it.
        let (mut knots, mut looks) = (bytemuck::zeroed_vec(size), bytemuck::zeroed_vec(visible.len()));
        visible.par_chunks(CHUNK).zip(knots.par_chunks_mut(CHUNK * points).zip(looks.par_chunks_mut(CHUNK))).for_each(
            |(chunk, (knots, looks))| {
                for (&strand, knots) in chunk.iter().zip(knots.chunks_exact_mut(points)) {
                    let widening = self.thinning.widening(strands, strand as usize);
                    project::knots(strands, strand as usize, widening, &self.view, knots);
                }
                shader.strands(chunk, looks);
            },
        );
        let bins = Bins::new(grid, knots.len(), |i| {
            if i % points == points - 1 {
                return Reach::NOTHING;
            }
            project::reach(&self.view, &knots[i], &knots[i + 1])
        });
        let ids = visible.par_iter().map(|&strand| strands.id[strand as usize]).collect();
        Band { strands: visible, knots, looks, ids, bins }
    }
}
