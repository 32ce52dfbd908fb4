//! What the window tells of itself, as a file.

use super::App;
use crate::asset::write;
use crate::error::Result;
use crate::window::panel;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

impl App {
    /// Writes it as JSON: how quickly the window answered since the last report; from the last change of the preset to its coarse and its final
    /// coat, and what their steps took; the statistics and the comparison as the panel has them.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub(super) fn report(&mut self, path: &Path) -> Result<()> {
        let statistics: BTreeMap<_, _> = match &self.shown {
            Some(shown) => panel::rows(&self.state, self.model.as_deref(), &shown.statistics).into_iter().collect(),
            None => BTreeMap::new(),
        };
        let comparison: Option<BTreeMap<_, _>> = self.comparison().map(|judged| judged.rows().into_iter().collect());
        let [coarse, last] = &self.baking.coming;
        let told = json!({
            "answers": std::mem::take(&mut self.answers),
            "change": { "coarse": coarse, "final": last },
            "statistics": statistics,
            "comparison": comparison,
        });
        write::whole(path, format!("{told:#}\n").as_bytes(), &[])
    }
}
