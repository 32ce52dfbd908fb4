//! A library that is watched.

use super::{batch, outputs, single, triangle, triangles};
use std::io::{BufRead, BufReader};
use std::process::Stdio;
use std::sync::mpsc;
use std::time::Duration;

#[test]
fn what_changes_is_baked_again_and_nothing_else() {
    let folder = triangles(2);
    let mut child = batch(folder.path(), &["--watch"]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let (says, heard) = mpsc::channel();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let reader = std::thread::spawn(move || lines.map_while(Result::ok).for_each(|line| drop(says.send(line))));
    // Lines until it waits; a run that never does is a failure.
    let until_waiting = || {
        let mut seen = Vec::new();
        loop {
            let line =
                heard.recv_timeout(Duration::from_secs(120)).unwrap_or_else(|_| panic!("it does not wait: {seen:?}"));
            if line.contains("waiting for changes") {
                return seen;
            }
            seen.push(line);
        }
    };
    let baked = |lines: &[String]| lines.iter().filter(|line| line.contains("baked in")).count();
    assert_eq!(baked(&until_waiting()), 2);
    std::fs::write(folder.path().join("t1.obj"), triangle(9)).unwrap();
    let seen = until_waiting();
    assert!(baked(&seen) == 1 && seen.iter().any(|line| line.contains("t1.obj: baked")), "{seen:?}");
    assert_eq!(outputs(&folder.path().join("furry")), single(folder.path(), &["t0.obj", "t1.obj"]));
    // What it wrote itself is no change, and what goes wrong does not end it.
    std::fs::write(folder.path().join("t1.obj"), "v 0 0 0\n").unwrap();
    let seen = until_waiting();
    assert!(seen.iter().any(|line| line.contains("t1.obj: failed")), "{seen:?}");
    std::fs::write(folder.path().join("sub/t5.obj"), triangle(5)).unwrap();
    let seen = until_waiting();
    assert!(seen.iter().any(|line| line.contains("t5.obj: baked")), "{seen:?}");
    child.kill().unwrap();
    child.wait().unwrap();
    reader.join().unwrap();
}
