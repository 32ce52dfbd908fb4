//! From the skin to the film, band by band.

use super::film::film_rows;
use super::pass::Pass;
use super::scratch::{Scratch, TileView};
use crate::data::film::Film;
use crate::hybrid::entrances::Entrances;
use crate::hybrid::flat;
use crate::hybrid::picture::Picture;
use crate::hybrid::settings::Settings;
use crate::hybrid::skin::SkinTile;
use crate::volume::bins::{Bins, Reach, TILE, TileGrid};
use crate::volume::mean::MeanShadow;
use rayon::prelude::*;
use std::time::Instant;

impl Pass<'_> {
    pub(super) fn run(&self, picture: &mut Picture) -> Film {
        let Settings { size, layers, .. } = *self.settings;
        let mut film = Film::of_layers(size[0], size[1], layers);
        let [width, height] = self.view.size;
        let whole = TileGrid::whole(self.view.size);

        let start = Instant::now();
        let triangles = self.prepared.scene.skin.triangles.len();
        let skin_bins = Bins::new(&whole, triangles, |t| flat::reach(&self.view, &self.corners(t as u32)));
        let skin_tile = |tile: usize| {
            let (column, row) = (tile % whole.columns, tile / whole.columns);
            let pixels = |t| self.pixels(&flat::reach(&self.view, &self.corners(t)));
            SkinTile::draw(&self.view, column, row, skin_bins.of(tile), |t| self.corners(t), pixels)
        };
        // Drawn again where it is needed: all tiles at once would take eight bytes per sample.
        let far_m: Vec<f32> =
            (0..whole.columns * whole.rows).into_par_iter().map(|tile| skin_tile(tile).far_m).collect();
        picture.steps.add_since("base mesh", start, skin_bins.bytes() + size_of_val(&far_m[..]));

        let start = Instant::now();
        let entrances =
            self.undercoat.as_ref().map(|(shadows, _)| Entrances::new(shadows.volume.shell(), &self.view, &whole));
        picture.steps.add_since("shell entrances", start, entrances.as_ref().map_or(0, Entrances::bytes));

        let start = Instant::now();
        let strand_reach = self.strand_reaches(&whole, &far_m);
        let bands = self.bands(&whole, &strand_reach);
        picture.steps.add_since("strand geometry", start, strand_reach.len() * size_of::<Reach>());

        for grid in bands {
            let (start, mean_ms) = (Instant::now(), self.mean_ms());
            let band = self.band(&grid, &strand_reach);
            let bytes = size_of_val(&band.ribbon_points[..]) + size_of_val(&band.log_radiance[..]) + band.bins.bytes();
            picture.steps.add_since("shaded strands", start, bytes);
            self.add_mean(picture, "shaded strands", mean_ms);
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
                        let tile = TileView { in_band, in_picture, from, to, skin: &skin };
                        scratch.clear();
                        let begun = Instant::now();
                        self.gather(&tile, &band, &mut scratch);
                        let gathered = Instant::now();
                        if let Some(entrances) = &entrances {
                            self.march(entrances, &tile, &mut scratch);
                        }
                        let marched = Instant::now();
                        self.compose(&tile, &scratch, &mut rows);
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
            add_shares(picture, start, parts);
            self.add_mean(picture, "march", mean_ms);
            picture.counts.fragments += fragments;
            picture.counts.steps += steps;
            picture.counts.segments += band.bins.items() as u64;
        }
        film
    }

    fn mean_ms(&self) -> f64 {
        self.prepared.mean.as_ref().map_or(0.0, MeanShadow::filling_ms)
    }

    /// Gives what was filled of the mean shadow since it had taken `before_ms` a row of its own, out of the step that needed it.
    fn add_mean(&self, picture: &mut Picture, step: &str, before_ms: f64) {
        let Some(mean) = &self.prepared.mean else { return };
        let ms = (mean.filling_ms() - before_ms) / rayon::current_num_threads() as f64;
        picture.steps.take(step, ms);
        picture.steps.add("mean shadow", ms, mean.bytes() as u64);
    }
}

/// Rows of steps that ran tile by tile since `start`, by their shares of the threads' time.
fn add_shares<const N: usize>(picture: &mut Picture, start: Instant, parts: [(&'static str, u64); N]) {
    let all_ns: u64 = parts.iter().map(|(_, ns)| ns).sum();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    for (name, ns) in parts {
        picture.steps.add(name, ms * ns as f64 / all_ns.max(1) as f64, 0);
    }
}
