//! What keys do, and the list of it that `?` shows.

use super::comparison::Mode;
use super::eye::Eye;
use super::model::Model;
use super::state::State;
use crate::viewer::CHANNELS;
use egui::{Key, Modifiers, Ui};

/// Keys and what they do, as the window's help shows them.
pub const LIST: &[(&str, &str)] = &[
    ("drag, arrows", "turn about the asset"),
    ("middle or Shift drag, Shift arrows", "move sideways"),
    ("wheel, + and −", "nearer, further away"),
    ("right drag, W A S D, Q E", "look around, fly"),
    ("F", "frame the asset"),
    ("1, 3, 7; with Shift", "from the front, the right, above; from the back, the left, below"),
    ("C", "next camera of the asset"),
    ("Space", "play or stop the animation"),
    (", and .", "a thirtieth of a second back, forward"),
    ("N", "next animation; after the last the rest pose"),
    ("[ and ]", "turn the light"),
    ("{ and }", "lower or raise the light"),
    ("9 and 0", "darker, brighter"),
    ("V", "next channel"),
    ("X", "the coat alone; wiped against its hair; one at a time; side by side; the error map"),
    ("H", "the hair or the coat, where they take turns"),
    ("Ctrl Z, Ctrl Shift Z", "take a change of the preset back, do it again"),
    ("L", "next level of detail; after the coarsest by size"),
    ("P", "show or hide the panel"),
    ("Tab, Shift Tab; Enter", "next, previous control; press it"),
    ("Ctrl + and Ctrl −", "larger, smaller writing"),
    ("?, F1", "this list"),
    ("Ctrl Q", "close"),
];

/// What a key asks the window for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Nothing beyond the state.
    Nothing,
    /// To close.
    Close,
    /// The last change of the preset taken back.
    Undo,
    /// It done again.
    Redo,
}

/// Does what the keys of this frame say. `aspect` is the picture's width over its height.
pub fn act(ui: &Ui, state: &mut State, model: Option<&Model>, aspect: f64) -> Asked {
    let pressed = |key: Key, shift: bool| {
        ui.input(|input| input.key_pressed(key) && input.modifiers.shift == shift && !input.modifiers.command)
    };
    let close = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Q));
    if close {
        return Asked::Close;
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)) {
        return Asked::Redo;
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Z)) {
        return Asked::Undo;
    }
    // What is typed into a field is no command.
    if ui.ctx().text_edit_focused() {
        return Asked::Nothing;
    }
    let typed = |text: &str| {
        ui.input(|input| input.events.iter().any(|event| matches!(event, egui::Event::Text(t) if t == text)))
    };
    if typed("?") || pressed(Key::F1, false) {
        state.open.help = !state.open.help;
    }
    if pressed(Key::Escape, false) {
        state.open.help = false;
    }
    if pressed(Key::P, false) {
        state.open.panel = !state.open.panel;
    }
    light(state, &typed);
    if pressed(Key::X, false) {
        let at = Mode::ALL.iter().position(|(_, mode)| *mode == state.comparison.mode).map_or(0, |at| at + 1);
        state.comparison.mode = Mode::ALL[at % Mode::ALL.len()].1;
    }
    if pressed(Key::H, false) {
        state.comparison.hair = !state.comparison.hair;
    }
    if pressed(Key::V, false) {
        let at = CHANNELS.iter().position(|(_, shown)| *shown == state.shown).map_or(0, |at| at + 1);
        state.shown = CHANNELS[at % CHANNELS.len()].1;
    }
    move_eye(ui, &mut state.eye, &pressed);
    if let Some(model) = model {
        with_model(state, model, aspect, &pressed, &typed);
    }
    Asked::Nothing
}

fn light(state: &mut State, typed: &dyn Fn(&str) -> bool) {
    let lighting = &mut state.lighting;
    for (key, by) in [("[", -15.0), ("]", 15.0)] {
        if typed(key) {
            lighting.turn_deg = (lighting.turn_deg + by + 180.0).rem_euclid(360.0) - 180.0;
        }
    }
    for (key, by) in [("{", -15.0), ("}", 15.0)] {
        if typed(key) {
            lighting.raise_deg = (lighting.raise_deg + by).clamp(-90.0, 90.0);
        }
    }
    for (key, by) in [("9", -0.25), ("0", 0.25)] {
        if typed(key) {
            state.development.exposure_ev = (state.development.exposure_ev + by).clamp(-8.0, 8.0);
        }
    }
}

/// Steps of keys that turn, move and bring nearer; flying goes on while keys are down.
fn move_eye(ui: &Ui, eye: &mut Eye, pressed: &dyn Fn(Key, bool) -> bool) {
    // Arrows belong to a slider that has the focus.
    if ui.ctx().memory(|memory| memory.focused()).is_none() {
        for (key, right, up) in [
            (Key::ArrowLeft, -1.0, 0.0),
            (Key::ArrowRight, 1.0, 0.0),
            (Key::ArrowUp, 0.0, 1.0),
            (Key::ArrowDown, 0.0, -1.0),
        ] {
            if pressed(key, false) {
                eye.orbit(right * 15.0, up * 15.0);
            }
            if pressed(key, true) {
                eye.pan(right * 0.1, up * 0.1);
            }
        }
    }
    for (keys, factor) in [([Key::Plus, Key::Equals], 0.8), ([Key::Minus, Key::Minus], 1.25)] {
        if keys.into_iter().any(|key| pressed(key, false) || pressed(key, true)) {
            eye.zoom(factor);
        }
    }
    let (down, elapsed_s) = ui.input(|input| {
        let down = |key| if input.key_down(key) && input.modifiers.is_none() { 1.0 } else { 0.0 };
        let way = [down(Key::D) - down(Key::A), down(Key::E) - down(Key::Q), down(Key::W) - down(Key::S)];
        (way, f64::from(input.stable_dt.min(0.1)))
    });
    if down != [0.0; 3] {
        let step_m = eye.distance_m * elapsed_s;
        eye.fly(down.map(|way: f64| way * step_m));
        ui.ctx().request_repaint();
    }
}

fn with_model(
    state: &mut State,
    model: &Model,
    aspect: f64,
    pressed: &dyn Fn(Key, bool) -> bool,
    typed: &dyn Fn(&str) -> bool,
) {
    let eye = &mut state.eye;
    if pressed(Key::F, false) {
        *eye = Eye::framing(&model.subject, [eye.azimuth_deg, eye.elevation_deg], aspect);
    }
    for (key, from, back) in [
        (Key::Num1, [0.0, 0.0], [180.0, 0.0]),
        (Key::Num3, [90.0, 0.0], [270.0, 0.0]),
        (Key::Num7, [0.0, 89.0], [0.0, -89.0]),
    ] {
        if pressed(key, false) {
            *eye = Eye::framing(&model.subject, from, aspect);
        } else if pressed(key, true) {
            *eye = Eye::framing(&model.subject, back, aspect);
        }
    }
    if pressed(Key::C, false) {
        let cameras: Vec<Eye> =
            model.subject.cameras.iter().filter_map(|named| named.value.clone().ok()).map(|c| Eye::of(&c)).collect();
        let at = cameras.iter().position(|camera| camera == eye).map_or(0, |at| at + 1);
        if let Some(next) = cameras.get(at % cameras.len().max(1)) {
            *eye = *next;
        }
    }
    if pressed(Key::L, false) {
        let levels = State::levels(model);
        state.level = state.level.map_or(Some(0), |level| Some(level + 1)).filter(|level| *level < levels);
    }
    let clock = &mut state.clock;
    if pressed(Key::Space, false) {
        clock.toggle(&model.animations);
    }
    if pressed(Key::N, false) {
        clock.animation = clock.animation.map_or(Some(0), |at| Some(at + 1)).filter(|at| *at < model.animations.len());
        clock.seconds = 0.0;
    }
    for (key, by) in [(",", -1.0 / 30.0), (".", 1.0 / 30.0)] {
        if typed(key) {
            clock.playing = false;
            let longest = clock.animation.map_or(0.0, |at| model.animations[at].seconds);
            clock.seconds = (clock.seconds + by).clamp(0.0, longest);
        }
    }
}
