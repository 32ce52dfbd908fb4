//! What the window remembers from one time to the next.

use crate::asset::write;
use crate::error::{Error, Kind, Result};
use egui::{Context, ThemePreference};
use etcetera::BaseStrategy;
use etcetera::base_strategy::choose_native_strategy;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Light, dark, or as the system is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
    /// As the system is.
    #[default]
    System,
}

/// What is remembered. A file that says anything else is taken for none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Size of writing and controls over the system's.
    pub zoom: f32,
    /// Colours of controls.
    pub theme: Theme,
    /// Whether the panel is open.
    pub panel: bool,
    /// Size of the window, points of the system.
    pub size: [f32; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self { zoom: 1.0, theme: Theme::System, panel: true, size: [1280.0, 800.0] }
    }
}

impl Settings {
    /// Where they are: in the system's folder for settings.
    pub fn place() -> Option<PathBuf> {
        Some(choose_native_strategy().ok()?.config_dir().join("furrier").join("window.toml"))
    }

    /// Those in a file, or the first ones where there is none that can be read.
    pub fn read(path: &Path) -> Self {
        let read: Option<Self> = std::fs::read_to_string(path).ok().and_then(|text| toml::from_str(&text).ok());
        let fine = |settings: &Self| {
            let sized = settings.size.iter().all(|edge| (200.0..=16_000.0).contains(edge));
            (0.5..=4.0).contains(&settings.zoom) && sized
        };
        read.filter(fine).unwrap_or_default()
    }

    /// Writes them.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let fault = |error: &dyn std::fmt::Display| {
            Error::new(Kind::Output, "the window's settings cannot be kept").with_file(path).with_found(error)
        };
        let text = toml::to_string(self).map_err(|error| fault(&error))?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| fault(&error))?;
        }
        write::whole(path, text.as_bytes(), &[])
    }

    /// Sets a context up by them.
    pub fn apply(&self, context: &Context) {
        context.set_zoom_factor(self.zoom);
        context.set_theme(match self.theme {
            Theme::Light => ThemePreference::Light,
            Theme::Dark => ThemePreference::Dark,
            Theme::System => ThemePreference::System,
        });
    }

    /// Those that a context has now.
    pub fn of(context: &Context, panel: bool, size: [f32; 2]) -> Self {
        let theme = match context.options(|options| options.theme_preference) {
            ThemePreference::Light => Theme::Light,
            ThemePreference::Dark => Theme::Dark,
            ThemePreference::System => Theme::System,
        };
        Self { zoom: context.zoom_factor(), theme, panel, size }
    }
}
