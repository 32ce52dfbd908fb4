//! The thread that reads and bakes what the window shows.

use super::mailbox::{Receiver, Sender, mailbox};
use super::model::Model;
use crate::asset::coat::read_coat_as;
use crate::asset::{self, Asset, Reading};
use crate::bake::recipe::{Choices, Recipe, split_choice};
use crate::bake::seen::seen;
use crate::bake::units;
use crate::cache::Store;
use crate::data::coat::Coat;
use crate::error::{Error, Kind, Result};
use crate::metrics::timing;
use crate::preset::Preset;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// What the window shows, before it is read.
#[derive(Clone, Debug)]
pub struct Subject {
    /// A file, or `sample:NAME` where it is baked.
    pub input: String,
    /// How it is read.
    pub reading: Reading,
    /// How it is baked; none for a file that wears its coat already.
    pub choices: Option<Choices>,
    /// Where finished stages are kept.
    pub cache: Option<Store>,
}

impl Subject {
    /// The files that it begins with: the input, and presets that are files.
    pub fn files(&self) -> Vec<PathBuf> {
        let presets = self.choices.iter().flat_map(|choices| &choices.presets).map(|choice| split_choice(choice).1);
        let named = presets.filter(|name| Preset::source(name).is_none());
        let input = Some(self.input.as_str()).filter(|input| !input.starts_with("sample:"));
        input.into_iter().chain(named).map(PathBuf::from).collect()
    }
}

/// What is to be made ready.
pub enum Task {
    /// All of it, from disk.
    Read(Subject),
    /// A new coat by this recipe, of the asset that was read before, if it was.
    Bake(Subject, Option<Arc<Asset>>, Box<Recipe>),
}

/// What comes of it.
pub enum News {
    /// A step has begun.
    Step(&'static str),
    /// The mesh without its coat, while that is baked.
    Bare(Arc<Model>),
    /// It is ready.
    Ready(Ready),
    /// What went wrong.
    Failed(Error),
}

/// A model and how it came to be.
pub struct Ready {
    /// What to look at.
    pub model: Arc<Model>,
    /// How it was baked; none where it came with its coat.
    pub recipe: Option<Box<Recipe>>,
    /// What to tell of it, one sentence each.
    pub notes: Vec<String>,
    /// Wall time, ms.
    pub ms: f64,
    /// And of its bake by step; none where it came with its coat.
    pub steps: timing::Steps,
    /// Whether it was read from disk, so that changes of its preset begin anew.
    pub read: bool,
}

/// A coarse coat that is wanted.
pub struct Sketch {
    /// Of what.
    pub subject: Subject,
    /// It without a coat, where it was read.
    pub bare: Option<Arc<Asset>>,
    /// By which recipe.
    pub recipe: Box<Recipe>,
    /// Which change it is of.
    pub change: u64,
}

/// Starts the thread that bakes coarse coats, so that they need not wait for final ones. `tell` is called on it.
///
/// # Errors
/// Where the system has no thread to give.
pub fn start_sketches(tell: impl Fn(u64, Result<Ready>) + Send + 'static) -> Result<Sender<Sketch>> {
    let (sender, sketches) = mailbox::<Sketch>();
    let work = move || {
        while let Some(Sketch { subject, bare, recipe, change }) = sketches.take() {
            tell(change, baked(&subject, bare.as_deref(), *recipe, &|_| ()));
        }
    };
    std::thread::Builder::new()
        .name("sketch".into())
        .spawn(work)
        .map_err(|error| Error::new(Kind::Machine, "the thread that bakes cannot be started").with_found(error))?;
    Ok(sender)
}

/// Starts the thread. `tell` is called on it.
///
/// # Errors
/// Where the system has no thread to give.
pub fn start(tell: impl Fn(News) + Send + 'static) -> Result<Sender<Task>> {
    let (sender, tasks) = mailbox();
    let work = move || serve(&tasks, &tell);
    std::thread::Builder::new()
        .name("load".into())
        .spawn(work)
        .map_err(|error| Error::new(Kind::Machine, "the thread that reads cannot be started").with_found(error))?;
    Ok(sender)
}

fn serve(tasks: &Receiver<Task>, tell: &dyn Fn(News)) {
    while let Some(task) = tasks.take() {
        let made = match task {
            Task::Read(subject) => read(&subject, tell),
            Task::Bake(subject, bare, recipe) => baked(&subject, bare.as_deref(), *recipe, tell),
        };
        tell(made.map_or_else(News::Failed, News::Ready));
    }
}

fn read(subject: &Subject, tell: &dyn Fn(News)) -> Result<Ready> {
    let start = Instant::now();
    let Some(choices) = &subject.choices else {
        tell(News::Step("read"));
        let (asset, coat) = read_coat_as(Path::new(&subject.input), &subject.reading)
            .map_err(|error| error.with_hint("a mesh without a coat is baked with a preset, as `fox`"))?;
        let notes = asset.warnings.clone();
        let model = Arc::new(Model::new(asset, coat)?);
        return Ok(Ready {
            model,
            recipe: None,
            notes,
            ms: start.elapsed().as_secs_f64() * 1e3,
            steps: timing::Steps::default(),
            read: true,
        });
    };
    let recipe = choices.recipe()?;
    tell(News::Step("read"));
    let asset = asset::load_as(&subject.input, &Reading { rebake: true, ..subject.reading })?;
    let chosen = asset::select(&asset.parts, &recipe.materials)?.parts;
    let sample = subject.input.starts_with("sample:");
    let metres_per_unit = units::scale(recipe.units, &recipe.preset, &asset, &chosen, sample)?.metres_per_unit;
    let bare = Arc::new(Model::new(asset, Coat { metres_per_unit, ..Coat::default() })?);
    tell(News::Bare(Arc::clone(&bare)));
    Ok(Ready { read: true, ..baked(subject, Some(&bare.asset), recipe, tell)? })
}

fn baked(subject: &Subject, bare: Option<&Asset>, recipe: Recipe, tell: &dyn Fn(News)) -> Result<Ready> {
    let start = Instant::now();
    let mut told = |step| tell(News::Step(step));
    let (asset, coat, baked) =
        seen(&recipe, (&subject.input, bare), &subject.reading, subject.cache.clone(), &mut told)?;
    let model = Arc::new(Model::new(asset, coat)?);
    let notes = [baked.warnings, baked.notes].concat();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    Ok(Ready { model, recipe: Some(Box::new(recipe)), notes, ms, steps: baked.steps, read: false })
}
