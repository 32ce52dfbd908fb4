//! Baking through the real binary: what comes out, and what an interrupted or refused bake leaves behind.

use crate::common::{furrier_path, shared};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// No file may keep a bake busy for longer.
const LONGEST: Duration = Duration::from_secs(20);
/// No bake may take more address space, KiB; resident memory is always less.
const MOST_MEMORY_KIB: u32 = 2 << 20;

/// Options for a bake whose picture does not matter: few texels, few and short hairs.
#[rustfmt::skip]
pub const SMALL: &[&str] = &[
    "--threads", "4", "--layers", "4", "--texture-size", "16",
    "--set", "fins.texture_width=16", "--set", "fins.texture_height=16", "--set", "shells.tile_mm=8",
    "--set", "guard.density_per_cm2=40", "--set", "undercoat.density_per_cm2=200",
    "--set", "guard.length.mm=4", "--set", "undercoat.length.mm=3",
];

/// What a bake printed and how it ended; panics where it ran over a limit or died by a signal.
fn bake(input: &Path, output: &Path, options: &[&str]) -> Output {
    let script = format!("ulimit -v {MOST_MEMORY_KIB}; exec timeout --signal=KILL {} \"$@\"", LONGEST.as_secs());
    let ended = Command::new("bash")
        .args(["-c", &script, "bash"])
        .arg(furrier_path())
        .arg("bake")
        .arg(input)
        .arg("-o")
        .arg(output)
        .args(options)
        .output()
        .unwrap();
    let code = ended.status.code().unwrap_or(-1);
    assert!((0..=5).contains(&code), "{}: ended with {:?}\n{}", input.display(), ended.status, text(&ended.stderr));
    ended
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

/// Fails unless the output reads back as a coat of finite numbers with at least one triangle.
fn holds_a_coat(path: &Path) {
    let (_, coat) = furrier::asset::read_coat(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert!(coat.primitives.iter().any(|p| !p.triangles.is_empty()), "{}: no fur", path.display());
    for primitive in &coat.primitives {
        assert!(primitive.offset.iter().all(|o| o.is_finite()), "{}: an offset is not finite", path.display());
        assert!(primitive.uv.iter().all(|uv| uv.is_finite()), "{}: a UV is not finite", path.display());
    }
}

#[test]
fn every_real_file_bakes() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    for input in files_in(&shared.join("real")).iter().filter(|p| p.extension().is_some_and(|e| e != "png")) {
        let output = folder.path().join(input.file_name().unwrap()).with_extension("glb");
        let ended = bake(input, &output, SMALL);
        assert!(ended.status.success(), "{}:\n{}", input.display(), text(&ended.stderr));
        holds_a_coat(&output);
    }
}

#[test]
fn every_hard_case_ends_as_its_readme_says() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    let readme = std::fs::read_to_string(shared.join("hard/README.md")).unwrap();
    let rows = readme.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| ")?.split(" | ");
        Some((cells.next()?, cells.nth(1)?))
    });
    let rows: Vec<_> = rows.filter(|(file, _)| file.contains('.')).collect();
    assert!(rows.len() > 60, "only {} rows read", rows.len());
    let mut wrong = Vec::new();
    for (file, expected) in rows {
        let output = folder.path().join(file).with_extension("out.glb");
        let started = Instant::now();
        let ended = bake(&shared.join("hard").join(file), &output, SMALL);
        let (warned, said) = (text(&ended.stderr).contains("warning:"), text(&ended.stderr));
        if let Some(fault) = departure(expected, ended.status.success(), warned, output.exists(), &said) {
            wrong.push(format!("{file} ({expected}): {fault}, after {:?}\n{said}", started.elapsed()));
        } else if output.exists() {
            holds_a_coat(&output);
            std::fs::remove_file(&output).unwrap();
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(files_in(folder.path()), Vec::<PathBuf>::new(), "left behind");
}

/// How an ended bake departs from what the hard cases' README expects of it, if it does.
pub fn departure(expected: &str, baked: bool, warned: bool, output: bool, said: &str) -> Option<&'static str> {
    let (may_bake, may_reject) = match expected {
        "bake" | "bake + warn" => (true, false),
        "reject" => (false, true),
        "reject or repair" | "reject or bake" => (true, true),
        _ => return Some("the README expects something unknown"),
    };
    match baked {
        true if !may_bake => Some("baked"),
        true if !output => Some("claims success without an output"),
        true if expected == "bake + warn" && !warned => Some("baked without a warning"),
        false if !may_reject => Some("refused"),
        false if output => Some("refused, yet left an output"),
        false if !said.contains("file:") => Some("refused without naming the file"),
        _ => None,
    }
}

#[test]
fn one_thread_and_four_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |threads: &str| {
        let output = folder.path().join(format!("{threads}.glb"));
        let options = [&SMALL[2..], &["--threads", threads]].concat();
        let ended = bake(Path::new("sample:torus"), &output, &options);
        assert!(ended.status.success(), "{}", text(&ended.stderr));
        std::fs::read(output).unwrap()
    };
    let one = bytes("1");
    assert!(one == bytes("4"), "the files differ");
    assert!(one == bytes("1"), "two runs differ");
}

#[test]
fn another_seed_gives_other_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |seed: &str| {
        let output = folder.path().join(format!("{seed}.glb"));
        let options = [SMALL, &["--seed", seed]].concat();
        assert!(bake(Path::new("sample:plane"), &output, &options).status.success());
        std::fs::read(output).unwrap()
    };
    assert!(bytes("1") != bytes("2"));
}

#[test]
fn a_killed_bake_leaves_the_old_file_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.glb");
    let whole = folder.path().join("whole.glb");
    let started = Instant::now();
    assert!(bake(Path::new("sample:plane"), &whole, SMALL).status.success());
    let (takes, whole) = (started.elapsed(), std::fs::read(&whole).unwrap());
    for step in 0..12 {
        std::fs::write(&output, "old").unwrap();
        let mut child = Command::new(furrier_path())
            .args(["bake", "sample:plane", "-o"])
            .arg(&output)
            .args(SMALL)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(takes * step / 10);
        child.kill().unwrap();
        child.wait().unwrap();
        let left = std::fs::read(&output).unwrap();
        assert!(left == b"old" || left == whole, "{} bytes after a kill at {step}/10", left.len());
    }
}

#[test]
fn a_full_disk_is_an_error_and_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.glb");
    std::fs::write(&output, "old").unwrap();
    // A limit on file size stops the write in the middle as a full disk does; the signal it would send is ignored.
    let ended = Command::new("bash")
        .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$@\"", "bash"])
        .arg(furrier_path())
        .args(["bake", "sample:plane", "-o"])
        .arg(&output)
        .args(SMALL)
        .output()
        .unwrap();
    assert_eq!(ended.status.code(), Some(4), "{}", text(&ended.stderr));
    assert_eq!(std::fs::read(&output).unwrap(), b"old");
    assert_eq!(files_in(folder.path()), [output]);
}

#[test]
fn an_input_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.glb");
    assert!(bake(Path::new("sample:plane"), &input, SMALL).status.success());
    let before = std::fs::read(&input).unwrap();
    let link = folder.path().join("link.glb");
    #[cfg(unix)]
    std::os::unix::fs::symlink(&input, &link).unwrap();
    for output in [&input, &link, &folder.path().join("./in.glb")] {
        let ended = bake(&input, output, SMALL);
        assert!(!ended.status.success(), "{} was written over", output.display());
        assert!(std::fs::read(&input).unwrap() == before, "the input changed");
    }
}

#[test]
fn an_output_that_cannot_be_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for output in ["no/such/folder/out.glb", "."] {
        let ended = bake(Path::new("sample:plane"), &folder.path().join(output), SMALL);
        assert!([2, 4].contains(&ended.status.code().unwrap()), "{output}: {}", text(&ended.stderr));
    }
    assert_eq!(files_in(folder.path()), Vec::<PathBuf>::new());
}
