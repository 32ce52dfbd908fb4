//! The script's hand.

use super::{App, QUIET, Wish};
use crate::error::Result;
use crate::window::script::{self, Action};
use crate::window::sections;
use crate::window::set::{on_or_off, set};
use egui::Context;
use std::sync::Arc;
use std::time::Instant;

impl App {
    /// What the script does before the next frame: changes of `input`, and wishes. Each action has a frame of its own.
    pub fn play(&mut self, input: &mut egui::RawInput, context: &Context) -> Vec<Wish> {
        while let Some(Action::Wait(seconds)) = self.script.0.front() {
            let since = *self.waiting.get_or_insert_with(Instant::now);
            let over = match seconds {
                // Some frames pass in any case, so that what was done is seen.
                None => since.elapsed() > 2 * QUIET && self.at_rest(),
                Some(seconds) => since.elapsed().as_secs_f64() >= *seconds,
            };
            if !over {
                return Vec::new();
            }
            self.waiting = None;
            self.script.0.pop_front();
        }
        let Some(action) = self.script.0.pop_front() else { return Vec::new() };
        match action {
            Action::Resize(size) => return vec![Wish::Resize(size)],
            Action::Picture(path) => return vec![Wish::Picture(path)],
            Action::Quit => return vec![Wish::Close],
            Action::Scale(scale) => context.set_pixels_per_point(scale),
            Action::Drop(path) => {
                let file: egui::DroppedFileHandle = Arc::new(script::Dropped(path));
                input.dropped_files.push(file);
            }
            Action::Press(key, modifiers) => input.events.extend(script::events(key, modifiers)),
            Action::Set(name, value) => {
                if let Err(error) = self.set(&name, &value) {
                    self.failed = Some(error);
                    return vec![Wish::Close];
                }
            }
            Action::Report(path) => {
                if let Err(error) = self.report(&path) {
                    self.failed = Some(error);
                    return vec![Wish::Close];
                }
            }
            Action::Wait(_) => {}
        }
        Vec::new()
    }

    fn set(&mut self, name: &str, value: &str) -> Result<()> {
        if let Some(section) = name.strip_prefix("section.") {
            let open = on_or_off(name, value)?;
            return sections::ask(&self.voice.context, section, open);
        }
        match name.strip_prefix("preset.") {
            Some(key) => self.set_key(key, value),
            None => set(&mut self.state, self.model.as_deref(), self.aspect, name, value),
        }
    }
}
