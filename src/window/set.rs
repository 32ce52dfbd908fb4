//! Controls by name, as scripts set them.

use super::comparison::Mode;
use super::lighting::Source;
use super::model::Model;
use super::state::State;
use crate::error::{Error, Result};
use crate::runtime::{Blending, Spring};
use crate::stage::camera::{Orbit, Viewpoint};
use crate::stage::rig::Rig;
use crate::viewer::{LENGTHS, SLANTS_DEG, parse_show};

/// Sets the control `name`.
///
/// # Errors
/// [`crate::error::Kind::Usage`] where there is none of that name, or it has no such value.
pub fn set(state: &mut State, model: Option<&Model>, aspect: f64, name: &str, value: &str) -> Result<()> {
    let number = |low: f64, high: f64| number(name, value, [low, high]);
    let within = |[low, high]: [f32; 2]| number(f64::from(low), f64::from(high)).map(|x| x as f32);
    let is_on = || on_or_off(name, value);
    match name {
        "exposure" => state.development.exposure_ev = number(-8.0, 8.0)? as f32,
        "background" => state.development.background = value.parse()?,
        "light" => state.lighting.source = source(value)?,
        "light.turn" => state.lighting.turn_deg = number(-180.0, 180.0)? as f32,
        "light.raise" => state.lighting.raise_deg = number(-90.0, 90.0)? as f32,
        "light.stops" => state.lighting.stops = number(-8.0, 8.0)? as f32,
        "light.shadow" => state.lighting.shadow = is_on()?,
        "sky" => state.lighting.sky = is_on()?,
        "show" => state.shown = parse_show(value)?,
        "blend" => {
            let ways = Blending::ALL.iter().find(|(name, _)| *name == value);
            let names = || Blending::ALL.map(|(name, _)| name).join(", ");
            state.blend = ways.map(|(_, way)| *way).ok_or_else(|| fault(name, value, &names()))?;
        }
        "level" if value == "auto" => state.level = None,
        "level" => state.level = Some(number(0.0, 64.0)? as usize),
        "animation" => {
            let model = model.ok_or_else(|| fault(name, value, "a name, once the asset is read"))?;
            state.clock.animation = if value == "none" { None } else { Some(model.asset.animation(value)?) };
        }
        "time" => state.clock.seconds = number(0.0, 1e6)?,
        "speed" => state.clock.speed = number(0.0, 8.0)?,
        "play" => state.clock.playing = is_on()? && state.clock.animation.is_some(),
        "against" => {
            let modes = Mode::ALL.iter().find(|(name, _)| *name == value);
            let names = || Mode::ALL.map(|(name, _)| name).join(", ");
            state.comparison.mode = modes.map(|(_, mode)| *mode).ok_or_else(|| fault(name, value, &names()))?;
        }
        "wipe" => state.comparison.wipe = number(0.0, 1.0)? as f32,
        "hair" => state.comparison.hair = is_on()?,
        "length" => state.combing.length = within(LENGTHS)?,
        "slant" => state.combing.slant_deg = within(SLANTS_DEG)?,
        "sway" => state.spring = is_on()?.then(Spring::default),
        "wind" => state.wind.speed_m_per_s = number(0.0, 30.0)? as f32,
        "wind.gusts" => state.wind.gusts = number(0.0, 1.0)? as f32,
        "panel" => state.open.panel = is_on()?,
        "help" => state.open.help = is_on()?,
        "orbit" => {
            let model = model.ok_or_else(|| fault(name, value, "an angle, once the asset is read"))?;
            let viewpoint = Viewpoint::Orbit(value.parse::<Orbit>()?);
            state.eye = super::eye::Eye::of(&viewpoint.camera(&model.subject, aspect)?);
        }
        _ => {
            return Err(Error::usage("there is no such control").with_field(name).with_expected(
                "exposure, background, light, light.turn, light.raise, light.stops, light.shadow, sky, show, level, blend, \
                 animation, time, speed, play, against, wipe, hair, length, slant, sway, wind, wind.gusts, panel, help, orbit, section.NAME or preset.KEY",
            ));
        }
    }
    Ok(())
}

/// Whether a control is set to `on` or `off`.
///
/// # Errors
/// [`crate::error::Kind::Usage`] for any other word.
pub fn on_or_off(name: &str, value: &str) -> Result<bool> {
    match value {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(fault(name, value, "on or off")),
    }
}

fn source(value: &str) -> Result<Source> {
    match value {
        "asked" => Ok(Source::Asked),
        "map" => Ok(Source::Surroundings),
        rig => rig.parse::<Rig>().map(Source::Rig),
    }
}

fn number(name: &str, value: &str, [low, high]: [f64; 2]) -> Result<f64> {
    // As f32, as most values are: 0.1 is not less than 0.1.
    let [low, high] = [low as f32, high as f32];
    let number = value.parse().ok().filter(|number: &f64| (low..=high).contains(&(*number as f32)));
    number.ok_or_else(|| fault(name, value, &format!("a number from {low} to {high}")))
}

fn fault(name: &str, value: &str, expected: &str) -> Error {
    Error::usage("the control has no such value").with_field(name).with_found(value).with_expected(expected)
}
