//! Integrals along a ray, halved until Gauss's and Kronrod's rules agree.

/// Kronrod's seven nodes over Gauss's three (Kronrod 1965), the positive ones, and the two rules' weights.
const NODES: [f64; 4] = [0.0, 0.434_243_749_346_802_56, 0.774_596_669_241_483_4, 0.960_491_268_708_020_3];
const KRONROD: [f64; 4] =
    [0.450_916_538_658_474_14, 0.401_397_414_775_962_2, 0.268_488_089_868_333_44, 0.104_656_226_026_467_27];
const GAUSS: [f64; 4] = [8.0 / 9.0, 0.0, 5.0 / 9.0, 0.0];

/// Halvings of an interval at most: jumps in density are then placed to some hundredths of it.
const HALVINGS: u32 = 5;

/// ∫ f over [from, to], whose error is estimated to be below `tolerance`; `f` is asked at seven places at once.
pub fn integrate(from: f64, to: f64, tolerance: f64, f: &mut impl FnMut([f64; 7]) -> [f64; 7]) -> f64 {
    halve(from, to, tolerance, HALVINGS, f)
}

fn halve(from: f64, to: f64, tolerance: f64, left: u32, f: &mut impl FnMut([f64; 7]) -> [f64; 7]) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let place = |i: usize| if i < 4 { middle - half * NODES[3 - i] } else { middle + half * NODES[i - 3] };
    let values = f(std::array::from_fn(place));
    let (mut gauss, mut kronrod) = (0.0, 0.0);
    for (i, value) in values.into_iter().enumerate() {
        let node = i.abs_diff(3);
        gauss += GAUSS[node] * value;
        kronrod += KRONROD[node] * value;
    }
    let (gauss, kronrod) = (gauss * half, kronrod * half);
    if (gauss - kronrod).abs() <= tolerance || left == 0 {
        return kronrod;
    }
    halve(from, middle, 0.5 * tolerance, left - 1, f) + halve(middle, to, 0.5 * tolerance, left - 1, f)
}

/// ∫ f over [from, to] by Gauss's rule of three points.
pub fn gauss(from: f64, to: f64, f: impl FnOnce([f64; 3]) -> [f64; 3]) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let offset = half * NODES[2];
    let [before, between, after] = f([middle - offset, middle, middle + offset]);
    half * (GAUSS[0] * between + GAUSS[2] * (before + after))
}
