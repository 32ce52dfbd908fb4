//! How runs end that something goes wrong in.

use super::{batch, furrier, json, outputs, said, single, small, succeeds, triangle, triangles};
use crate::common::shared;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn a_broken_asset_is_named_and_the_rest_is_baked() {
    let folder = triangles(3);
    let (junit, report) = (folder.path().join("junit.xml"), folder.path().join("report"));
    std::fs::write(folder.path().join("broken.glb"), b"glTF").unwrap();
    std::fs::write(folder.path().join("no<faces>.obj"), "v 0 0 0\n").unwrap();
    let mut command = batch(folder.path(), &[]);
    command.arg("--junit").arg(&junit).arg("--report").arg(&report);
    let (code, value) = json(&mut command);
    assert_eq!((code, &value["baked"]), (6, &json!(3)), "{value}");
    let failed = value["failed"].as_array().unwrap();
    assert_eq!(
        failed.iter().map(|f| f["input"].as_str().unwrap()).collect::<Vec<_>>(),
        ["broken.glb", "no<faces>.obj"]
    );
    assert!(failed[1]["error"].as_str().unwrap().contains("the OBJ has no faces"), "{value}");
    let xml = std::fs::read_to_string(&junit).unwrap();
    assert!(
        xml.contains("failures=\"2\"") && xml.contains("no&lt;faces&gt;.obj") && xml.contains("the OBJ has no faces"),
        "{xml}"
    );
    let page = std::fs::read_to_string(report.join("index.html")).unwrap();
    assert!(
        page.contains("no&lt;faces&gt;.obj") && page.contains("the OBJ has no faces") && !page.contains("no<faces>"),
        "{page}"
    );
    // Again: what failed is tried again, what is baked is not.
    let ended = batch(folder.path(), &["--jsonl"]).output().unwrap();
    assert_eq!(ended.status.code(), Some(6));
    let events: Vec<Value> =
        String::from_utf8(ended.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(events[0]["event"], "start");
    let end = events.last().unwrap();
    assert_eq!((&end["event"], &end["up_to_date"], &end["failed"]), (&json!("finish"), &json!(3), &json!(2)));
    let faults = events.iter().filter(|e| e["event"] == "end" && e["fault"].is_object()).count();
    assert_eq!(faults, 2, "{events:?}");
    let table = said(&batch(folder.path(), &[]).output().unwrap());
    assert!(table.contains("broken.glb: ") && table.contains("no<faces>.obj: the OBJ has no faces"), "{table}");
}

#[test]
fn the_first_failure_is_the_last_where_that_is_asked_for() {
    let folder = triangles(5);
    // It is begun first because it is the largest, and fails at its end.
    let faces = "f 1 2 3\n".repeat(5000);
    std::fs::write(folder.path().join("large.obj"), format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}f 1 2 9\n")).unwrap();
    let (code, value) = json(&mut batch(folder.path(), &["--fail-fast"]));
    assert_eq!((code, value["failed"].as_array().unwrap().len()), (6, 1), "{value}");
    assert!(value["not_run"].as_u64().unwrap() >= 3, "{value}");
    let (code, value) = json(&mut batch(folder.path(), &[]));
    assert_eq!((code, &value["not_run"], value["failed"].as_array().unwrap().len()), (6, &json!(0), 1), "{value}");
}

#[test]
fn six_hard_files_fail_among_others() {
    let Some(shared) = shared() else { return };
    let folder = triangles(2);
    let hard = [
        "bad_json.glb",
        "huge_count.glb",
        "bad_numbers.obj",
        "buffer_too_short.glb",
        "index_out_of_range.glb",
        "truncated.glb",
    ];
    for name in hard {
        std::fs::copy(shared.join("hard").join(name), folder.path().join(name)).unwrap();
    }
    let out = tempfile::tempdir().unwrap();
    let (junit, report) = (out.path().join("junit.xml"), out.path().join("report"));
    let mut command = batch(folder.path(), &[]);
    command.arg("--junit").arg(&junit).arg("--report").arg(&report);
    let (code, value) = json(&mut command);
    let failed = value["failed"].as_array().unwrap();
    let reasons: BTreeMap<&str, &str> =
        failed.iter().map(|f| (f["input"].as_str().unwrap(), f["error"].as_str().unwrap())).collect();
    assert_eq!((code, &value["baked"]), (6, &json!(2)), "{value}");
    assert_eq!(reasons.keys().copied().collect::<BTreeSet<_>>(), BTreeSet::from(hard), "{value}");
    // Each is named with its reason wherever a run tells of itself.
    let ended = batch(folder.path(), &["--jsonl"]).output().unwrap();
    let lines = String::from_utf8(ended.stdout).unwrap();
    let told: BTreeMap<String, String> = lines
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap())
        .filter(|event| event["event"] == "end" && event["fault"].is_object())
        .map(|event| [&event["input"], &event["fault"]["reason"]].map(|v| v.as_str().unwrap().to_owned()).into())
        .collect();
    let table = said(&batch(folder.path(), &[]).output().unwrap());
    let [xml, page] = [junit, report.join("index.html")].map(|file| std::fs::read_to_string(file).unwrap());
    let plain = |text: &str| {
        let signs = [("&quot;", "\""), ("&#34;", "\""), ("&apos;", "'"), ("&#39;", "'"), ("&lt;", "<"), ("&gt;", ">")];
        signs.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to)).replace("&amp;", "&")
    };
    for (name, reason) in reasons {
        assert_eq!(told.get(name).map(String::as_str), Some(reason), "events: {lines}");
        assert!(table.contains(&format!("{name}: {reason}")), "table: {name}: {reason}\n{table}");
        for (place, text) in [("JUnit", plain(&xml)), ("page", plain(&page))] {
            assert!(text.contains(name) && text.contains(reason), "{place}: {name}: {reason}\n{text}");
        }
    }
}

#[test]
fn any_order_and_number_of_threads_give_the_same_bytes() {
    let folder = triangles(4);
    let out = |threads: &str| {
        let out = tempfile::tempdir().unwrap();
        let mut command = furrier(&["batch"]);
        command
            .arg(folder.path())
            .args(small())
            .args(["--threads", threads, "--memory", "100MB", "-o"])
            .arg(out.path());
        succeeds(&mut command);
        outputs(out.path())
    };
    let one = out("1");
    assert_eq!(one.len(), 4);
    assert_eq!(one, out("5"));
}

#[cfg(unix)]
#[test]
fn a_killed_run_goes_on_and_leaves_nothing_half_written() {
    let folder = triangles(6);
    let furry = folder.path().join("furry");
    let inputs = ["t0.obj", "t1.obj", "sub/t2.obj", "t3.obj", "t4.obj", "sub/t5.obj"];
    let expected = single(folder.path(), &inputs);
    let mut said_so = 0;
    for kill in 0..4_u64 {
        let mut child =
            batch(folder.path(), &["--jsonl"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // After so many events, wherever that is.
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let seen = lines.take(3 + 7 * kill as usize).map(Result::unwrap).collect::<Vec<_>>();
        said_so += seen.iter().filter(|line| line.contains("the last run was stopped while it baked")).count();
        child.kill().unwrap();
        child.wait().unwrap();
        for (name, bytes) in outputs(&furry) {
            let part = name.file_name().unwrap().to_string_lossy().starts_with(".furrier-");
            assert!(part || bytes == expected[&name], "{} is neither whole nor absent", name.display());
        }
    }
    let all = succeeds(&mut batch(folder.path(), &[]));
    assert!(said_so > 0 || all.contains("the last run was stopped"), "no killed run was noticed: {all}");
    assert_eq!(outputs(&furry), expected);
    let left: Vec<_> = walkdir::WalkDir::new(&furry)
        .into_iter()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name.contains("journal") || name.ends_with(".part"))
        .collect();
    assert_eq!(left, Vec::<String>::new());
}

#[test]
fn two_runs_at_once_end_well() {
    let folder = triangles(4);
    let spawn = || batch(folder.path(), &[]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (a, b) = (spawn(), spawn());
    for child in [a, b] {
        let ended = child.wait_with_output().unwrap();
        assert!(ended.status.success(), "{}", said(&ended));
    }
    let expected = single(folder.path(), &["t0.obj", "t1.obj", "sub/t2.obj", "t3.obj"]);
    assert_eq!(outputs(&folder.path().join("furry")), expected);
    assert_eq!(json(&mut batch(folder.path(), &[])).1["up_to_date"], 4);
}

/// Writes a mesh anew whenever a bake of it comes to the step `write`, so often, and gives what the run said at its end.
fn changed_while_baked(folder: &Path, times: u32) -> Value {
    let mut child = batch(folder, &["--jsonl"]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut changes = 0;
    let mut last = Value::Null;
    for line in BufReader::new(child.stdout.take().unwrap()).lines() {
        let event: Value = serde_json::from_str(&line.unwrap()).unwrap();
        if event["step"] == "weld" && changes < times {
            changes += 1;
            std::fs::write(folder.join("t0.obj"), triangle(100 + changes)).unwrap();
        }
        if event["event"] == "end" {
            last = event;
        }
    }
    child.wait().unwrap();
    last
}

#[test]
fn an_asset_that_changes_while_it_is_read_is_baked_again_or_given_up() {
    let folder = triangles(1);
    let end = changed_while_baked(folder.path(), 1);
    assert_eq!(end["status"], "baked", "{end}");
    assert_eq!(outputs(&folder.path().join("furry")), single(folder.path(), &["t0.obj"]));
    assert_eq!(json(&mut batch(folder.path(), &[])).1["up_to_date"], 1);
    std::fs::write(folder.path().join("t0.obj"), triangle(0)).unwrap();
    let end = changed_while_baked(folder.path(), 100);
    assert_eq!(end["status"], "failed", "{end}");
    assert!(end["fault"]["reason"].as_str().unwrap().contains("changes while it is read"), "{end}");
    assert!(outputs(&folder.path().join("furry")).is_empty(), "an output of nobody knows what");
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_in_failures_that_name_it() {
    let folder = triangles(2);
    succeeds(&mut batch(folder.path(), &[]));
    let before = outputs(&folder.path().join("furry"));
    let full = |arguments: &[&str]| {
        let mut command = std::process::Command::new("sh");
        // A limit on file size stands for the disk.
        command.args(["-c", "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\""]).arg(crate::common::furrier_path());
        command.args(arguments);
        command
    };
    let path = folder.path().display().to_string();
    let arguments: Vec<&str> = [&["batch", &path, "--set", "guard.taper=0.4"][..], &small()].concat();
    let (code, value) = json(&mut full(&arguments));
    assert_eq!((code, value["failed"].as_array().unwrap().len()), (6, 2), "{value}");
    assert!(value["failed"][0]["error"].as_str().unwrap().contains("cannot be written"), "{value}");
    assert_eq!(outputs(&folder.path().join("furry")), before, "what was there is still there");
    // On a farm it is the machine that failed, not the asset.
    let plan = folder.path().join("plan.jsonl");
    let mut command = furrier(&["batch", "plan"]);
    succeeds(command.arg(folder.path()).args(small()).args(["--set", "guard.taper=0.4", "--write"]).arg(&plan));
    let started = Instant::now();
    let ended = full(&["batch", "run", &plan.display().to_string(), "--items", "0-1"]).output().unwrap();
    assert_eq!(ended.status.code(), Some(75), "{}", said(&ended));
    assert!(started.elapsed() < Duration::from_secs(60));
    let merged = furrier(&["batch", "merge"]).arg(&plan).output().unwrap();
    assert_eq!(merged.status.code(), Some(6), "{}", said(&merged));
    assert!(said(&merged).contains("not run"), "{}", said(&merged));
}
