//! What the window tells of itself, as a file.

use super::App;
use crate::error::{Error, Result};
use crate::window::panel;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

impl App {
    /// Writes it as JSON: how quickly the window answered since the last report; from the last change of the preset to its coarse and its final
    /// coat, and what the steps of that one took; the statistics and the comparison as the panel has them.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub(super) fn report(&mut self, path: &Path) -> Result<()> {
        let statistics: BTreeMap<_, _> = match &self.shown {
            Some(shown) => panel::rows(&self.state, self.model.as_deref(), &shown.statistics).into_iter().collect(),
            None => BTreeMap::new(),
        };
        let comparison: Option<BTreeMap<_, _>> = self.comparison().map(|judged| judged.rows().into_iter().collect());
        let [coarse, last] = self.baking.took;
        let told = json!({
            "answers": std::mem::take(&mut self.answers),
            "change": { "coarse": coarse, "final": last, "steps": self.baking.steps },
            "statistics": statistics,
            "comparison": comparison,
        });
        let text = format!("{told:#}\n");
        std::fs::write(path, text)
            .map_err(|error| Error::input("the report cannot be written").with_file(path).with_found(error))
    }
}
