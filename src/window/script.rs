//! Scripts that drive the window, for demonstrations and tests: one action a line (`docs/window.md`).

use crate::error::{Error, Result};
use egui::{Event, Key, Modifiers};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// `resize W H`: the window's size, pixels.
    Resize([u32; 2]),
    /// `scale F`: pixels for each point of the controls; 2 for a screen that is twice as dense.
    Scale(f32),
    /// `drop FILE`: as if it were dropped on the window.
    Drop(PathBuf),
    /// `press KEY`: with `Shift+` or `Ctrl+` before it where these are held.
    Press(Key, Modifiers),
    /// `set NAME VALUE`: a control.
    Set(String, String),
    /// `wait`: until the picture is final; `wait S`: so many seconds.
    Wait(Option<f64>),
    /// `picture FILE.png`: all of the window, into a file.
    Picture(PathBuf),
    /// `report FILE.json`: what the window tells of itself, into a file.
    Report(PathBuf),
    /// `quit`: closes the window.
    Quit,
}

/// Actions that are left to do.
#[derive(Clone, Debug, Default)]
pub struct Script(pub VecDeque<Action>);

impl Script {
    /// Reads a script's file.
    ///
    /// # Errors
    /// Where it cannot be read; else as [`Self::parse`].
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| Error::input("the script cannot be read").with_file(path).with_found(error))?;
        Self::parse(&text).map_err(|error| error.with_file(path))
    }

    /// Reads a script. Empty lines and what follows a `#` at a line's beginning are passed over.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] names the line that is no action.
    pub fn parse(text: &str) -> Result<Self> {
        let lines = text.lines().map(str::trim).enumerate();
        let meant = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let action = |(at, line): (usize, &str)| {
            action(line).ok_or_else(|| {
                Error::usage("the script has a line that is no action")
                    .with_field(format!("line {}", at + 1))
                    .with_found(line)
                    .with_expected(
                        "resize W H, scale F, drop FILE, press KEY, set NAME VALUE, wait [S], picture FILE.png, report FILE.json or quit",
                    )
            })
        };
        Ok(Self(meant.map(action).collect::<Result<_>>()?))
    }
}

fn action(line: &str) -> Option<Action> {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    let file = || Some(PathBuf::from(rest)).filter(|_| !rest.is_empty());
    match word {
        "resize" => {
            let (width, height) = rest.split_once(char::is_whitespace)?;
            let edge = |text: &str| text.trim().parse().ok().filter(|n| (64..=8192).contains(n));
            Some(Action::Resize([edge(width)?, edge(height)?]))
        }
        "scale" => rest.parse().ok().filter(|f| (0.5..=4.0).contains(f)).map(Action::Scale),
        "drop" => file().map(Action::Drop),
        "press" => press(rest),
        "set" => {
            let (name, value) = rest.split_once(char::is_whitespace)?;
            Some(Action::Set(name.to_owned(), value.trim().to_owned()))
        }
        "wait" if rest.is_empty() => Some(Action::Wait(None)),
        "wait" => rest.parse().ok().filter(|s| (0.0..=600.0).contains(s)).map(|s| Action::Wait(Some(s))),
        "picture" => file().map(Action::Picture),
        "report" => file().map(Action::Report),
        "quit" if rest.is_empty() => Some(Action::Quit),
        _ => None,
    }
}

fn press(text: &str) -> Option<Action> {
    let (mut modifiers, mut name) = (Modifiers::NONE, text);
    loop {
        if let Some(rest) = name.strip_prefix("Shift+") {
            (modifiers, name) = (modifiers | Modifiers::SHIFT, rest);
        } else if let Some(rest) = name.strip_prefix("Ctrl+") {
            (modifiers, name) = (modifiers | Modifiers::COMMAND | Modifiers::CTRL, rest);
        } else {
            return Key::from_name(name).map(|key| Action::Press(key, modifiers));
        }
    }
}

/// What the system would say of this key: that it went down and up, and what it wrote.
pub fn events(key: Key, modifiers: Modifiers) -> Vec<Event> {
    let stroke = |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    let symbol = key.symbol_or_name();
    let written = (symbol.chars().count() == 1 && !modifiers.command).then(|| {
        let text = if modifiers.shift { symbol.to_uppercase() } else { symbol.to_lowercase() };
        Event::Text(text)
    });
    let held = |modifiers| Some(Event::ModifiersChanged(modifiers));
    let all = [held(modifiers), Some(stroke(true)), written, Some(stroke(false)), held(Modifiers::NONE)];
    all.into_iter().flatten().collect()
}

/// A file that a script drops.
#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> std::result::Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}
