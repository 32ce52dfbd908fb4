//! Changes of the preset, and the coats that come of them: a coarse one at once, the final one when the hand rests.

use super::{App, Voice, Word};
use crate::asset::coat::Fallback;
use crate::bake::recipe::{Choices, Layout, Recipe};
use crate::error::Result;
use crate::metrics::timing;
use crate::window::loading::{self, Ready, Sketch, Task};
use crate::window::mailbox::Sender;
use crate::window::model::Model;
use crate::window::parameters::{self, Wanted};
use crate::window::told::Coming;
use egui::Ui;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The number of a change that nobody made.
const NOBODYS: u64 = u64::MAX;
/// How long the hand must rest before the final coat is baked.
const RESTS: Duration = Duration::from_millis(350);
/// How long the final coat waits at most for the coarse one to be seen.
const SKETCHED: Duration = Duration::from_millis(1500);
/// Texels along an edge of a coarse coat's tile, and its layers, at most.
const COARSE: [u32; 2] = [32, 6];
/// Texels of a coarse coat's fins, along the skin and up, at most.
const COARSE_FIN: [u32; 2] = [128, 32];

/// Which coat is wanted, and which is there.
pub(super) struct Baking {
    sketches: Sender<Sketch>,
    /// Counts changes.
    change: u64,
    /// When the last change was; none where the final coat of it is baked or ordered.
    touched: Option<Instant>,
    /// The recipe whose final coat is ordered and not there yet.
    ordered: Option<Box<Recipe>>,
    /// The last change's coarse coat and its final one.
    pub(super) coming: [Coming; 2],
    /// When the last change was.
    began: Option<Instant>,
}

impl Baking {
    pub(super) fn new(voice: Voice) -> Result<Self> {
        let told = move |change, ready: Result<Ready>| voice.say(Word::Sketched(change, Box::new(ready)));
        let sketches = loading::start_sketches(told)?;
        Ok(Self { sketches, change: 0, touched: None, ordered: None, coming: Default::default(), began: None })
    }

    /// Counts changes of the preset.
    pub(super) fn change(&self) -> u64 {
        self.change
    }

    /// Whether the final coat is still to come.
    pub(super) fn due(&self) -> bool {
        self.touched.is_some() || self.ordered.is_some()
    }

    /// Nothing is ordered: what is shown was read anew.
    pub(super) fn forget(&mut self) {
        (self.touched, self.ordered, self.change) = (None, None, self.change + 1);
    }

    /// Takes note of a final coat. False where it is not of what is wanted now.
    pub(super) fn settled(&mut self, recipe: Option<&Recipe>, model: &Arc<Model>, steps: timing::Steps) -> bool {
        let wanted = self.ordered.as_deref() == recipe && self.touched.is_none();
        if wanted {
            self.ordered = None;
            self.coming[1].baked(self.began, model, steps);
        }
        wanted
    }

    /// Takes note of a picture of `model`.
    pub(super) fn seen(&mut self, model: &Arc<Model>) {
        self.coming.iter_mut().for_each(|coat| coat.seen(self.began, model));
    }
}

/// The same hair in a coat that is quickly baked.
fn coarse(recipe: &Recipe) -> Recipe {
    let mut recipe = recipe.clone();
    let presets = std::iter::once(&mut recipe.preset).chain(recipe.presets.iter_mut().map(|(_, preset)| preset));
    for preset in presets {
        let shells = &mut preset.shells;
        (shells.texture_size, shells.layers) = (shells.texture_size.min(COARSE[0]), shells.layers.min(COARSE[1]));
        let fins = &mut preset.fins;
        fins.texture_width = fins.texture_width.min(COARSE_FIN[0]);
        fins.texture_height = fins.texture_height.min(COARSE_FIN[1]);
    }
    Recipe { fallback: Fallback::None, draft: true, ..recipe }
}

impl App {
    /// The panel's part about the preset.
    pub(super) fn parameters(&mut self, ui: &mut Ui) {
        let Some(edits) = &self.edits else { return };
        let mut wanted = parameters::wetness(ui, edits);
        egui::CollapsingHeader::new("Preset").default_open(false).show(ui, |ui| {
            let [coarse, last] = self.baking.coming.each_ref().map(|coat| coat.seen_ms);
            if coarse.or(last).is_some() {
                let [coarse, last] = [coarse, last].map(|ms| ms.map_or("…".to_owned(), |ms| format!("{ms:.0} ms")));
                ui.weak(format!("from a change to the sight of its coarse coat {coarse}, of its final one {last}"));
            }
            wanted.extend(parameters::show(ui, edits, &mut self.typed));
        });
        for wanted in wanted {
            if let Err(error) = self.change(wanted) {
                self.trouble = Some(error);
            }
        }
    }

    fn change(&mut self, wanted: Wanted) -> Result<()> {
        let Some(edits) = &mut self.edits else { return Ok(()) };
        match wanted {
            Wanted::Set(key, value) => {
                let before = edits.recipe().preset.clone();
                edits.set(&key, &value)?;
                if edits.recipe().preset != before {
                    self.sketch();
                }
            }
            Wanted::LetGo => edits.let_go(),
            Wanted::Undo => self.undo(),
            Wanted::Redo => self.redo(),
            Wanted::Save(file) => {
                edits.save(file.as_ref())?;
                self.notes.push(format!("saved as {file}"));
            }
            Wanted::Copy => {
                let command = self.command();
                self.voice.context.copy_text(command);
                self.notes.push("the command line is in the clipboard".to_owned());
            }
        }
        Ok(())
    }

    /// Sets a key of the preset, as a script does.
    ///
    /// # Errors
    /// As [`crate::preset::Preset::with_settings`].
    pub fn set_key(&mut self, key: &str, value: &str) -> Result<()> {
        self.change(Wanted::Set(key.to_owned(), value.to_owned()))?;
        self.change(Wanted::LetGo)
    }

    /// The bake that gives the coat that is shown, as a command line.
    fn command(&self) -> String {
        let Some(edits) = &self.edits else { return String::new() };
        let choices = self.subject.choices.clone().unwrap_or_default();
        let shells = &edits.recipe().preset.shells;
        // What stood beside the presets is told as settings, so that what was changed since comes after it.
        let lapped = choices.texture_size.filter(|_| choices.layout != Layout::Atlas);
        let beside = [
            choices.layers.map(|_| format!("shells.layers={}", shells.layers)),
            lapped.map(|_| format!("shells.texture_size={}", shells.texture_size)),
        ];
        let settings = choices.settings.iter().cloned().chain(edits.settings()).chain(beside.into_iter().flatten());
        let texture_size = choices.texture_size.filter(|_| choices.layout == Layout::Atlas);
        let told = Choices { settings: settings.collect(), layers: None, texture_size, ..choices };
        (self.in_words)(&self.subject.input, &told)
    }

    pub(super) fn undo(&mut self) {
        if self.edits.as_mut().is_some_and(|edits| edits.undo()) {
            self.sketch();
        }
    }

    pub(super) fn redo(&mut self) {
        if self.edits.as_mut().is_some_and(|edits| edits.redo()) {
            self.sketch();
        }
    }

    /// Orders the coarse coat of what the preset is now.
    fn sketch(&mut self) {
        let Some(edits) = &self.edits else { return };
        let baking = &mut self.baking;
        baking.change += 1;
        (baking.touched, baking.began) = (Some(Instant::now()), Some(Instant::now()));
        baking.coming = Default::default();
        let recipe = Box::new(coarse(edits.recipe()));
        baking.sketches.put(Sketch {
            subject: self.subject.clone(),
            bare: self.bare.clone(),
            recipe,
            change: baking.change,
        });
    }

    /// Bakes a draft that nobody sees, so that what rays tell of it is there when the first change comes.
    pub(super) fn warm(&self) {
        let Some(edits) = &self.edits else { return };
        let recipe = Box::new(coarse(edits.recipe()));
        let (subject, bare) = (self.subject.clone(), self.bare.clone());
        self.baking.sketches.put(Sketch { subject, bare, recipe, change: NOBODYS });
    }

    pub(super) fn sketched(&mut self, change: u64, ready: Result<Ready>) {
        // A final coat of the same change may have been quicker.
        if change != self.baking.change || !self.baking.due() {
            return;
        }
        match ready {
            Ok(ready) => {
                self.baking.coming[0].baked(self.baking.began, &ready.model, ready.steps);
                self.look_at(ready.model);
            }
            Err(error) => self.trouble = Some(error),
        }
    }

    /// Orders the final coat once the hand rests.
    pub(super) fn bake_when_at_rest(&mut self) {
        let Some(touched) = self.baking.touched else { return };
        // The coarse coat is seen first, or both would share the processor and come late.
        let sketched = self.baking.coming[0].seen_ms.is_some();
        let rests = if sketched { RESTS } else { SKETCHED };
        match rests.checked_sub(touched.elapsed()) {
            Some(left) if !left.is_zero() => self.voice.context.request_repaint_after(left),
            _ => {
                let Some(edits) = &self.edits else { return };
                let recipe = Box::new(edits.recipe().clone());
                self.baking.touched = None;
                self.baking.ordered = Some(recipe.clone());
                self.step = Some("bake");
                self.load.put(Task::Bake(self.subject.clone(), self.bare.clone(), recipe));
            }
        }
    }
}
