//! The band around a picture's outline, where hair is seen against what is behind it.

use super::smooth;
use crate::metrics::compare::LinearImage;

/// Coverage at the outline: halfway from none to full.
const HALF: f32 = 0.5;
/// Coverage is smoothed over this part of the band's width on either side, so that single hairs have no outline of their own.
const SMOOTHED: f32 = 0.125;
/// A band is at least this wide, px.
const LEAST_PX: f32 = 2.0;

/// Pixels, in order, whose middles are within half of `width_px` of where the smoothed alpha of `render` passes through ½: none
/// where the picture holds no outline.
pub fn band(render: &LinearImage, width_px: f32) -> Vec<usize> {
    let (width, width_px) = (render.width, width_px.max(LEAST_PX));
    let reach = libm::roundf(SMOOTHED * width_px) as usize;
    let alpha = smooth::square(&render.alpha, &vec![1.0; render.alpha.len()], width, reach);
    let inside: Vec<bool> = alpha.iter().map(|&a| a >= HALF).collect();
    // The outline runs between pixels, half a step from the nearest on either side.
    let [to_inside, to_outside] = [true, false].map(|side| distances_px(&inside, width, side));
    let away_px = |i: usize| if inside[i] { to_outside[i] } else { to_inside[i] } - 0.5;
    (0..inside.len()).filter(|&i| away_px(i) <= 0.5 * width_px).collect()
}

/// Distance from each pixel to the nearest that is `side`, px; infinite where there is none (Felzenszwalb and Huttenlocher 2012).
fn distances_px(inside: &[bool], width: usize, side: bool) -> Vec<f32> {
    let height = inside.len() / width.max(1);
    let mut squares: Vec<f64> = inside.iter().map(|&is| if is == side { 0.0 } else { f64::INFINITY }).collect();
    for x in 0..width {
        let column: Vec<f64> = (0..height).map(|y| squares[y * width + x]).collect();
        lower_envelope(&column).into_iter().enumerate().for_each(|(y, d)| squares[y * width + x] = d);
    }
    for row in squares.chunks_mut(width.max(1)) {
        row.copy_from_slice(&lower_envelope(row));
    }
    squares.into_iter().map(|d| d.sqrt() as f32).collect()
}

/// min over q of (p − q)² + f(q), for each p.
fn lower_envelope(f: &[f64]) -> Vec<f64> {
    // Parabolas of the envelope, each with where it begins.
    let mut parts: Vec<(usize, f64)> = Vec::new();
    let root = |q: usize| f[q] + (q * q) as f64;
    for q in (0..f.len()).filter(|&q| f[q].is_finite()) {
        let mut begins = f64::NEG_INFINITY;
        while let Some(&(last, from)) = parts.last() {
            begins = (root(q) - root(last)) / (2.0 * (q - last) as f64);
            if begins > from {
                break;
            }
            parts.pop();
            begins = f64::NEG_INFINITY;
        }
        parts.push((q, begins));
    }
    let mut part = 0;
    let at = |p: usize| {
        while parts.get(part + 1).is_some_and(|next| next.1 <= p as f64) {
            part += 1;
        }
        parts.get(part).map_or(f64::INFINITY, |&(q, _)| (p as f64 - q as f64).powi(2) + f[q])
    };
    (0..f.len()).map(at).collect()
}
