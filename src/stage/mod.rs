//! Floor 2: what a picture is taken with: camera, light, lens, tones, files. Every picture of the house, whoever draws it,
//! passes here, so that pictures of one asset lie over each other. In: what was asked for ([`options::Options`]) and a
//! [`Subject`](crate::data::subject::Subject). Out: a camera, lights, and from a film a file's bytes.

pub mod background;
pub mod camera;
pub mod defocus;
pub mod environment;
pub mod exr;
pub mod file;
pub mod light;
pub mod options;
pub mod png;
pub mod projection;
pub mod rig;
pub mod tone;

use crate::data::subject::Named;
use crate::error::{Error, Result};

/// What goes by `name` among what the asset brings along.
///
/// # Errors
/// [`crate::error::Kind::Usage`] with the names there are; or why what goes by this one cannot be used.
fn named<T: Clone>(all: &[Named<T>], name: &str, what: &'static str) -> Result<T> {
    if let Some(found) = all.iter().find(|one| one.names.iter().any(|n| n == name)) {
        return found.value.clone().map_err(|error| error.with_found(name));
    }
    let mut names: Vec<&str> = Vec::new();
    for name in all.iter().flat_map(|one| &one.names) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    Err(Error::usage(format!("the asset has no such {what}")).with_parameter(what).with_found(name).with_expected(
        if names.is_empty() {
            format!("none: the asset has no {what}")
        } else {
            format!("one of: {}", names.join(", "))
        },
    ))
}
