//! Hair area above each voxel per skin area: what lights the hair there.
//!
//! The law of light knows hair as dense as it is in the mean; what single hairs do to each other's light is in the law, and gaps between
//! clumps are dark because deep hair is seen through them (`docs/steps/light.md`). So hair counts here as dense as it is around.

use super::deposit::VoxelLayout;
use rayon::prelude::*;

/// Hair area above, per skin area.
#[derive(Clone, Debug, Default)]
pub struct Above {
    /// Above the middle of each voxel, `[slab][y][x]`.
    pub voxels: Vec<f32>,
    /// Above the skin, `[y][x]`.
    pub skin: Vec<f32>,
}

impl Above {
    /// Of hair with this extinction, 1/m, taken as it is in the mean over 2 `reach_texels` + 1 texels, those without skin left out; over
    /// a whole tile.
    pub fn new(layout: &VoxelLayout, extinction: &[f32], reach_texels: usize, skin_share: &[f32]) -> Self {
        let n = layout.texels();
        let area = |slab: usize| -> Vec<f32> {
            let own = &extinction[slab * n..(slab + 1) * n];
            if layout.toroidal {
                return vec![own.iter().sum::<f32>() / n as f32 * layout.slab_m(slab); n];
            }
            let share = |texel: usize| skin_share.get(texel).copied().unwrap_or(1.0);
            let weights: Vec<f32> = (0..n).map(share).collect();
            let weighted: Vec<f32> = own.iter().zip(&weights).map(|(own, weight)| own * weight).collect();
            let sums = box_sums(layout, &weighted, reach_texels);
            let over = box_sums(layout, &weights, reach_texels);
            sums.iter().zip(&over).map(|(s, o)| if *o > 0.0 { s / o * layout.slab_m(slab) } else { 0.0 }).collect()
        };
        let areas: Vec<Vec<f32>> = (0..layout.slabs.count()).into_par_iter().map(area).collect();
        let mut skin = vec![0.0; n];
        let mut voxels = vec![0.0; n * layout.slabs.count()];
        for (slab, areas) in areas.iter().enumerate().rev() {
            for (texel, area) in areas.iter().enumerate() {
                voxels[slab * n + texel] = skin[texel] + 0.5 * area;
                skin[texel] += area;
            }
        }
        Self { voxels, skin }
    }
}

/// Sums over squares of 2 `reach` + 1 texels around each, as far as there are texels.
fn box_sums(layout: &VoxelLayout, values: &[f32], reach: usize) -> Vec<f32> {
    let [width, height] = layout.size;
    let rows = line_sums(values, [width, 1], [height, width], reach);
    line_sums(&rows, [height, width], [width, 1], reach)
}

/// The same along lines: `along` is how many values a line has and how far they are apart, `lines` the same of lines.
fn line_sums(values: &[f32], along: [usize; 2], lines: [usize; 2], reach: usize) -> Vec<f32> {
    let mut sums = vec![0.0; values.len()];
    let mut before = vec![0.0_f64; along[0] + 1];
    for start in (0..lines[0]).map(|line| line * lines[1]) {
        for i in 0..along[0] {
            before[i + 1] = before[i] + f64::from(values[start + i * along[1]]);
        }
        for i in 0..along[0] {
            let (low, high) = (i.saturating_sub(reach), (i + reach + 1).min(along[0]));
            sums[start + i * along[1]] = (before[high] - before[low]) as f32;
        }
    }
    sums
}
