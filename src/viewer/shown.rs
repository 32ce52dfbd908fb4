//! What a picture shows, by name.

use super::channel::Channel;
use super::chart::Chart;
use crate::error::{Error, Result};
use crate::runtime::Show;
use std::fmt;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The coat as a game draws it.
    Coat(Show),
    /// How it lies.
    Chart(Chart),
    /// What is measured of it.
    Channel(Channel),
    /// Where hair is missing.
    Bald,
    /// How many texels each pixel reads.
    Cost,
}

impl Default for Shown {
    fn default() -> Self {
        Self::Coat(Show::default())
    }
}

/// What has a name of its own, in the order in which the window goes through it.
pub const CHANNELS: [(&str, Shown); 14] = [
    ("coat", Shown::Coat(Show { skin: true, shells: true, fins: true })),
    ("shells", Shown::Coat(Show { skin: false, shells: true, fins: false })),
    ("fins", Shown::Coat(Show { skin: false, shells: false, fins: true })),
    ("skin", Shown::Coat(Show { skin: true, shells: false, fins: false })),
    ("field", Shown::Chart(Chart::Field)),
    ("tangents", Shown::Chart(Chart::Tangents)),
    ("patches", Shown::Chart(Chart::Patches)),
    ("stretch", Shown::Chart(Chart::Stretch)),
    ("opacity", Shown::Channel(Channel::Opacity)),
    ("transmittance", Shown::Channel(Channel::Transmittance)),
    ("bald", Shown::Bald),
    ("levels", Shown::Channel(Channel::Levels)),
    ("wireframe", Shown::Channel(Channel::Wireframe)),
    ("cost", Shown::Cost),
];

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(CHANNELS.iter().find(|(_, shown)| shown == self).map_or("several", |(name, _)| name))
    }
}

/// Names of what is a picture by itself.
fn alone() -> impl Iterator<Item = &'static str> {
    CHANNELS.into_iter().filter(|(_, shown)| !matches!(shown, Shown::Coat(_))).map(|(name, _)| name)
}

/// Reads what to show: one of [`CHANNELS`], or some of `skin`, `shells`, `fins`, with commas between.
///
/// # Errors
/// Names the word that is none of them, or what is not alone but should be.
pub fn parse_show(text: &str) -> Result<Shown> {
    if let Some((_, shown)) = CHANNELS.iter().find(|(name, _)| *name == text.trim()) {
        return Ok(*shown);
    }
    let mut show = Show { skin: false, shells: false, fins: false };
    for word in text.split(',').map(str::trim) {
        match word {
            "skin" => show.skin = true,
            "shells" => show.shells = true,
            "fins" => show.fins = true,
            _ if word == "coat" || alone().any(|name| name == word) => {
                return Err(Error::usage(format!("{word} is a picture by itself"))
                    .with_parameter("show")
                    .with_found(text)
                    .with_expected(format!("{word} alone, or some of skin, shells, fins")));
            }
            _ => {
                let names: Vec<&str> = alone().collect();
                return Err(Error::usage("there is no such thing to show")
                    .with_parameter("show")
                    .with_found(word)
                    .with_expected(format!(
                        "skin, shells, fins, with commas between; or one of coat, {}",
                        names.join(", ")
                    )));
            }
        }
    }
    Ok(Shown::Coat(show))
}
