//! Time and memory, step by step: what report files hold (`docs/steps/metrics.md`).

use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Version of the report files' layout.
pub const SCHEMA_VERSION: u32 = 1;

/// One step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// What was done.
    pub name: String,
    /// How long it took, ms.
    pub ms: f64,
    /// What it holds or reads, bytes; 0 where that means nothing.
    pub bytes: u64,
}

/// Steps in the order done, one of a name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Steps(pub Vec<Step>);

impl Steps {
    /// Adds time to a step, and memory where it is the most so far.
    pub fn add(&mut self, name: &str, ms: f64, bytes: u64) {
        match self.0.iter_mut().find(|step| step.name == name) {
            Some(step) => {
                step.ms += ms;
                step.bytes = step.bytes.max(bytes);
            }
            None => self.0.push(Step { name: name.to_owned(), ms, bytes }),
        }
    }

    /// [`Self::add`] of the time since `start`.
    pub fn add_since(&mut self, name: &str, start: Instant, bytes: usize) {
        self.add(name, start.elapsed().as_secs_f64() * 1e3, bytes as u64);
    }

    /// Takes time from a step, to be given to another: not more than it has.
    pub fn take(&mut self, name: &str, ms: f64) {
        if let Some(step) = self.0.iter_mut().find(|step| step.name == name) {
            step.ms = (step.ms - ms).max(0.0);
        }
    }

    /// These steps and then others.
    pub fn followed_by(&self, others: &Self) -> Self {
        let mut all = self.clone();
        others.0.iter().for_each(|step| all.add(&step.name, step.ms, step.bytes));
        all
    }

    /// Time of all steps, ms.
    pub fn total_ms(&self) -> f64 {
        self.0.iter().map(|step| step.ms).sum()
    }
}

/// How many there were of something.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Count {
    /// In all.
    Whole(u64),
    /// For each of something else, in the mean.
    Mean(f64),
}

impl Count {
    /// In all; 0 of a mean.
    pub fn whole(&self) -> u64 {
        match self {
            Self::Whole(count) => *count,
            Self::Mean(_) => 0,
        }
    }

    /// As a number.
    pub fn value(&self) -> f64 {
        match self {
            Self::Whole(count) => *count as f64,
            Self::Mean(mean) => *mean,
        }
    }
}

/// What a command did and what it cost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA_VERSION`].
    pub schema_version: u32,
    /// In the order done.
    pub steps: Steps,
    /// From the report's making to its end, ms.
    pub total_ms: f64,
    /// Most memory this process ever held, bytes; `None` where the system does not say.
    pub peak_bytes: Option<u64>,
    /// What computed.
    pub device: String,
    /// Counts by name: triangles, draw calls, …
    pub counts: BTreeMap<String, Count>,
    /// Errors against a reference by name, where one was asked for.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub error: BTreeMap<String, f64>,
}

impl Report {
    /// Of steps that are done and took `total_ms` together.
    pub fn new(device: impl Into<String>, steps: Steps, total_ms: f64) -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            steps,
            total_ms,
            peak_bytes: peak_bytes(),
            device: device.into(),
            counts: BTreeMap::new(),
            error: BTreeMap::new(),
        }
    }

    /// Adds to a count.
    pub fn count(&mut self, name: &str, more: u64) {
        let count = self.counts.entry(name.to_owned()).or_insert(Count::Whole(0));
        *count = Count::Whole(count.whole() + more);
    }
}

/// A report in the making.
#[derive(Debug)]
pub struct Recorder {
    start: Instant,
    report: Report,
}

impl Recorder {
    /// Starts the clock.
    pub fn new(device: impl Into<String>) -> Self {
        Self { start: Instant::now(), report: Report::new(device, Steps::default(), 0.0) }
    }

    /// Does `work` as the step `name`; `bytes` says what its result holds.
    pub fn step<T>(&mut self, name: &str, work: impl FnOnce() -> T, bytes: impl FnOnce(&T) -> u64) -> T {
        let start = Instant::now();
        let done = work();
        self.row(name, start.elapsed().as_secs_f64() * 1e3, bytes(&done));
        done
    }

    /// Adds a step that was timed elsewhere; a step of the same name is added to.
    pub fn row(&mut self, name: &str, ms: f64, bytes: u64) {
        self.report.steps.add(name, ms, bytes);
    }

    /// Adds to a count.
    pub fn count(&mut self, name: &str, more: u64) {
        self.report.count(name, more);
    }

    /// Sets how many there are for each of something, in the mean.
    pub fn mean(&mut self, name: &str, mean: f64) {
        self.report.counts.insert(name.to_owned(), Count::Mean(mean));
    }

    /// Sets an error against a reference.
    pub fn error(&mut self, name: &str, value: f64) {
        self.report.error.insert(name.to_owned(), value);
    }

    /// Names what computed.
    pub fn device(&mut self, device: impl Into<String>) {
        self.report.device = device.into();
    }

    /// Stops the clock.
    pub fn finish(mut self) -> Report {
        self.report.total_ms = self.start.elapsed().as_secs_f64() * 1e3;
        self.report.peak_bytes = peak_bytes();
        self.report
    }
}

/// Most memory this process ever held (`VmHWM` of Linux), bytes.
pub fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
