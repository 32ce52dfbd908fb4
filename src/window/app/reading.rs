//! What comes from disk and from other threads.

use super::{App, Word};
use crate::window::edits::Edits;
use crate::window::eye::Eye;
use crate::window::lighting::{Source, Surroundings};
use crate::window::loading::{News, Ready, Task};
use crate::window::model::Model;
use crate::window::watch::Watch;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long nothing must change on disk before it is read again: programs write in pieces.
const WRITTEN: Duration = Duration::from_millis(400);

impl App {
    /// Reads the subject from disk, and hears from now on when it changes there.
    pub(super) fn read(&mut self) {
        (self.step, self.bare) = (Some("read"), None);
        self.load.put(Task::Read(self.subject.clone()));
        self.watch(BTreeSet::new());
    }

    /// Watches what the subject is read from, and `more` files.
    fn watch(&mut self, more: BTreeSet<PathBuf>) {
        let files: BTreeSet<PathBuf> = self.subject.files().into_iter().chain(more).collect();
        if self.watch.as_ref().is_some_and(|watch| watch.is_of(&files)) {
            return;
        }
        let voice = self.voice.clone();
        match Watch::new(files, move || voice.say(Word::Touched)) {
            Ok(watch) => self.watch = Some(watch),
            Err(error) => self.notes.push(error.to_string()),
        }
    }

    /// Reads again what changed on disk, once it is written.
    pub(super) fn reread(&mut self) {
        let Some(touched) = self.touched else { return };
        match WRITTEN.checked_sub(touched.elapsed()) {
            Some(left) if !left.is_zero() => self.voice.context.request_repaint_after(left),
            _ => {
                self.touched = None;
                self.read();
            }
        }
    }

    /// Hears what other threads tell.
    pub(super) fn listen(&mut self) {
        while let Ok(word) = self.words.try_recv() {
            match word {
                Word::Drawn(answer) => match *answer {
                    Ok(answer) => self.hang(answer),
                    Err(error) => self.trouble = Some(error),
                },
                Word::Loaded(news) => self.loaded(*news),
                Word::Sketched(change, ready) => self.sketched(change, *ready),
                Word::Touched => self.touched = Some(Instant::now()),
                Word::Hair(truth) => self.grown(*truth),
                Word::Judged(judged) => self.judged(*judged),
                Word::Surroundings(read) => {
                    self.step = None;
                    match *read {
                        Ok(map) => {
                            self.trouble = None;
                            self.state.lighting.surroundings = Some(Arc::new(map));
                            self.state.lighting.source = Source::Surroundings;
                        }
                        Err(error) => self.trouble = Some(error),
                    }
                }
            }
        }
    }

    fn loaded(&mut self, news: News) {
        match news {
            News::Step(step) => self.step = Some(step),
            News::Bare(model) => {
                self.bare = Some(Arc::clone(&model.asset));
                self.watch(model.asset.document.files.iter().cloned().collect());
                // While a coat is baked anew, the one before it is shown.
                if self.fresh || !self.model.as_ref().is_some_and(|model| model.furred()) {
                    self.look_at(model);
                }
            }
            News::Ready(ready) => {
                (self.step, self.trouble) = (None, None);
                let Ready { model, recipe, notes, ms, read, steps } = ready;
                if recipe.is_none() {
                    self.watch(model.asset.document.files.iter().cloned().collect());
                }
                if read {
                    self.edits = recipe.map(Edits::new);
                    self.baking.forget();
                    self.warm();
                } else if !self.baking.settled(recipe.as_deref(), &model, steps) {
                    // It was changed again meanwhile.
                    return;
                }
                self.notes = notes;
                self.notes.push(format!("ready in {:.2} s", ms / 1e3));
                self.look_at(model);
            }
            News::Failed(error) => (self.step, self.trouble) = (None, Some(error)),
        }
    }

    /// From where the command line said at first; later from where the eye is.
    pub(super) fn look_at(&mut self, model: Arc<Model>) {
        if std::mem::take(&mut self.fresh) {
            self.state.eye = Eye::first(&self.viewpoint.viewpoint, &model.subject, self.aspect);
            self.framed = (self.aspect, self.state.eye);
            if let Err(error) = self.viewpoint.viewpoint.camera(&model.subject, self.aspect) {
                self.trouble = Some(error);
            }
            if let Some((name, seconds)) = self.moment.take() {
                match model.asset.animation(&name) {
                    Ok(index) => (self.state.clock.animation, self.state.clock.seconds) = (Some(index), seconds),
                    Err(error) => self.trouble = Some(error),
                }
            }
        }
        // With its coat it is larger.
        let dressed = model.furred() && self.model.as_ref().is_some_and(|bare| !bare.furred());
        if dressed && self.state.eye == self.framed.1 {
            self.state.eye = Eye::first(&self.viewpoint.viewpoint, &model.subject, self.aspect);
            self.framed = (self.aspect, self.state.eye);
        }
        let clock = &mut self.state.clock;
        clock.animation = clock.animation.filter(|at| *at < model.animations.len());
        self.model = Some(model);
    }

    /// Where nobody has moved the eye yet, all of the asset stays in the picture, whatever its size becomes.
    pub(super) fn frame_again(&mut self) {
        let Some(model) = &self.model else { return };
        let (aspect, eye) = self.framed;
        if self.state.eye == eye && aspect != self.aspect {
            self.state.eye = Eye::first(&self.viewpoint.viewpoint, &model.subject, self.aspect);
            self.framed = (self.aspect, self.state.eye);
        }
    }

    /// A map becomes light and sky; another asset is looked at.
    pub(super) fn dropped(&mut self, path: &Path) {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if ["hdr", "exr"].contains(&extension.as_str()) {
            self.step = Some("read the map of light");
            let (voice, path) = (self.voice.clone(), path.to_owned());
            rayon::spawn(move || voice.say(Word::Surroundings(Box::new(Surroundings::read(&path)))));
            return;
        }
        self.subject.input = path.to_string_lossy().into_owned();
        (self.fresh, self.trouble) = (true, None);
        self.read();
    }
}
