//! Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004).

/// Taps of the Gaussian window on either side.
const REACH: usize = 5;
/// Its standard deviation, pixels.
const SIGMA: f32 = 1.5;
/// (K₁ L)² and (K₂ L)² for values in [0, 1].
const C1: f32 = 0.01 * 0.01;
const C2: f32 = 0.03 * 0.03;

/// Mean SSIM of two pictures of `width` × `height` values in [0, 1]; windows are cut and renormalised at the border.
pub fn mean(a: &[f32], b: &[f32], width: usize, height: usize) -> f64 {
    let product = |x: &[f32], y: &[f32]| x.iter().zip(y).map(|(x, y)| x * y).collect::<Vec<f32>>();
    let blurred = |values: Vec<f32>| blur(&values, width, height);
    let (mean_a, mean_b) = (blurred(a.to_vec()), blurred(b.to_vec()));
    let (aa, bb, ab) = (blurred(product(a, a)), blurred(product(b, b)), blurred(product(a, b)));
    let total: f64 = (0..a.len())
        .map(|i| {
            let (ma, mb) = (mean_a[i], mean_b[i]);
            let (va, vb, cov) = (aa[i] - ma * ma, bb[i] - mb * mb, ab[i] - ma * mb);
            let ssim = (2.0 * ma * mb + C1) * (2.0 * cov + C2) / ((ma * ma + mb * mb + C1) * (va + vb + C2));
            f64::from(ssim)
        })
        .sum();
    total / a.len().max(1) as f64
}

fn blur(values: &[f32], width: usize, height: usize) -> Vec<f32> {
    let rows = pass(values, |i| (i % width, width), 1);
    pass(&rows, |i| (i / width, height), width)
}

/// One direction: `place` gives a value's position along its line and the line's length, `stride` the step along it.
fn pass(values: &[f32], place: impl Fn(usize) -> (usize, usize), stride: usize) -> Vec<f32> {
    let weight = |d: usize| libm::expf(-0.5 * (d * d) as f32 / (SIGMA * SIGMA));
    let weights: [f32; REACH + 1] = std::array::from_fn(weight);
    (0..values.len())
        .map(|i| {
            let (at, length) = place(i);
            let (low, high) = (at.saturating_sub(REACH), (at + REACH).min(length - 1));
            let (mut sum, mut total) = (0.0, 0.0);
            for other in low..=high {
                let w = weights[other.abs_diff(at)];
                sum += w * values[i + other * stride - at * stride];
                total += w;
            }
            sum / total
        })
        .collect()
}
