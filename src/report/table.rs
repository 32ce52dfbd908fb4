//! Points as comma-separated values (RFC 4180).

use super::Point;

/// A header and one line per point.
pub fn csv(points: &[Point]) -> String {
    let mut out = String::from("sweep,value,ms,bytes,flip,flip_p95,rel_mse,bias,steps,fragments,pareto,defaults\r\n");
    for p in points {
        let fields = [
            quoted(&p.sweep),
            p.value.to_string(),
            format!("{:.3}", p.ms),
            p.bytes.to_string(),
            format!("{:.6}", p.flip),
            format!("{:.6}", p.flip_p95),
            format!("{:.7}", p.rel_mse),
            format!("{:.6}", p.bias),
            p.steps.to_string(),
            p.fragments.to_string(),
            p.pareto.to_string(),
            p.defaults.unwrap_or_default().to_owned(),
        ];
        out.push_str(&fields.join(","));
        out.push_str("\r\n");
    }
    out
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
