//! Renders, coats and their differences on one sheet.

use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::math::Vec3;
use crate::metrics::compare::LinearImage;
use crate::metrics::likeness::Judged;

/// Longest edge of a picture on the sheet, px.
const EDGE: usize = 256;

/// A render, its coat and their FLIP, one under another, small: RGB in rows from the top.
#[derive(Clone, Debug)]
pub struct Column {
    width: usize,
    rows: Vec<Vec<u8>>,
}

impl Column {
    /// Of two pictures as they were compared.
    pub fn new(judged: &Judged) -> Self {
        let [LinearImage { width, height, .. }, _] = &judged.shown;
        let every = (*width.max(height)).div_ceil(EDGE).max(1);
        let small = |values: &[Vec3]| shrunk(values, *width, every);
        let coded = |light: Vec3| light.to_array().map(|v| unorm8(srgb_from_linear(v.clamp(0.0, 1.0))));
        let ramp = nv_flip::magma_lut().to_vec();
        let coloured = |flip: Vec3| {
            let at = 3 * usize::from(unorm8(flip.x));
            [ramp[at], ramp[at + 1], ramp[at + 2]]
        };
        let flip: Vec<Vec3> = judged.flip.iter().map(|&flip| Vec3::splat(flip)).collect();
        let mut rows = Vec::new();
        for picture in &judged.shown {
            rows.extend(small(&picture.colour).into_iter().map(|row| row.into_iter().flat_map(coded).collect()));
        }
        rows.extend(small(&flip).into_iter().map(|row| row.into_iter().flat_map(coloured).collect()));
        Self { width: width.div_ceil(every), rows }
    }
}

/// Means of squares of `every` pixels, row by row; those at the right and lower border may be smaller.
fn shrunk(values: &[Vec3], width: usize, every: usize) -> Vec<Vec<Vec3>> {
    let mean = |rows: &[Vec3], x: usize| {
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for row in rows.chunks(width) {
            for &value in &row[x..(x + every).min(width)] {
                (sum, count) = (sum + value, count + 1.0);
            }
        }
        sum / count
    };
    values.chunks(width * every).map(|rows| (0..width).step_by(every).map(|x| mean(rows, x)).collect()).collect()
}

/// Groups of columns, one under another; what is left over to the right is empty. Columns of a group are of one height.
pub fn sheet(groups: &[Vec<Column>]) -> Image8 {
    let wide = |group: &Vec<Column>| group.iter().map(|column| column.width).sum();
    let high = |group: &Vec<Column>| group.first().map_or(0, |column| column.rows.len());
    let width: usize = groups.iter().map(wide).max().unwrap_or(0);
    let height: usize = groups.iter().map(high).sum();
    let mut pixels = Vec::with_capacity(4 * width * height);
    for group in groups {
        for y in 0..high(group) {
            for pixel in group.iter().flat_map(|column| column.rows[y].chunks(3)) {
                pixels.extend_from_slice(&[pixel[0], pixel[1], pixel[2], 255]);
            }
            pixels.resize(pixels.len() + 4 * (width - wide(group)), 0);
        }
    }
    Image8 { width: width as u32, height: height as u32, channels: 4, pixels }
}
