//! What a store holds, and tidying it. Only files that lie and are named as a store's own are ever touched.

use super::{Store, entry, read};
use crate::asset::write::ASIDE;
use crate::error::{Error, Kind, Result};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs::{self, DirEntry, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A file that is being written is not older than this; one that is was left behind by a process that died.
const LONGEST_WRITE: Duration = Duration::from_secs(3600);

/// A file of a store.
#[derive(Clone, Debug)]
struct Kept {
    path: PathBuf,
    bytes: u64,
    /// When it was last used.
    used: SystemTime,
    stage: String,
    /// The key's hash that its name says; none for a file that is being written or was never finished.
    hash: Option<[u8; 32]>,
}

/// Values of one stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OfStage {
    /// How many.
    pub values: u64,
    /// On the disk.
    pub bytes: u64,
}

/// What a store holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Survey {
    /// By stage.
    pub stages: BTreeMap<String, OfStage>,
    /// All values.
    pub values: u64,
    /// All values, on the disk.
    pub bytes: u64,
    /// How many of them other builds of the program made: this one has no use for them.
    pub of_other_builds: u64,
    /// How long ago the value was used that was not used for longest, s; none where there is no value.
    pub unused_for_s: Option<u64>,
    /// Files that are being written, or were when their process died.
    pub unfinished: u64,
}

/// What a store may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// At most so many bytes.
    pub bytes: Option<u64>,
    /// Nothing that was not used for longer.
    pub age: Option<Duration>,
}

/// What was removed, and what stayed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Removed {
    /// Files removed.
    pub files: u64,
    /// Bytes removed.
    pub bytes: u64,
    /// Bytes that stayed.
    pub left_bytes: u64,
}

/// What reading every value showed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Verified {
    /// Values that are as they were put there.
    pub sound: u64,
    /// Files that are not, and what is wrong with each.
    pub damaged: Vec<(PathBuf, String)>,
}

impl Store {
    /// Counts what there is.
    ///
    /// # Errors
    /// Where the folder cannot be listed.
    pub fn survey(&self) -> Result<Survey> {
        let (mut survey, now) = (Survey::default(), SystemTime::now());
        for kept in self.files()? {
            if kept.hash.is_none() {
                survey.unfinished += 1;
                continue;
            }
            let unused_for_s = now.duration_since(kept.used).unwrap_or_default().as_secs();
            survey.unused_for_s = survey.unused_for_s.max(Some(unused_for_s));
            survey.of_other_builds += u64::from(!is_of_this_build(&kept.path));
            survey.values += 1;
            survey.bytes += kept.bytes;
            let stage = survey.stages.entry(kept.stage).or_default();
            stage.values += 1;
            stage.bytes += kept.bytes;
        }
        Ok(survey)
    }

    /// Removes what was not used for longest until the rest is within `limits`, and what was never finished.
    ///
    /// # Errors
    /// Where the folder cannot be listed, or a file not removed.
    pub fn tidy(&self, limits: Limits) -> Result<Removed> {
        let (mut files, now) = (self.files()?, SystemTime::now());
        // The newest first; what is as old by name, so that two who tidy at once remove the same.
        files.sort_by(|a, b| b.used.cmp(&a.used).then_with(|| a.path.cmp(&b.path)));
        let mut removed = Removed::default();
        for kept in files {
            let age = now.duration_since(kept.used).unwrap_or_default();
            let stays = match kept.hash {
                None => age <= LONGEST_WRITE,
                Some(_) => {
                    limits.age.is_none_or(|most| age <= most)
                        && limits.bytes.is_none_or(|most| removed.left_bytes + kept.bytes <= most)
                }
            };
            removed.one(&kept, stays)?;
        }
        Ok(removed)
    }

    /// Removes everything.
    ///
    /// # Errors
    /// As [`Self::tidy`].
    pub fn clear(&self) -> Result<Removed> {
        let mut removed = Removed::default();
        self.files()?.iter().try_for_each(|kept| removed.one(kept, false))?;
        Ok(removed)
    }

    /// Reads every value.
    ///
    /// # Errors
    /// Where the folder cannot be listed.
    pub fn verify(&self) -> Result<Verified> {
        let mut verified = Verified::default();
        for kept in self.files()? {
            let Some(hash) = kept.hash else { continue };
            let fault = match read(&kept.path) {
                Ok((_, bytes)) => entry::value(&bytes, &hash).err(),
                // Another has removed it meanwhile.
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                Err(error) => Some(error.to_string()),
            };
            match fault {
                None => verified.sound += 1,
                Some(fault) => verified.damaged.push((kept.path, fault)),
            }
        }
        Ok(verified)
    }

    /// Removes a file that [`Self::verify`] named.
    ///
    /// # Errors
    /// Where it cannot be removed.
    pub fn remove(&self, file: &Path) -> Result<()> {
        match fs::remove_file(file) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(fault("a value cannot be removed", file, &error)),
            _ => Ok(()),
        }
    }

    /// Every file that is this store's, in the order of their names.
    fn files(&self) -> Result<Vec<Kept>> {
        let mut files = Vec::new();
        for stage in list(self.folder())? {
            let stage_name = stage.file_name().to_string_lossy().into_owned();
            if !stage_name.bytes().all(|c| c.is_ascii_lowercase() || c == b'-') {
                continue;
            }
            for first in list(&stage.path())? {
                let start = first.file_name().to_string_lossy().into_owned();
                if start.len() != 2 {
                    continue;
                }
                for file in list(&first.path())? {
                    let name = file.file_name().to_string_lossy().into_owned();
                    let hash = blake3::Hash::from_hex(format!("{start}{name}")).ok().map(|hash| *hash.as_bytes());
                    let unfinished = name.starts_with(ASIDE[0]) && name.ends_with(ASIDE[1]);
                    // One that is gone meanwhile is no longer there to be counted.
                    if let (true, Ok(about)) = (hash.is_some() || unfinished, file.metadata()) {
                        let used = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                        let stage = stage_name.clone();
                        files.push(Kept { path: file.path(), bytes: about.len(), used, stage, hash });
                    }
                }
            }
        }
        files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(files)
    }
}

impl Removed {
    /// Counts a file, and removes it unless it `stays`.
    fn one(&mut self, kept: &Kept, stays: bool) -> Result<()> {
        if stays {
            self.left_bytes += kept.bytes;
            return Ok(());
        }
        match fs::remove_file(&kept.path) {
            Ok(()) => {
                self.files += 1;
                self.bytes += kept.bytes;
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) => Err(fault("a file of the cache cannot be removed", &kept.path, &error)),
        }
    }
}

fn is_of_this_build(file: &Path) -> bool {
    let mut start = [0; entry::START];
    File::open(file).and_then(|mut file| file.read_exact(&mut start)).is_ok() && entry::is_of_this_build(&start)
}

/// What is in a folder; nothing where there is none.
fn list(folder: &Path) -> Result<Vec<DirEntry>> {
    let listed = fs::read_dir(folder).and_then(Iterator::collect);
    match listed {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Ok(Vec::new()),
        listed => listed.map_err(|error| fault("the cache cannot be listed", folder, &error)),
    }
}

fn fault(what: &str, path: &Path, error: &std::io::Error) -> Error {
    Error::new(Kind::Output, what).with_file(path).with_found(error).with_hint("check its permissions")
}
