//! From where a coat is looked at.

use crate::error::{Error, Result};
use crate::stage::camera::Orbit;

/// Azimuth of the first view, degrees: that of a picture for which nothing else is said.
const FIRST_DEG: f64 = 35.0;
/// Elevations of views one after another, degrees; then from the first again.
const ELEVATIONS_DEG: [f64; 8] = [12.0, 40.0, -10.0, 20.0, 30.0, 0.0, 50.0, -15.0];
/// Most views at one distance.
const MOST_VIEWS: usize = 64;
/// Distances that can be asked for, times that at which the asset just fits.
const DISTANCES: std::ops::RangeInclusive<f64> = 0.05..=100.0;

/// How many views are taken at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Times the distance at which the asset just fits.
    pub times: f64,
    /// Views around the asset, 1 to 64.
    pub views: usize,
}

/// Reads `DISTANCE[:VIEWS],…`; distances without a number of views of their own have `views`.
///
/// # Errors
/// Names what cannot be read, is out of range or stands twice.
pub fn parse(text: &str, views: usize) -> Result<Vec<Distance>> {
    let fault = |what: &str, found: &str| {
        Error::usage(what)
            .with_parameter("distances")
            .with_found(found)
            .with_expected("DISTANCE[:VIEWS], with commas between: 0.05 to 100, each once, and 1 to 64 views")
            .with_hint("`distances` 1:8,0.35:2 takes eight views as the whole asset fits and two from close by")
    };
    let mut all: Vec<Distance> = Vec::new();
    for part in text.split(',') {
        let (times, count) =
            part.split_once(':').map_or((part, Ok(views)), |(times, count)| (times, count.trim().parse()));
        let (Ok(times), Ok(views)) = (times.trim().parse(), count) else {
            return Err(fault("the distances cannot be read", part));
        };
        if !DISTANCES.contains(&times) || !(1..=MOST_VIEWS).contains(&views) {
            return Err(fault("a distance is out of range", part));
        }
        if all.iter().any(|other| other.times == times) {
            return Err(fault("a distance is asked for twice", part));
        }
        all.push(Distance { times, views });
    }
    Ok(all)
}

/// Views that a distance takes, by number, in order: evenly spread among the `most` that any distance takes, so that distances
/// share cameras' directions, and what was prepared for them.
pub fn numbers(distance: &Distance, most: usize) -> impl Iterator<Item = usize> {
    let views = distance.views.min(most);
    (0..views).map(move |i| i * most / views)
}

/// View `number` of `most`.
pub fn orbit(number: usize, most: usize, distance: f64) -> Orbit {
    let azimuth_deg = (FIRST_DEG + 360.0 * number as f64 / most as f64) % 360.0;
    Orbit { azimuth_deg, elevation_deg: ELEVATIONS_DEG[number % ELEVATIONS_DEG.len()], distance }
}
