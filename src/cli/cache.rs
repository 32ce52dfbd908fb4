//! `furrier cache`.

use super::console::Console;
use crate::cache::{Limits, Removed, Store, VARIABLE, default_folder};
use crate::error::{Error, Result};
use bytesize::ByteSize;
use clap::{Args, Subcommand};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Duration;

/// Look at what finished stages are kept, and tidy up
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier cache stat
  furrier cache gc --max-size 5GB --max-age 30days
      what was not used for longest goes first
  furrier cache verify --cache /mnt/farm/furrier
      reads every value; exits with 3 where one is damaged
  furrier cache clear")]
pub struct Cache {
    #[command(subcommand)]
    action: Action,
    /// The cache's folder. Default: what the environment variable FURRIER_CACHE names, else furrier in the system's folder for
    /// caches
    #[arg(long, value_name = "DIR", global = true)]
    cache: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Say how much is kept, by stage
    Stat,
    /// Remove what was not used for longest, until the rest is within the limits, and what was never finished
    Gc(Gc),
    /// Read every value and check its hash
    Verify {
        /// Remove what is damaged
        #[arg(long)]
        remove: bool,
    },
    /// Remove everything that is kept
    Clear,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = true)]
struct Gc {
    /// Keep at most so much, as 500MB or 5GiB
    #[arg(long, value_name = "SIZE")]
    max_size: Option<ByteSize>,
    /// Keep nothing that was not used for so long, as 12h or 30days
    #[arg(long, value_name = "AGE", value_parser = humantime::parse_duration)]
    max_age: Option<Duration>,
}

/// What was found or done, and where.
fn told(store: &Store, what: &impl Serialize) -> Value {
    let mut value = json!(what);
    value["folder"] = json!(store.folder());
    value
}

impl Cache {
    /// Looks or tidies.
    ///
    /// # Errors
    /// Where there is no cache, or its folder cannot be listed or tidied; where a value is damaged and stays.
    pub fn run(self, console: &Console) -> Result<()> {
        let store = self.store()?;
        match self.action {
            Action::Stat => stat(&store, console),
            Action::Gc(gc) => {
                let limits = Limits { bytes: gc.max_size.map(|size| size.as_u64()), age: gc.max_age };
                removed(&store, store.tidy(limits)?, console)
            }
            Action::Verify { remove } => verify(&store, remove, console),
            Action::Clear => removed(&store, store.clear()?, console),
        }
    }

    fn store(&self) -> Result<Store> {
        let folder = self.cache.clone().or_else(default_folder);
        folder.map(Store::new).ok_or_else(|| {
            Error::usage("there is no cache")
                .with_parameter("cache")
                .with_found(format!("neither a folder nor {VARIABLE}, or {VARIABLE} is empty"))
                .with_expected("a folder")
                .with_hint("name one with `cache`")
        })
    }
}

fn stat(store: &Store, console: &Console) -> Result<()> {
    let survey = store.survey()?;
    console.result(&told(store, &survey), |out| {
        writeln!(out, "{}: {} values, {}", store.folder().display(), survey.values, size(survey.bytes))?;
        for (stage, of) in &survey.stages {
            writeln!(out, "  {stage:12} {:6} values {:>10}", of.values, size(of.bytes))?;
        }
        if survey.of_other_builds > 0 {
            writeln!(out, "{} of them are other builds', of no use to this one", survey.of_other_builds)?;
        }
        if survey.unfinished > 0 {
            writeln!(out, "{} files are being written, or were when their process died", survey.unfinished)?;
        }
        match survey.unused_for_s {
            Some(seconds) => {
                let ago = humantime::format_duration(Duration::from_secs(seconds));
                writeln!(out, "not used for longest: {ago}")
            }
            None => Ok(()),
        }
    })
}

fn removed(store: &Store, removed: Removed, console: &Console) -> Result<()> {
    console.result(&told(store, &removed), |out| {
        let (gone, left) = (size(removed.bytes), size(removed.left_bytes));
        writeln!(out, "{}: {} files removed, {gone}; {left} left", store.folder().display(), removed.files)
    })
}

fn verify(store: &Store, remove: bool, console: &Console) -> Result<()> {
    let verified = store.verify()?;
    if remove {
        verified.damaged.iter().try_for_each(|(file, _)| store.remove(file))?;
    }
    let damaged: Vec<_> = verified.damaged.iter().map(|(file, fault)| json!({"file": file, "fault": fault})).collect();
    let value = json!({"folder": store.folder(), "sound": verified.sound, "damaged": damaged, "removed": remove});
    console.result(&value, |out| {
        for (file, fault) in &verified.damaged {
            writeln!(out, "damaged{}: {} ({fault})", if remove { " and removed" } else { "" }, file.display())?;
        }
        writeln!(out, "{}: {} values are sound", store.folder().display(), verified.sound)
    })?;
    match verified.damaged.len() {
        0 => Ok(()),
        _ if remove => Ok(()),
        count => Err(Error::input("values of the cache are damaged")
            .with_file(store.folder())
            .with_found(format!("{count} damaged"))
            .with_hint("a bake makes them again; `remove` removes them now")),
    }
}

fn size(bytes: u64) -> ByteSize {
    ByteSize::b(bytes)
}
