//! Steps: what is done, how long it takes, and what of it was done before (`docs/steps/cache.md`).

use crate::cache::{Found, Key, Store};
use crate::error::Result;
use crate::metrics::timing;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// The step that looks for values and keeps them.
const CACHE: &str = "cache";

/// What of a bake came from its cache.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Cached {
    /// The cache's folder.
    pub folder: PathBuf,
    /// By stage.
    pub stages: BTreeMap<&'static str, Uses>,
}

/// How many of a stage's values were there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Uses {
    /// Taken from the cache.
    pub found: u32,
    /// Not there, or not whole: made.
    pub made: u32,
}

/// Does steps, measures them and tells of them; a stage's result is looked for before it is made, and kept afterwards.
pub(super) struct Steps<'a> {
    tell: &'a mut dyn FnMut(&'static str),
    times: timing::Steps,
    store: Option<Store>,
    writable: bool,
    cached: Cached,
    warnings: Vec<String>,
}

impl<'a> Steps<'a> {
    /// No step is done yet.
    pub(super) fn new(tell: &'a mut dyn FnMut(&'static str), store: Option<Store>) -> Self {
        let folder = store.as_ref().map(|store| store.folder().to_owned()).unwrap_or_default();
        let cached = Cached { folder, stages: BTreeMap::new() };
        Self { tell, times: timing::Steps::default(), store, writable: true, cached, warnings: Vec::new() }
    }

    /// Does a step.
    pub(super) fn run<T>(&mut self, name: &'static str, step: impl FnOnce() -> T) -> T {
        (self.tell)(name);
        let start = Instant::now();
        let result = step();
        self.times.add_since(name, start, 0);
        result
    }

    /// Does a step that does steps itself: their time is theirs.
    pub(super) fn around<T>(&mut self, name: &'static str, step: impl FnOnce(&mut Self) -> T) -> T {
        (self.tell)(name);
        let (start, before_ms) = (Instant::now(), self.times.total_ms());
        let result = step(self);
        let theirs_ms = self.times.total_ms() - before_ms;
        self.times.add(name, start.elapsed().as_secs_f64() * 1e3 - theirs_ms, 0);
        result
    }

    /// What `stage` makes of `made_from`: as it was kept, or else what `make` gives, which is then kept. The result must not
    /// depend on anything but `made_from` and this program.
    ///
    /// # Errors
    /// As `make`. A cache that fails is told of and done without.
    pub(super) fn kept<T: Serialize + DeserializeOwned>(
        &mut self,
        stage: &'static str,
        made_from: &impl Serialize,
        make: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        let key = self.key(stage, made_from);
        if let Some(value) = self.find(key.as_ref()) {
            return Ok(value);
        }
        let value = make(self)?;
        self.keep(key.as_ref(), &value);
        Ok(value)
    }

    /// The key of what `stage` makes of `made_from`; none without a cache.
    pub(super) fn key(&mut self, stage: &'static str, made_from: &impl Serialize) -> Option<Key> {
        self.store.as_ref()?;
        let start = Instant::now();
        let key = Key::new(stage, made_from);
        self.times.add_since(CACHE, start, 0);
        key.map_err(|error| self.warnings.push(format!("{stage} is not kept: {error}"))).ok()
    }

    /// What is kept under a key.
    pub(super) fn find<T: DeserializeOwned>(&mut self, key: Option<&Key>) -> Option<T> {
        let (store, key) = (self.store.as_ref()?, key?);
        let start = Instant::now();
        let found = match store.get(key) {
            Found::Value(bytes) => postcard::from_bytes(&bytes).map_err(|error| Some(error.to_string())),
            Found::Absent => Err(None),
            Found::Damaged(fault) => Err(Some(fault)),
        };
        self.times.add_since(CACHE, start, 0);
        let uses = self.cached.stages.entry(key.stage()).or_default();
        match found {
            Ok(value) => {
                uses.found += 1;
                Some(value)
            }
            Err(fault) => {
                uses.made += 1;
                if let Some(fault) = fault {
                    let path = store.path(key);
                    self.warnings.push(format!("damaged in the cache and made again: {} ({fault})", path.display()));
                }
                None
            }
        }
    }

    /// Keeps a value.
    pub(super) fn keep<T: Serialize>(&mut self, key: Option<&Key>, value: &T) {
        let (Some(store), Some(key), true) = (&self.store, key, self.writable) else { return };
        let start = Instant::now();
        let put = postcard::to_stdvec(value).map_err(std::io::Error::other).and_then(|bytes| store.put(key, &bytes));
        if let Err(error) = put {
            self.writable = false;
            let folder = store.folder().display();
            self.warnings.push(format!("the cache {folder} takes nothing more, the bake goes on without: {error}"));
        }
        self.times.add_since(CACHE, start, 0);
    }

    /// Time per step, what came from the cache, and what should be said of it.
    pub(super) fn done(self) -> (timing::Steps, Option<Cached>, Vec<String>) {
        (self.times, self.store.map(|_| self.cached), self.warnings)
    }
}
