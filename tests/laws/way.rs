//! The way of light through hair over skin that bends.

use crate::formulas::reference;

/// Hair area along a way through hair that thins out as e^(−z/h) over skin that bends away, over that straight above, by sums: the height
/// after s is r s + b s².
fn along_way(rise: f64, bend_per_m: f64, scale_m: f64) -> f64 {
    let n = 400_000;
    let far_m = 60.0 * scale_m / rise.abs().max((bend_per_m * scale_m).sqrt());
    let step_m = far_m / f64::from(n);
    let height_m = |s: f64| rise * s + bend_per_m * s * s;
    (0..n).map(|i| (-height_m((f64::from(i) + 0.5) * step_m) / scale_m).exp()).sum::<f64>() * step_m / scale_m
}

#[test]
fn light_comes_as_far_through_bent_hair_as_the_integral_says() {
    let (mut worst, scale_m): (f64, f64) = (0.0, 0.005);
    for bend_per_m in [0.3, 3.0, 30.0] {
        for rise in [1.0, 0.6, 0.3, 0.1, 0.0, -0.05, -0.1, -0.2] {
            // Deeper than this no light comes through: what the exponent stops at.
            if rise * rise / (4.0 * bend_per_m * scale_m) * f64::from(i32::from(rise < 0.0)) > 3.0 {
                continue;
            }
            let (found, exact) = (reference::way_up(rise, bend_per_m, scale_m), along_way(rise, bend_per_m, scale_m));
            println!("rise {rise}, bend {bend_per_m}/m: {found:.3} for {exact:.3}");
            worst = worst.max((found / exact - 1.0).abs());
        }
    }
    println!("worst {worst:.3}");
    assert!(worst < 0.12, "{worst}");
}
