//! Means over neighbourhoods of pixels, with weights.

/// Mean of `values` weighed by `weights` in a Gaussian of variance `variance_px2` around each pixel; 0 where all weights are.
/// The picture has rows of `width` pixels.
pub fn gaussian(values: &[f32], weights: &[f32], width: usize, variance_px2: f32) -> Vec<f32> {
    let reach = libm::ceilf(3.0 * variance_px2.sqrt()) as usize;
    let tap = |d: usize| libm::expf(-0.5 * (d * d) as f32 / variance_px2.max(f32::MIN_POSITIVE));
    let taps: Vec<f32> = (0..=reach).map(tap).collect();
    weighed(values, weights, width, &taps)
}

/// The same with equal weights up to `reach` pixels away, in a square.
pub fn square(values: &[f32], weights: &[f32], width: usize, reach: usize) -> Vec<f32> {
    weighed(values, weights, width, &vec![1.0; reach + 1])
}

fn weighed(values: &[f32], weights: &[f32], width: usize, taps: &[f32]) -> Vec<f32> {
    let product: Vec<f32> = values.iter().zip(weights).map(|(v, w)| v * w).collect();
    let [above, below] = [&product[..], weights].map(|sums| spread(sums, width, taps));
    above.iter().zip(below).map(|(a, b)| if b > 0.0 { a / b } else { 0.0 }).collect()
}

/// Convolves with `taps`, one-sided and symmetric, along rows and along columns; nothing lies beyond the border.
fn spread(values: &[f32], width: usize, taps: &[f32]) -> Vec<f32> {
    let height = values.len() / width.max(1);
    let along = |values: &[f32], step: usize, place: &dyn Fn(usize) -> [usize; 2]| -> Vec<f32> {
        let at = |i: usize| {
            let [at, count] = place(i);
            let (low, high) = (at.saturating_sub(taps.len() - 1), (at + taps.len()).min(count));
            (low..high).map(|other| taps[other.abs_diff(at)] * values[i + other * step - at * step]).sum()
        };
        (0..values.len()).map(at).collect()
    };
    let rows = along(values, 1, &|i| [i % width, width]);
    along(&rows, width, &|i| [i / width, height])
}
