//! A figure with a hat: bodies of revolution in an OBJ, each of its materials by name.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Corners around.
const COLUMNS: usize = 24;

/// Radius and height, m, from below; and the material.
const BODY: (&str, &[[f64; 2]]) = (
    "Coat",
    &[
        [0.0, 0.0],
        [0.30, 0.0],
        [0.31, 0.1],
        [0.27, 0.5],
        [0.22, 0.9],
        [0.24, 1.15],
        [0.21, 1.3],
        [0.08, 1.38],
        [0.07, 1.44],
    ],
);
const HEAD: (&str, &[[f64; 2]]) =
    ("Skin", &[[0.07, 1.44], [0.10, 1.47], [0.125, 1.53], [0.13, 1.59], [0.12, 1.65], [0.09, 1.70], [0.0, 1.72]]);
const HAT: (&str, &[[f64; 2]]) = (
    "Hat",
    &[
        [0.132, 1.58],
        [0.165, 1.59],
        [0.172, 1.64],
        [0.168, 1.70],
        [0.15, 1.76],
        [0.11, 1.80],
        [0.05, 1.815],
        [0.0, 1.818],
    ],
);

/// The OBJ and its materials.
pub fn files() -> [(&'static str, String); 2] {
    let mut obj = String::from("# A figure in metres; made by tests/recipes/figure.rs\nmtllib figure.mtl\n");
    let mut first = 1;
    for (material, profile) in [BODY, HEAD, HAT] {
        for (row, [radius, height]) in profile.iter().enumerate() {
            for column in 0..=COLUMNS {
                let angle = TAU * column as f64 / COLUMNS as f64;
                writeln!(obj, "v {:.4} {height:.4} {:.4}", radius * angle.sin(), radius * angle.cos()).unwrap();
                writeln!(
                    obj,
                    "vt {:.4} {:.4}",
                    column as f64 / COLUMNS as f64,
                    row as f64 / (profile.len() - 1) as f64
                )
                .unwrap();
            }
        }
        writeln!(obj, "usemtl {material}").unwrap();
        for row in 0..profile.len() - 1 {
            for column in 0..COLUMNS {
                let at = |row: usize, column: usize| first + row * (COLUMNS + 1) + column;
                let [a, b, c, d] = [at(row, column), at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)];
                // Where the profile meets the axis a side has no length.
                let corners = match (profile[row][0] == 0.0, profile[row + 1][0] == 0.0) {
                    (true, _) => vec![a, c, d],
                    (_, true) => vec![a, b, d],
                    _ => vec![a, b, c, d],
                };
                let words: Vec<String> = corners.iter().map(|v| format!("{v}/{v}")).collect();
                writeln!(obj, "f {}", words.join(" ")).unwrap();
            }
        }
        first += profile.len() * (COLUMNS + 1);
    }
    let materials =
        "newmtl Coat\nKd 0.15 0.18 0.30\n\nnewmtl Skin\nKd 0.75 0.52 0.42\n\nnewmtl Hat\nKd 0.30 0.20 0.13\n";
    [("figure.obj", obj), ("figure.mtl", materials.to_owned())]
}
