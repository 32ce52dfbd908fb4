//! Files mutated at random, in a process of their own: no panic, no case over 20 s, no 2 GiB of address space, and no output
//! behind an error. Each case is told by its number: the same number, the same bytes.
//!
//! `FURRIER_FUZZ_SECONDS=300 cargo test --release fuzz` tries new numbers for that long per target.

mod cases;
mod mutate;
mod targets;

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use targets::Target;

/// No case may compute for longer.
const LONGEST: Duration = Duration::from_secs(20);
/// On a machine that is busy otherwise a case may have to wait, but not for longer than this.
const LONGEST_WAIT: Duration = Duration::from_secs(300);
/// No process may take more address space, KiB.
const MOST_MEMORY_KIB: u32 = 2 << 20;

/// Names the target, the first case and how many to the process that runs them.
const ORDER: &str = "FURRIER_FUZZ_ORDER";

/// What a process of cases came to.
struct Ended {
    /// Cases tried.
    tried: u64,
    /// Of which were accepted.
    accepted: u64,
    /// The last case that began and what happened, where one did not end well.
    fault: Option<(u64, String)>,
}

/// Runs the cases `first` to `first + count` of a target in a process of their own, none for longer than `longest`.
fn run(target: &str, first: u64, count: u64, longest: Duration) -> Ended {
    let this = std::env::current_exe().expect("this program");
    let script = format!("ulimit -v {MOST_MEMORY_KIB}; exec \"$0\" --exact fuzz::the_process_of_cases --nocapture");
    let mut child = Command::new("bash")
        .args(["-c", &script])
        .arg(this)
        .env(ORDER, format!("{target} {first} {count}"))
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let (send, lines) = channel();
    let out = BufReader::new(child.stdout.take().expect("its output"));
    let reader = std::thread::spawn(move || out.lines().map_while(Result::ok).for_each(|line| drop(send.send(line))));
    let mut errors = child.stderr.take().expect("its errors");
    let teller = std::thread::spawn(move || {
        let mut text = String::new();
        errors.read_to_string(&mut text).map(|_| text).unwrap_or_default()
    });
    let (mut tried, mut accepted, mut last, mut hung) = (0, 0, first, false);
    let mut began = (Instant::now(), Duration::ZERO);
    loop {
        match lines.recv_timeout(Duration::from_secs(1)) {
            Ok(line) => {
                if let Some(case) = line.strip_prefix("case ").and_then(|text| text.parse().ok()) {
                    (last, tried) = (case, tried + 1);
                    began = (Instant::now(), computed(child.id()).unwrap_or_default());
                }
                accepted += u64::from(line == "accepted");
            }
            Err(RecvTimeoutError::Timeout) => {
                let waited = began.0.elapsed();
                let busy = computed(child.id()).map_or(waited, |now| now.saturating_sub(began.1));
                if busy < longest && waited < LONGEST_WAIT {
                    continue;
                }
                hung = true;
                child.kill().expect("it can be ended");
                break;
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let status = child.wait().expect("it ends");
    reader.join().expect("its output was read");
    let text = teller.join().expect("its errors were read");
    let fault = match (hung, status.success()) {
        (true, _) => Some(format!("takes more than {} s", longest.as_secs())),
        (_, false) => Some(format!("{status}: {}", text.lines().take(12).collect::<Vec<_>>().join(" | "))),
        _ => None,
    };
    Ended { tried, accepted, fault: fault.map(|fault| (last, fault)) }
}

/// How long a process has computed, where the system tells.
fn computed(process: u32) -> Option<Duration> {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // Behind the name, which may hold anything: user and system time, in hundredths of a second.
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(Duration::from_millis(10 * ticks))
}

/// The process that [`run`] starts; without an order it has nothing to do.
#[test]
fn the_process_of_cases() {
    let Ok(order) = std::env::var(ORDER) else { return };
    let words: Vec<&str> = order.split(' ').collect();
    let target = Target::named(words[0]);
    let (first, count): (u64, u64) = (words[1].parse().unwrap(), words[2].parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    for case in first..first + count {
        println!("\ncase {case}");
        if target.try_case(case, folder.path()) {
            println!("accepted");
        }
    }
}

/// Tries `count` cases of a target, or as many as fit the time that is asked for.
fn try_all(name: &str, count: u64) {
    let seconds = std::env::var("FURRIER_FUZZ_SECONDS").ok().map(|text| text.parse().expect("a number of seconds"));
    let longest = Duration::from_secs(seconds.unwrap_or(0));
    let (start, mut first, mut accepted, mut faults) = (Instant::now(), 0, 0, Vec::new());
    loop {
        let ended = run(name, first, if seconds.is_none() { count - first } else { count }, LONGEST);
        accepted += ended.accepted;
        first += ended.tried.max(1);
        faults.extend(ended.fault.map(|(case, fault)| format!("{name} {case}: {fault}")));
        // After a fault, the next process goes on behind it.
        if faults.len() > 5
            || (seconds.is_none() && first >= count)
            || (seconds.is_some() && start.elapsed() >= longest)
        {
            break;
        }
    }
    println!("{name}: {first} cases in {:.0} s, {accepted} accepted", start.elapsed().as_secs_f64());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // If nothing was accepted, nothing was tested beyond the first check.
    assert!(accepted > first / 100, "only {accepted} of {first} mutated files were accepted");
}

#[test]
fn glb() {
    try_all("glb", 300);
}

/// Cases that ended badly once: joints and nodes of no size or beyond all numbers, an animation without channels, to which a coat added
/// null, and views of a buffer without data that nothing decodes to.
#[test]
fn cases_of_glb_that_were_faults() {
    for case in [513, 2425, 3411, 4726, 5532, 5601, 6295, 6628, 7546, 9131] {
        let ended = run("glb", case, 1, LONGEST);
        assert_eq!((ended.tried, ended.fault), (1, None), "case {case}");
    }
}

#[test]
fn gltf() {
    try_all("gltf", 300);
}

#[test]
fn furry_glb() {
    try_all("furry", 150);
}

#[test]
fn obj_and_mtl() {
    try_all("obj", 500);
}

#[test]
fn preset_toml_and_settings() {
    try_all("preset", 1500);
}

#[test]
fn hdr() {
    try_all("hdr", 500);
}

#[test]
fn exr() {
    try_all("exr", 300);
}

#[test]
fn png_maps() {
    try_all("png", 300);
}

#[test]
fn an_exr_that_claims_a_huge_size_is_refused() {
    let mut bytes = cases::seeds("exr").swap_remove(0);
    let name = b"dataWindow\0box2i\0";
    let at = bytes.windows(name.len()).position(|window| window == name).expect("a data window") + name.len() + 4;
    bytes[at + 8..at + 12].copy_from_slice(&(1_i32 << 29).to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&(1_i32 << 20).to_le_bytes());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.exr");
    std::fs::write(&path, bytes).unwrap();
    let error = furrier::stage::environment::Environment::read(&path).unwrap_err();
    assert!(error.file.is_some() && error.found.is_some(), "{error}");
}

#[test]
fn a_file_that_is_named_and_not_there_is_told_with_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.gltf");
    let text = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "x", "byteLength": 4}]}"#;
    std::fs::write(&path, text).unwrap();
    let error = furrier::asset::load(&path.to_string_lossy()).unwrap_err();
    assert_eq!(error.field.as_deref(), Some("buffers[0].uri"), "{error}");
    assert!(error.file.is_some() && error.found.is_some(), "{error}");
}

#[test]
fn planted_faults_are_seen() {
    for (target, told) in
        [("panics", "planted"), ("grows", "memory"), ("leaves", "left behind"), ("hangs", "more than 2 s")]
    {
        let ended = run(target, 3, 1, Duration::from_secs(2));
        let (case, fault) = ended.fault.unwrap_or_else(|| panic!("{target} was not seen"));
        assert!(case == 3 && fault.contains(told), "{case}: {fault}");
    }
}
