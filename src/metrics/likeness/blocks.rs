//! Error of the means of blocks: what is left of it where grain has averaged out.

use crate::math::Vec3;
use crate::metrics::compare::{LinearImage, rel_mse as of_pixels};

/// Pixels along a block's edge.
pub const EDGE: usize = 8;

/// mean((a − b)²/(b² + 0.01)) over channels and blocks of 8 × 8 pixels with coverage in either picture; those at the right and
/// lower border may be smaller. The pictures are of one size.
pub fn rel_mse(reference: &LinearImage, other: &LinearImage) -> f64 {
    let [b, a] = [reference, other].map(averaged);
    let counted: Vec<usize> = (0..b.alpha.len()).filter(|&i| b.alpha[i] > 0.0 || a.alpha[i] > 0.0).collect();
    of_pixels(&b, &a, &counted)
}

fn averaged(picture: &LinearImage) -> LinearImage {
    let [width, height] = [picture.width, picture.height].map(|n| n.div_ceil(EDGE));
    let mut blocks = LinearImage { width, height, colour: Vec::new(), alpha: Vec::new() };
    for block in 0..width * height {
        let [left, top] = [block % width * EDGE, block / width * EDGE];
        let (mut colour, mut alpha, mut count) = (Vec3::ZERO, 0.0, 0.0_f32);
        for y in top..(top + EDGE).min(picture.height) {
            for x in left..(left + EDGE).min(picture.width) {
                let i = y * picture.width + x;
                (colour, alpha, count) = (colour + picture.colour[i], alpha + picture.alpha[i], count + 1.0);
            }
        }
        blocks.colour.push(colour / count.max(1.0));
        blocks.alpha.push(alpha / count.max(1.0));
    }
    blocks
}
