//! One asset: baked, and its record kept.

use super::key::Key;
use super::plan::{Entry, Plan};
use super::record::{Program, Record, Sources, create, digest_of, files_of};
use crate::bake::{Request, bake};
use crate::cache::Store;
use crate::error::{Error, Kind, Result};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

/// How often an asset is baked that changes meanwhile.
const TRIES: usize = 3;

/// Bakes an entry on so many threads, with what a cache has of it. An asset that changes while it is read is baked again.
///
/// # Errors
/// As [`bake`]; where the asset does not stop changing; where the record cannot be kept.
pub fn bake_entry(
    plan: &Plan,
    entry: &Entry,
    key: &Key,
    (threads, cache): (usize, Option<Store>),
    tell: &(dyn Fn(&'static str) + Sync),
) -> Result<Record> {
    let (input, output) = (plan.input(entry), plan.output(entry));
    create(output.parent().unwrap_or(Path::new("")))?;
    let records = plan.records();
    let recipe = &plan.recipes[entry.recipe];
    // All that a bake is given, it is given here.
    let request = Request { cache, ..recipe.request(&input.to_string_lossy(), &output, false) };
    for _ in 0..TRIES {
        let sources = Sources::read(&input)?;
        let start = Instant::now();
        let baked = on_threads(threads, || bake(&request, &mut |step| tell(step)))?;
        let seconds = start.elapsed().as_secs_f64();
        // What was hashed before is what was read only where it is the same after.
        if Sources::read(&input)? != sources || Key::of(recipe)? != *key {
            continue;
        }
        let (digest, bytes) = digest_of(&output).map_err(|error| {
            Error::new(Kind::Output, format!("the output cannot be read back: {error}")).with_file(&output)
        })?;
        let record = Record {
            input: entry.input.clone(),
            sources,
            recipe: key.digest.clone(),
            program: Program::CURRENT,
            output: digest,
            bytes,
            seconds,
            threads,
            warnings: baked.warnings,
            notes: baked.notes,
        };
        records.put(&output, &record, key)?;
        return Ok(record);
    }
    // Nobody could say what these outputs were made from.
    for file in files_of(&output) {
        let _ = std::fs::remove_file(file);
    }
    records.remove(&output);
    Err(Error::input("the asset changes while it is read")
        .with_file(&input)
        .with_found(format!("other bytes after each of {TRIES} bakes"))
        .with_expected("the same bytes before and after")
        .with_hint("run again when it is written"))
}

/// Does `work` on threads of its own. A fault of the program ends this asset, not the run.
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::new(Kind::Output, "the threads cannot be started").with_parameter("threads").with_found(error)
    })?;
    catch_unwind(AssertUnwindSafe(|| pool.install(work))).unwrap_or_else(|_| {
        Err(Error::input("the program failed on this asset; that is a fault of the program")
            .with_hint("bake the asset alone, and report what is printed"))
    })
}
