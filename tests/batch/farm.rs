//! Plans worked off in pieces, as the engines of farms do it.

use super::{furrier, json, outputs, said, single, small, succeeds, triangles};
use serde_json::Value;
use std::path::{Path, PathBuf};

const INPUTS: [&str; 5] = ["t0.obj", "t1.obj", "sub/t2.obj", "t3.obj", "t4.obj"];

/// The plan of a folder.
fn plan(folder: &Path) -> PathBuf {
    let path = folder.join("plan.jsonl");
    succeeds(furrier(&["batch", "plan"]).arg(folder).args(small()).arg("--write").arg(&path));
    path
}

fn run(plan: &Path, items: &str) -> std::process::Output {
    furrier(&["batch", "run"]).arg(plan).args(["--items", items, "--threads", "2"]).output().unwrap()
}

#[test]
fn any_chunks_give_the_same_bytes_and_a_merge_the_verdict() {
    let folder = triangles(5);
    std::fs::write(folder.path().join("broken.glb"), b"glTF").unwrap();
    let plan = plan(folder.path());
    let merged = |code: i32| {
        let (found, value) = json(furrier(&["batch", "merge"]).arg(&plan));
        assert_eq!(found, code, "{value}");
        value
    };
    assert_eq!(merged(6)["not_run"], 6);
    // Sorted by name: broken.glb is the first. A bad asset is data.
    for items in ["3-5", "0-1", "2"] {
        let ended = run(&plan, items);
        assert!(ended.status.success(), "{}", said(&ended));
    }
    let value = merged(6);
    assert_eq!((&value["baked"], &value["not_run"]), (&Value::from(5), &Value::from(0)), "{value}");
    assert_eq!(value["failed"][0]["input"], "broken.glb");
    assert_eq!(outputs(&folder.path().join("furry")), single(folder.path(), &INPUTS));
    // A range that overlaps, as after a retry, changes nothing.
    assert!(run(&plan, "0-5").status.success());
    assert_eq!(merged(6), value);
}

#[test]
fn a_library_that_is_not_there_is_the_machines_fault() {
    let folder = triangles(1);
    let plan = plan(folder.path());
    let mut command = furrier(&["batch", "run"]);
    let ended = command.arg(&plan).args(["--items", "0", "--root"]).arg(folder.path().join("none")).output().unwrap();
    assert_eq!(ended.status.code(), Some(75), "{}", said(&ended));
    // Mounted elsewhere, it is the same.
    let elsewhere = folder.path().with_extension("elsewhere");
    std::fs::rename(folder.path(), &elsewhere).unwrap();
    let plan = elsewhere.join("plan.jsonl");
    let mut command = furrier(&["batch", "run"]);
    succeeds(command.arg(&plan).args(["--items", "0", "--root"]).arg(&elsewhere));
    std::fs::rename(&elsewhere, folder.path()).unwrap();
}

#[test]
fn the_openjd_template_says_what_is_run() {
    let folder = triangles(3);
    let (plan, job) = (plan(folder.path()), folder.path().join("job.json"));
    succeeds(furrier(&["batch", "emit", "openjd"]).arg(&plan).arg("-o").arg(&job).args(["--chunk", "2"]));
    let job: Value = serde_json::from_slice(&std::fs::read(&job).unwrap()).unwrap();
    let items = &job["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
    assert_eq!((&items["type"], &items["range"]), (&Value::from("CHUNK[INT]"), &Value::from("0-2")));
    assert_eq!(items["chunks"]["defaultTaskCount"], 2);
    assert_eq!(job["extensions"][0], "TASK_CHUNKING");
    // Relative to the template, as the specification has it.
    assert_eq!(job["parameterDefinitions"][0]["default"], "plan.jsonl");
    assert_eq!(job["steps"][1]["dependencies"][0]["dependsOn"], "Bake");
    let mut command = furrier(&["batch", "run"]);
    let lines = command.arg(&plan).args(["--items", "0-2", "--progress", "openjd"]).output().unwrap().stdout;
    let lines = String::from_utf8(lines).unwrap();
    assert!(lines.starts_with("openjd_status: 3 of 3 assets") && lines.contains("openjd_progress: 100.0"), "{lines}");
}

/// A stand-in for Slurm's `sbatch`: it runs each task of an array, and then what depends on it, at once and here. The first try of the
/// second task's first worker is killed.
const SBATCH: &str = r#"#!/bin/sh
array=
while [ $# -gt 0 ]; do
  case $1 in
    --array=*) array=${1#--array=}; array=${array%%%*};;
    --dependency=afterany:*) ;;
    --parsable|--wait) ;;
    *) break;;
  esac
  shift
done
if [ -n "$array" ]; then
  for task in $(seq "${array%-*}" "${array#*-}"); do
    SLURM_ARRAY_TASK_ID=$task sh "$@" >>"$LOG" 2>&1 || echo "task $task: $?" >>"$LOG"
  done
  echo 1
else
  sh "$@"
fi
"#;

/// A stand-in for the program, which is killed the first time it is asked for item 2.
const KILLED: &str = r#"#!/bin/sh
case "$*" in *"--items 2-3"*) [ -e "$LOG.killed" ] || { : >"$LOG.killed"; kill -9 $$; };; esac
exec "$REAL" "$@"
"#;

#[cfg(unix)]
#[test]
fn the_slurm_script_runs_its_tasks_and_a_worker_that_is_killed_is_tried_again() {
    use std::os::unix::fs::PermissionsExt;
    let folder = triangles(5);
    let (plan, job) = (plan(folder.path()), folder.path().join("it's a job.sh"));
    let bin = tempfile::tempdir().unwrap();
    for (name, text) in [("sbatch", SBATCH), ("furrier", KILLED)] {
        let path = bin.path().join(name);
        std::fs::write(&path, text).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    let mut command = furrier(&["batch", "emit", "slurm"]);
    succeeds(command.arg(&plan).arg("-o").arg(&job).args(["--chunk", "2", "--at-once", "2"]));
    let path = format!("{}:{}", bin.path().display(), std::env::var("PATH").unwrap());
    let log = bin.path().join("log");
    let mut command = std::process::Command::new("sh");
    command.arg(&job).arg("--wait").env("PATH", path).env("LOG", &log).env("REAL", crate::common::furrier_path());
    let ended = command.output().unwrap();
    let log = std::fs::read_to_string(&log).unwrap();
    assert!(ended.status.success(), "{}\n{log}", said(&ended));
    assert!(bin.path().join("log.killed").is_file() && !log.contains("task 1:"), "{log}");
    assert_eq!(outputs(&folder.path().join("furry")), single(folder.path(), &INPUTS));
    let (code, value) = json(furrier(&["batch", "merge"]).arg(&plan));
    assert_eq!((code, value["baked"].as_u64()), (0, Some(5)), "{value}");
}
