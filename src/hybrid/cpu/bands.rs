//! Which strands a picture shows, and its bands of rows, whose strands fit the memory.

use super::pass::{Pass, StrandBand};
use crate::hybrid::strands::{RibbonPoint, project};
use crate::math::lanes::Vec3Row;
use crate::volume::bins::{Bins, Reach, TileGrid};
use rayon::prelude::*;

impl Pass<'_> {
    /// What each strand may touch; nothing where skin hides it.
    pub(super) fn strand_reaches(&self, whole: &TileGrid, far_m: &[f32]) -> Vec<Reach> {
        let Some((strands, _)) = &self.guard else { return Vec::new() };
        let ribbon_points = || vec![RibbonPoint::default(); strands.points_per_strand];
        (0..strands.len())
            .into_par_iter()
            .map_init(ribbon_points, |ribbon_points, strand| {
                let widening = self.thinning.widening(strands, strand);
                if widening <= 0.0 {
                    return Reach::NOTHING;
                }
                project::ribbon_points(strands, strand, widening, &self.view, ribbon_points);
                let all = project::whole_reach(&self.view, ribbon_points);
                let nearest = ribbon_points.iter().map(|k| k.z_m).fold(f32::INFINITY, f32::min);
                let (columns, mut rows) = whole.touched(&all);
                let seen = rows.any(|row| columns.clone().any(|column| nearest < far_m[row * whole.columns + column]));
                if seen { all } else { Reach::NOTHING }
            })
            .collect()
    }

    /// Cuts the picture into bands of whole tile rows whose strands fit the budget.
    pub(super) fn bands(&self, whole: &TileGrid, reaches: &[Reach]) -> Vec<TileGrid> {
        let points = self.guard.as_ref().map_or(0, |(strands, _)| strands.points_per_strand);
        let per_strand = points * (size_of::<RibbonPoint>() + 12) + size_of::<Vec3Row>() + 8;
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
                bands.push(TileGrid { first_row: first, rows: row - first, ..*whole });
                (first, held) = (row, entered);
            }
            held += starting;
            running += crossing;
            // Strands that end above the next row are no longer carried.
            running = running.max(0);
        }
        bands.push(TileGrid { first_row: first, rows: whole.rows - first, ..*whole });
        bands
    }

    pub(super) fn band(&self, grid: &TileGrid, reaches: &[Reach]) -> StrandBand {
        let Some((strands, shader)) = &self.guard else {
            return StrandBand { bins: Bins::new(grid, 0, |_| Reach::NOTHING), ..StrandBand::default() };
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
        let (mut ribbon_points, mut log_radiance) = (bytemuck::zeroed_vec(size), bytemuck::zeroed_vec(visible.len()));
        visible
            .par_chunks(CHUNK)
            .zip(ribbon_points.par_chunks_mut(CHUNK * points).zip(log_radiance.par_chunks_mut(CHUNK)))
            .for_each(|(chunk, (ribbon_points, log_radiance))| {
                for (&strand, ribbon_points) in chunk.iter().zip(ribbon_points.chunks_exact_mut(points)) {
                    let widening = self.thinning.widening(strands, strand as usize);
                    project::ribbon_points(strands, strand as usize, widening, &self.view, ribbon_points);
                }
                shader.strands(chunk, log_radiance);
            });
        let bins = Bins::new(grid, ribbon_points.len(), |i| {
            if i % points == points - 1 {
                return Reach::NOTHING;
            }
            project::reach(&self.view, &ribbon_points[i], &ribbon_points[i + 1])
        });
        let ids = visible.par_iter().map(|&strand| strands.id[strand as usize]).collect();
        StrandBand { strands: visible, ribbon_points, log_radiance, ids, bins }
    }
}
