//! `furrier batch --watch`: what changes on disk is baked again.

use super::LibraryArgs;
use crate::bake::recipe::Recipe;
use crate::batch::plan::Plan;
use crate::cli::console::Console;
use crate::error::{Error, Kind, Result};
use notify::{EventKind, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long nothing must change before it is baked: programs write in pieces.
const QUIET: Duration = Duration::from_millis(400);

/// Does `bake` now and whenever something that the library is made from changes, for as long as the process lives. What goes wrong is
/// said, and the next change awaited.
///
/// # Errors
/// Where the folders cannot be watched.
pub fn watch(library: &LibraryArgs, console: &Console, bake: &dyn Fn(&Plan) -> Result<()>) -> Result<()> {
    let fail = |error: notify::Error| {
        Error::new(Kind::Input, "the library cannot be watched").with_found(error).with_hint("bake without `watch`")
    };
    let (says, heard) = channel();
    let mut watcher = notify::recommended_watcher(move |event| drop(says.send(event))).map_err(fail)?;
    let mut watched = BTreeSet::new();
    loop {
        let plan = library.plan();
        let own = plan.as_ref().map(Own::of).unwrap_or_default();
        // Watched before it is baked, so that nothing that changes meanwhile is missed.
        let folders = plan.as_ref().map_or_else(|_| library.folders(), |plan| folders(plan, library));
        for folder in folders.into_iter().filter(|folder| folder.is_dir()) {
            if watched.insert(folder.clone()) {
                watcher.watch(&folder, RecursiveMode::Recursive).map_err(fail)?;
            }
        }
        if let Err(error) = plan.and_then(|plan| bake(&plan)) {
            console.error(error);
        }
        console.note("waiting for changes; Ctrl-C ends it");
        if !changed(&heard, &own) {
            return Ok(());
        }
    }
}

/// Waits until something changed that is not the library's own doing, and then until nothing does. False where nothing can be heard
/// any more.
fn changed(heard: &Receiver<notify::Result<notify::Event>>, own: &Own) -> bool {
    let counts = |event: &notify::Result<notify::Event>| match event {
        // What was lost may have been anything.
        Err(_) => true,
        Ok(event) if matches!(event.kind, EventKind::Access(_)) => false,
        Ok(event) => event.paths.iter().any(|path| !own.has(path)),
    };
    loop {
        match heard.recv() {
            Ok(event) if counts(&event) => break,
            Ok(_) => {}
            Err(_) => return false,
        }
    }
    while heard.recv_timeout(QUIET).is_ok() {}
    true
}

/// What a batch writes itself.
#[derive(Default)]
struct Own {
    state: PathBuf,
    outputs: BTreeSet<PathBuf>,
}

impl Own {
    fn of(plan: &Plan) -> Self {
        let outputs = plan.entries.iter().flat_map(|entry| crate::batch::record::files_of(&plan.output(entry)));
        Self { state: plan.state(), outputs: outputs.collect() }
    }

    fn has(&self, path: &Path) -> bool {
        let part = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".furrier"));
        let folder = self.outputs.iter().any(|output| output.parent() == Some(path));
        part || folder || path.starts_with(&self.state) || self.outputs.contains(path)
    }
}

/// The folders that a library is made from: its own, and those of the presets' maps.
fn folders(plan: &Plan, library: &LibraryArgs) -> Vec<PathBuf> {
    let maps = plan.recipes.iter().flat_map(Recipe::all_presets).flat_map(|preset| {
        let maps = &preset.maps;
        let own = [&maps.density, &maps.length, &maps.comb, &maps.colour, &maps.clump].into_iter().flatten();
        let regions = preset.regions.iter();
        let of_regions =
            regions.flat_map(|region| region.map.clone().into_iter().chain([PathBuf::from(&region.preset)]));
        own.cloned().chain(of_regions).collect::<Vec<_>>()
    });
    let beside =
        maps.filter_map(|file| file.parent().map(Path::to_owned)).filter(|folder| !folder.as_os_str().is_empty());
    library.folders().into_iter().chain(beside).collect()
}
