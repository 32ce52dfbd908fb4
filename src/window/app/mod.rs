//! The window's contents, whatever shows them: panels, the picture, and the threads behind.

mod baking;
mod begin;
mod hair;
mod picture;
mod playing;
mod reading;
mod report;
mod status;

pub use begin::{Begin, Wish};

use super::comparison::{Comparison, Judged};
use super::drawing::{self, Answer};
use super::edits::Edits;
use super::eye::Eye;
use super::keys::{self, Asked};
use super::lighting::{Lighting, Surroundings};
use super::loading::{self, News, Ready, Task};
use super::look::Look;
use super::mailbox::Sender;
use super::model::Model;
use super::panel;
use super::parameters::Typed;
use super::script::{Action, Script};
use super::sections;
use super::state::{Clock, Open, State};
use super::told::Answers;
use super::truth::{self, Truth};
use super::watch::Watch;
use crate::asset::Asset;
use crate::bake::recipe::Choices;
use crate::cache::Store;
use crate::error::{Error, Result};
use crate::runtime::Wind;
use crate::stage::options::Options;
use egui::{CentralPanel, Context, Panel, ScrollArea, TextureHandle, Ui};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long nothing must change before a picture is drawn in full.
const QUIET: Duration = Duration::from_millis(200);

/// What other threads tell.
enum Word {
    Drawn(Box<Result<Answer>>),
    Loaded(Box<News>),
    /// A coarse coat, and of which change it is.
    Sketched(u64, Box<Result<Ready>>),
    Surroundings(Box<Result<Surroundings>>),
    Hair(Box<Result<Truth>>),
    Judged(Box<Result<Judged>>),
    Touched,
}

/// Says words, and wakes the window to hear them.
#[derive(Clone)]
struct Voice {
    says: mpsc::Sender<Word>,
    context: Context,
}

impl Voice {
    fn say(&self, word: Word) {
        // Nobody listens any more once the window is closed.
        let _ = self.says.send(word);
        self.context.request_repaint();
    }
}

/// The window's contents.
pub struct App {
    /// What the person decides.
    pub state: State,
    /// How quickly the window answered since that was reported last.
    pub answers: Answers,
    subject: loading::Subject,
    /// As [`Begin::in_words`].
    in_words: fn(&str, &Choices) -> String,
    /// Finished stages of this window, where nothing else keeps them.
    _scratch: Option<TempDir>,
    viewpoint: Options,
    moment: Option<(String, f64)>,
    model: Option<Arc<Model>>,
    /// The asset as it was read last, without its coat; none until then, and where it wears one.
    bare: Option<Arc<Asset>>,
    /// Whether the next model is another asset, to be framed anew.
    fresh: bool,
    edits: Option<Edits>,
    typed: Typed,
    baking: baking::Baking,
    notes: Vec<String>,
    trouble: Option<Error>,
    step: Option<&'static str>,
    draw: Sender<drawing::Order>,
    load: Sender<Task>,
    hair: hair::Hair,
    words: mpsc::Receiver<Word>,
    voice: Voice,
    watch: Option<Watch>,
    /// When something that is watched changed last.
    touched: Option<Instant>,
    shown: Option<Answer>,
    texture: Option<TextureHandle>,
    ordered: Option<picture::Ordered>,
    changed: Instant,
    script: Script,
    waiting: Option<Instant>,
    failed: Option<Error>,
    aspect: f64,
    /// The eye as it framed the asset, and for which aspect.
    framed: (f64, Eye),
}

impl App {
    /// Starts the threads and what is to be read.
    ///
    /// # Errors
    /// Where the system has no threads to give.
    pub fn new(begin: Begin, context: &Context) -> Result<Self> {
        let (says, words) = mpsc::channel();
        let voice = Voice { says, context: context.clone() };
        let own = voice.clone();
        let draw = drawing::start(begin.device, move |answer| own.say(Word::Drawn(Box::new(answer))))?;
        let own = voice.clone();
        let load = loading::start(move |news| own.say(Word::Loaded(Box::new(news))))?;
        let own = voice.clone();
        let hair = truth::start(move |truth| own.say(Word::Hair(Box::new(truth))))?;
        let lighting = Lighting { shadow: begin.shadow, ..Lighting::new(begin.stage.clone()) };
        let mut subject = begin.subject;
        let scratch = if subject.cache.is_none() { tempfile::tempdir().ok() } else { None };
        subject.cache = subject.cache.or(scratch.as_ref().map(|folder| Store::new(folder.path())));
        let eye = Eye::first(&begin.stage.viewpoint, &Default::default(), 1.0);
        let mut app = Self {
            answers: Answers::default(),
            state: State {
                eye,
                lighting,
                development: begin.stage.development,
                shown: begin.shown,
                level: begin.level,
                blend: begin.blend,
                clock: Clock::default(),
                comparison: Comparison::default(),
                combing: begin.combing,
                wind: Wind::default(),
                spring: None,
                open: Open { panel: true, help: false, counting: false },
            },
            in_words: begin.in_words,
            subject,
            _scratch: scratch,
            viewpoint: begin.stage,
            moment: begin.moment,
            model: None,
            bare: None,
            fresh: true,
            edits: None,
            typed: Typed::default(),
            baking: baking::Baking::new(voice.clone())?,
            notes: Vec::new(),
            trouble: None,
            step: None,
            draw,
            load,
            hair: hair::Hair::new(hair),
            words,
            voice,
            watch: None,
            touched: None,
            shown: None,
            texture: None,
            ordered: None,
            changed: Instant::now(),
            script: begin.script,
            waiting: None,
            failed: None,
            aspect: 1.0,
            framed: (0.0, eye),
        };
        app.read();
        Ok(app)
    }

    /// What kept the script from being done.
    pub fn failure(&mut self) -> Option<Error> {
        self.failed.take()
    }

    /// Whether what is shown is final: nothing is read, baked or drawn any more.
    pub fn at_rest(&self) -> bool {
        let settled = self.shown.as_ref().is_some_and(|shown| {
            let same = self.model.as_ref().is_some_and(|model| Arc::ptr_eq(model, &shown.model));
            same && shown.coarseness == 1
                && shown.look == self.state.look(shown.look.size)
                && self.compared(&shown.look)
        });
        let moving = self.state.clock.playing || self.state.spring.is_some();
        self.step.is_none() && !self.baking.due() && (settled || self.trouble.is_some()) && !moving
    }

    /// One frame. What the window itself is to do is returned.
    pub fn frame(&mut self, ui: &mut Ui) -> Vec<Wish> {
        let context = ui.ctx().clone();
        self.listen();
        self.reread();
        let mut wishes = Vec::new();
        for file in ui.input(|input| input.raw.dropped_files.clone()) {
            self.dropped(file.path());
        }
        match keys::act(ui, &mut self.state, self.model.as_deref(), self.aspect) {
            Asked::Nothing => {}
            Asked::Close => wishes.push(Wish::Close),
            Asked::Undo => self.undo(),
            Asked::Redo => self.redo(),
        }
        if let Some(model) = &self.model {
            self.state.clock.pass(f64::from(ui.input(|input| input.unstable_dt)), &model.animations);
        }
        self.bake_when_at_rest();
        Panel::bottom("status").show(ui, |ui| self.status(ui));
        if self.state.open.panel {
            // Some of the picture is seen in any case.
            let most = (0.65 * ui.available_width()).max(200.0);
            Panel::right("controls").default_size(310.0_f32.min(most)).max_size(most).show(ui, |ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| self.panel(ui));
            });
        }
        CentralPanel::no_frame().show(ui, |ui| self.picture(ui));
        self.help(&context);
        if self.state.clock.playing || self.state.spring.is_some() {
            context.request_repaint();
        }
        if let Some(next) = self.script.0.front() {
            // The script goes on, though nothing else happens. Who waits leaves the processor to what is waited for.
            let waits = matches!(next, Action::Wait(_));
            context.request_repaint_after(Duration::from_millis(if waits { 100 } else { 5 }));
        }
        wishes
    }

    fn panel(&mut self, ui: &mut Ui) {
        for title in sections::TITLES {
            sections::obey(ui, &sections::called(title), egui::IdSalt::new(title));
        }
        let statistics = self.shown.as_ref().map(|shown| &shown.statistics);
        panel::show(ui, &mut self.state, self.model.as_deref(), statistics);
        self.hair_panel(ui);
        self.parameters(ui);
        panel::window(ui);
    }

    fn look(&self, size: [u32; 2]) -> Look {
        self.state.look(size)
    }
}
