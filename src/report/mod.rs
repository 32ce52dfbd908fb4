//! Floor 9: error against time. A sweep draws one scene in many ways and says what each costs and how far off it is; a coat is
//! looked at from many sides beside the fur that it stands for ([`coat`]).

pub mod coat;
pub mod plot;
pub mod render;
pub mod table;

use serde::Serialize;

/// One way to draw a scene, what it took and how far off it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// What was changed, from what: `preview: step depth`.
    pub sweep: String,
    /// The value it has here.
    pub value: f64,
    /// Time of the quickest of the repeats, ms.
    pub ms: f64,
    /// Most memory that a step held, bytes.
    pub bytes: u64,
    /// Mean FLIP against the yardstick.
    pub flip: f64,
    /// Its 95th percentile.
    pub flip_p95: f64,
    /// Relative mean square error.
    pub rel_mse: f64,
    /// Relative difference of mean luminance.
    pub bias: f64,
    /// Steps through undercoat.
    pub steps: u64,
    /// Fragments of guard hair.
    pub fragments: u64,
    /// Whether no other point is both quicker and closer.
    pub pareto: bool,
    /// The name of the defaults it is, or none.
    pub defaults: Option<&'static str>,
}

/// Marks the points that no other is quicker and closer than; of equals all are marked.
pub fn mark_front(points: &mut [Point]) {
    let all: Vec<[f64; 2]> = points.iter().map(|p| [p.ms, p.flip]).collect();
    for point in points.iter_mut() {
        let beaten = |other: &[f64; 2]| {
            other[0] <= point.ms && other[1] <= point.flip && (other[0] < point.ms || other[1] < point.flip)
        };
        point.pareto = !all.iter().any(beaten);
    }
}
