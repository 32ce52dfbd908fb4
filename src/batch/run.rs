//! Works off a plan: looks at every asset, bakes what is out of date, several at once.

use super::event::{Event, Listen};
use super::item::bake_entry;
use super::journal::Journal;
use super::key::Key;
use super::outcome::{Fault, Outcome, Status, Totals};
use super::plan::{Entry, Plan};
use super::record::Record;
use super::schedule::{Begun, Schedule};
use super::standing::{Standing, Why, standing};
use crate::cache::Store;
use crate::error::{Error, Result};
use rayon::prelude::*;
use std::path::Path;
use std::sync::mpsc;

/// What a run may take, and when it stops.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Threads of all bakes together.
    pub threads: usize,
    /// Memory of all bakes together, bytes; none where it is not bounded.
    pub memory_bytes: Option<u64>,
    /// Whether the first failure is the last.
    pub fail_fast: bool,
    /// What keeps finished stages for later bakes, and gives those of earlier ones.
    pub cache: Option<Store>,
}

/// How entries stand, in their order, with the keys of the plan's recipes. A failure is that of one asset.
pub struct Looked {
    /// Of the plan's recipes.
    pub keys: Vec<Key>,
    /// Of the entries.
    pub standings: Vec<Result<Standing>>,
}

/// Looks at entries.
///
/// # Errors
/// Where a recipe's presets cannot be read.
pub fn look(plan: &Plan, entries: &[Entry], threads: usize) -> Result<Looked> {
    let keys = plan.recipes.iter().map(Key::of).collect::<Result<Vec<Key>>>()?;
    let records = plan.records();
    let of = |entry: &Entry| standing(&records, &plan.input(entry), &plan.output(entry), &keys[entry.recipe]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let all = || entries.par_iter().map(of).collect();
    let standings = pool.map_or_else(|_| all(), |pool| pool.install(all));
    Ok(Looked { keys, standings })
}

/// Bakes what is out of date among entries of a plan, and gives what came of each in their order.
///
/// # Errors
/// Where nothing can be begun: a preset cannot be read, or the library's folder not be written. What one asset ends with is in its
/// outcome.
pub fn run(plan: &Plan, entries: &[Entry], limits: &Limits, listen: &mut Listen<'_>) -> Result<Vec<Outcome>> {
    let (journal, found) = Journal::open(&plan.state())?;
    plan.records().create()?;
    for output in &found.unfinished {
        listen(Event::Note(&format!(
            "the last run was stopped while it baked {}; it goes on from there",
            output.display()
        )));
    }
    if found.others > 0 {
        listen(Event::Note(
            "another run is at work on this library; what both bake is baked twice, with the same result",
        ));
    }
    let Looked { keys, standings } = look(plan, entries, limits.threads)?;
    let mut outcomes: Vec<Outcome> = Vec::with_capacity(entries.len());
    let mut due = Vec::new();
    for (place, (entry, standing)) in entries.iter().zip(standings).enumerate() {
        let outcome = blank(entry);
        outcomes.push(match standing {
            Ok(Standing::UpToDate(record)) => filled(outcome, Status::UpToDate, *record),
            Ok(Standing::Due(why)) => {
                due.push((place, plan.cost(entry)));
                Outcome { why: Outcome::reasons(&why), ..outcome }
            }
            Err(error) => Outcome { status: Status::Failed, fault: Some(Fault::from(&error)), ..outcome },
        });
    }
    let seconds = due.iter().map(|(_, cost)| cost.seconds).sum();
    listen(Event::Start { items: entries.len(), due: due.len(), seconds });
    for outcome in outcomes.iter().filter(|outcome| outcome.status != Status::NotRun) {
        listen(Event::End(outcome));
    }
    let stopped = limits.fail_fast && outcomes.iter().any(|outcome| outcome.status == Status::Failed);
    let due = if stopped { Vec::new() } else { due };
    Crew { plan, entries, keys: &keys, limits, journal }.work(due, &mut outcomes, listen)?;
    for outcome in outcomes.iter().filter(|outcome| outcome.status == Status::NotRun) {
        listen(Event::End(outcome));
    }
    listen(Event::Finish(Totals::of(&outcomes)));
    Ok(outcomes)
}

/// What a worker says.
enum Said {
    Step(usize, &'static str),
    Done(usize, Begun, Box<Result<Record>>),
}

/// Works off what is due.
struct Crew<'a> {
    plan: &'a Plan,
    entries: &'a [Entry],
    keys: &'a [Key],
    limits: &'a Limits,
    journal: Journal,
}

impl Crew<'_> {
    fn work(
        mut self,
        due: Vec<(usize, super::estimate::Cost)>,
        outcomes: &mut [Outcome],
        listen: &mut Listen<'_>,
    ) -> Result<()> {
        let memory = self.limits.memory_bytes;
        let mut schedule = Schedule::new(due, self.limits.threads, memory);
        let (says, heard) = mpsc::channel::<Said>();
        let (plan, entries, keys) = (self.plan, self.entries, self.keys);
        std::thread::scope(|scope| {
            let mut running = 0;
            loop {
                while let Some(begun) = schedule.begin() {
                    let entry = &entries[begun.item];
                    if begun.over {
                        listen(Event::Note(&over_memory(&entry.input, &begun, memory)));
                    }
                    self.journal.begin(&plan.output(entry))?;
                    listen(Event::Begin { entry, seconds: begun.cost.seconds, threads: begun.threads });
                    let says = says.clone();
                    running += 1;
                    scope.spawn(move || {
                        let step = |name| drop(says.send(Said::Step(entry.item, name)));
                        let baked = bake_entry(
                            plan,
                            entry,
                            &keys[entry.recipe],
                            (begun.threads, self.limits.cache.clone()),
                            &step,
                        );
                        let _ = says.send(Said::Done(begun.item, begun, Box::new(baked)));
                    });
                }
                if running == 0 {
                    return Ok(());
                }
                match heard.recv() {
                    Ok(Said::Step(item, step)) => listen(Event::Step { item, step }),
                    Ok(Said::Done(place, begun, baked)) => {
                        running -= 1;
                        schedule.end(&begun, memory);
                        self.journal.end(&plan.output(&entries[place]))?;
                        let outcome = &mut outcomes[place];
                        let failed = baked.is_err();
                        *outcome = ended(outcome.clone(), *baked);
                        listen(Event::End(outcome));
                        if failed && self.limits.fail_fast {
                            schedule.stop();
                        }
                    }
                    Err(_) => return Ok(()),
                }
            }
        })
    }
}

fn over_memory(input: &Path, begun: &Begun, memory: Option<u64>) -> String {
    format!(
        "{} is expected to take {:.0} MB, more than the {:.0} MB of `memory`; it is baked alone",
        input.display(),
        begun.cost.bytes as f64 / 1e6,
        memory.unwrap_or(0) as f64 / 1e6
    )
}

/// Of an entry that nothing is known of.
pub fn blank(entry: &Entry) -> Outcome {
    Outcome {
        item: entry.item,
        input: entry.input.clone(),
        output: entry.output.clone(),
        status: Status::NotRun,
        why: Vec::new(),
        fault: None,
        seconds: 0.0,
        threads: 0,
        bytes: 0,
        digest: String::new(),
        warnings: Vec::new(),
    }
}

fn filled(outcome: Outcome, status: Status, record: Record) -> Outcome {
    let Record { seconds, threads, bytes, warnings, .. } = record;
    Outcome { status, seconds, threads, bytes, warnings, digest: record.output.to_string(), ..outcome }
}

fn ended(outcome: Outcome, baked: Result<Record>) -> Outcome {
    match baked {
        Ok(record) => filled(outcome, Status::Baked, record),
        Err(error) => Outcome { status: Status::Failed, fault: Some(Fault::from(&error)), ..outcome },
    }
}

/// What would be done with an entry, for a run that does nothing.
pub fn foretold(entry: &Entry, standing: &std::result::Result<Standing, Error>) -> Outcome {
    let outcome = blank(entry);
    match standing {
        Ok(Standing::UpToDate(record)) => filled(outcome, Status::UpToDate, (**record).clone()),
        Ok(Standing::Due(why)) => Outcome { why: why.iter().map(Why::to_string).collect(), ..outcome },
        Err(error) => Outcome { status: Status::Failed, fault: Some(Fault::from(error)), ..outcome },
    }
}
