//! Changes of a preset at the window: one after the other, undone and done again, saved, told as a command line.

use crate::asset::write;
use crate::bake::recipe::Recipe;
use crate::error::{Error, Result};
use crate::preset::Preset;
use std::path::Path;

/// Most changes that can be undone.
const MOST: usize = 1000;

/// A recipe that is changed.
pub struct Edits {
    /// As it was when the window opened, or when its files changed last.
    base: Box<Recipe>,
    /// As it is now.
    now: Box<Recipe>,
    past: Vec<Preset>,
    future: Vec<Preset>,
    /// The key that was changed last, as long as the hand has not left it: one pull of a slider is one change.
    held: Option<String>,
}

impl Edits {
    /// Nothing is changed yet.
    pub fn new(recipe: Box<Recipe>) -> Self {
        Self { base: recipe.clone(), now: recipe, past: Vec::new(), future: Vec::new(), held: None }
    }

    /// As it is now.
    pub fn recipe(&self) -> &Recipe {
        &self.now
    }

    /// Sets `key` to `value`, which is TOML. What is set while the hand holds one control is one change.
    ///
    /// # Errors
    /// As [`Preset::with_settings`]; nothing is changed then.
    pub fn set(&mut self, key: &str, value: &str) -> Result<()> {
        let changed = self.now.preset.clone().with_settings(&[format!("{key}={value}")])?;
        if changed == self.now.preset {
            return Ok(());
        }
        let before = std::mem::replace(&mut self.now.preset, changed);
        if self.held.as_deref() != Some(key) {
            self.past.push(before);
            if self.past.len() > MOST {
                self.past.remove(0);
            }
        }
        self.held = Some(key.to_owned());
        self.future.clear();
        Ok(())
    }

    /// The hand has left the control.
    pub fn let_go(&mut self) {
        self.held = None;
    }

    /// Takes the last change back. False where there is none.
    pub fn undo(&mut self) -> bool {
        self.held = None;
        let Some(before) = self.past.pop() else { return false };
        self.future.push(std::mem::replace(&mut self.now.preset, before));
        true
    }

    /// Does what was undone last again. False where there is nothing.
    pub fn redo(&mut self) -> bool {
        self.held = None;
        let Some(after) = self.future.pop() else { return false };
        self.past.push(std::mem::replace(&mut self.now.preset, after));
        true
    }

    /// How many changes can be undone and done again.
    pub fn depth(&self) -> [usize; 2] {
        [self.past.len(), self.future.len()]
    }

    /// Writes the preset as it is now. A bake with it gives what the window shows.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        write::whole(path, self.toml()?.as_bytes(), &[])
    }

    /// The preset as it is now, as a preset's file.
    ///
    /// # Errors
    /// Where TOML cannot hold it.
    pub fn toml(&self) -> Result<String> {
        let unwritable = |error: toml::ser::Error| Error::usage("the preset cannot be written").with_found(error);
        let mut value = toml::Value::try_from(&self.now.preset).map_err(unwritable)?;
        shorten(&mut value);
        toml::to_string(&value).map_err(unwritable)
    }

    /// What was changed, as `table.key=value` each.
    pub fn settings(&self) -> Vec<String> {
        let value = |preset: &Preset| toml::Value::try_from(preset).ok();
        let (Some(base), Some(mut now)) = (value(&self.base.preset), value(&self.now.preset)) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        // What is the same is told by the value as it is; what is written is short.
        let mut short = base;
        shorten(&mut short);
        shorten(&mut now);
        differences("", &short, &now, &mut found);
        found
    }
}

/// Numbers of presets are f32: as few digits as tell one from the next.
fn shorten(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) => {
            if let Ok(short) = (*number as f32).to_string().parse() {
                *number = short;
            }
        }
        toml::Value::Array(items) => items.iter_mut().for_each(shorten),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| shorten(value)),
        _ => {}
    }
}

fn differences(name: &str, base: &toml::Value, now: &toml::Value, found: &mut Vec<String>) {
    match (base, now) {
        (toml::Value::Table(base), toml::Value::Table(now)) => {
            for (key, value) in now {
                let path = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                match base.get(key) {
                    Some(before) => differences(&path, before, value, found),
                    None => found.push(format!("{path}={value}")),
                }
            }
        }
        (base, now) if base != now => found.push(format!("{name}={now}")),
        _ => {}
    }
}
