//! All pictures of a report in a few numbers.

use super::Picture;
use serde::Serialize;

/// Means, worst cases and what is over the floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Pictures that count.
    pub pictures: usize,
    /// Over all of them.
    pub mean: Means,
    /// Mean excess over the floor of each picture's distance.
    pub excess: Excess,
    /// The pictures that are furthest off.
    pub worst: Worst,
    /// The same by light and distance.
    pub by_light_and_distance: Vec<Group>,
}

/// Means of pictures' measures; of what not every picture has, over those that have it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Means {
    /// FLIP.
    pub flip: f64,
    /// Its 95th percentile.
    pub flip_p95: f64,
    /// relMSE.
    pub relmse: f64,
    /// relMSE of blocks.
    pub relmse_8x8: f64,
    /// Bias, with its sign.
    pub bias: f64,
    /// Its magnitude.
    pub bias_magnitude: f64,
    /// Difference of coverage, points.
    pub coverage: f64,
    /// Its magnitude.
    pub coverage_magnitude: f64,
    /// FLIP of the fringe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe_flip: Option<f64>,
    /// Difference of the fringe's coverage, points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe_coverage: Option<f64>,
    /// Variance by size of detail, 1–2, 2–4 and 4–8 px: geometric means of ratios.
    pub bands: [Option<f64>; 3],
}

/// How much more than another growth of the same fur.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Excess {
    /// FLIP.
    pub flip: f64,
    /// FLIP of the fringe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fringe_flip: Option<f64>,
}

/// Pictures of one light from one distance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The lights.
    pub light: &'static str,
    /// Times the distance at which the asset just fits.
    pub distance: f64,
    /// How many.
    pub pictures: usize,
    /// Their means.
    pub mean: Means,
    /// What is over the floor.
    pub excess: Excess,
}

/// The picture that is furthest off by each measure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// FLIP.
    pub flip: Option<Case>,
    /// FLIP of the fringe.
    pub fringe_flip: Option<Case>,
    /// Bias, by magnitude.
    pub bias: Option<Case>,
    /// Difference of coverage, by magnitude.
    pub coverage: Option<Case>,
}

/// One picture's value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// What was measured.
    pub value: f64,
    /// Whose it is: a place in the report's list.
    pub picture: usize,
}

/// Sums up.
pub fn summarise(pictures: &[Picture]) -> Summary {
    let all: Vec<&Picture> = pictures.iter().collect();
    let mut groups: Vec<(&'static str, f64, Vec<&Picture>)> = Vec::new();
    for picture in pictures {
        let of = (picture.light.name(), picture.distance);
        match groups.iter_mut().find(|group| (group.0, group.1) == of) {
            Some(group) => group.2.push(picture),
            None => groups.push((of.0, of.1, vec![picture])),
        }
    }
    let group = |(light, distance, of): (&'static str, f64, Vec<&Picture>)| Group {
        light,
        distance,
        pictures: of.len(),
        mean: means(&of),
        excess: excess(&of),
    };
    Summary {
        pictures: pictures.len(),
        mean: means(&all),
        excess: excess(&all),
        worst: Worst {
            flip: worst(pictures, |p| Some(p.likeness.flip)),
            fringe_flip: worst(pictures, |p| p.likeness.fringe.map(|fringe| fringe.flip)),
            bias: worst(pictures, |p| Some(p.likeness.bias)),
            coverage: worst(pictures, |p| Some(p.likeness.coverage)),
        },
        by_light_and_distance: groups.into_iter().map(group).collect(),
    }
}

fn worst(pictures: &[Picture], value: impl Fn(&Picture) -> Option<f64>) -> Option<Case> {
    let cases = pictures.iter().enumerate().filter_map(|(picture, p)| Some(Case { value: value(p)?, picture }));
    cases.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
}

/// The mean of those that have it.
fn mean_of(pictures: &[&Picture], value: impl Fn(&Picture) -> Option<f64>) -> Option<f64> {
    let values: Vec<f64> = pictures.iter().filter_map(|p| value(p)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn means(pictures: &[&Picture]) -> Means {
    let mean = |value: &dyn Fn(&Picture) -> f64| mean_of(pictures, |p| Some(value(p))).unwrap_or(0.0);
    let band = |i: usize| mean_of(pictures, |p| p.likeness.bands.all()[i].filter(|&b| b > 0.0).map(libm::log));
    Means {
        flip: mean(&|p| p.likeness.flip),
        flip_p95: mean(&|p| p.likeness.flip_p95),
        relmse: mean(&|p| p.likeness.relmse),
        relmse_8x8: mean(&|p| p.likeness.relmse_8x8),
        bias: mean(&|p| p.likeness.bias),
        bias_magnitude: mean(&|p| p.likeness.bias.abs()),
        coverage: mean(&|p| p.likeness.coverage),
        coverage_magnitude: mean(&|p| p.likeness.coverage.abs()),
        fringe_flip: mean_of(pictures, |p| p.likeness.fringe.map(|fringe| fringe.flip)),
        fringe_coverage: mean_of(pictures, |p| p.likeness.fringe.map(|fringe| fringe.coverage)),
        bands: std::array::from_fn(|i| band(i).map(libm::exp)),
    }
}

fn excess(pictures: &[&Picture]) -> Excess {
    let fringe = |p: &Picture| Some(p.likeness.fringe?.flip - p.floor.fringe_flip?);
    Excess {
        flip: mean_of(pictures, |p| Some(p.likeness.flip - p.floor.flip)).unwrap_or(0.0),
        fringe_flip: mean_of(pictures, fringe),
    }
}
