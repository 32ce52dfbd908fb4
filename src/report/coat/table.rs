//! Pictures of a coat as comma-separated values (RFC 4180).

use super::Picture;

/// A header and one line per picture; what a picture does not have is empty.
pub fn csv(pictures: &[Picture]) -> String {
    let mut out = String::from(
        "light,distance,azimuth_deg,elevation_deg,flip,flip_p95,relmse,relmse_8x8,bias,bias_r,bias_g,bias_b,coverage,\
         fringe_flip,fringe_coverage,band_1_2,band_2_4,band_4_8,floor_flip,floor_fringe_flip,view_ms,render_ms,bytes,\
         triangles\r\n",
    );
    for p in pictures {
        let l = &p.likeness;
        let [red, green, blue] = l.bias_rgb;
        let [fine, middle, coarse] = l.bands.all();
        let numbers = [
            Some(p.distance),
            Some(p.azimuth_deg),
            Some(p.elevation_deg),
            Some(l.flip),
            Some(l.flip_p95),
            Some(l.relmse),
            Some(l.relmse_8x8),
            Some(l.bias),
            Some(red),
            Some(green),
            Some(blue),
            Some(l.coverage),
            l.fringe.map(|fringe| fringe.flip),
            l.fringe.map(|fringe| fringe.coverage),
            fine,
            middle,
            coarse,
            Some(p.floor.flip),
            p.floor.fringe_flip,
            Some(p.cost.view_ms),
            Some(p.cost.render_ms),
            Some(p.cost.bytes as f64),
            p.cost.triangles.map(|n| n as f64),
        ];
        out.push_str(p.light.name());
        for number in numbers {
            out.push(',');
            if let Some(number) = number {
                // Six digits after the point, without trailing zeros.
                out.push_str(&((number * 1e6).round() / 1e6).to_string());
            }
        }
        out.push_str("\r\n");
    }
    out
}
