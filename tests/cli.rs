//! The real binary: help, exit codes, what goes to which stream.

use crate::common::{furrier_path, skipped};
use assert_cmd::Command;
use predicates::prelude::*;

/// The binary under test.
fn furrier() -> Command {
    Command::new(furrier_path())
}

#[test]
fn help_names_every_exit_code() {
    let codes = [1, 2, 3, 4, 5, 6, 75].map(|code| predicate::str::contains(format!("\n  {code:<2} ")));
    let mut result = furrier().arg("--help").assert().success().stderr("");
    for code in codes {
        result = result.stdout(code);
    }
}

#[test]
fn every_subcommand_has_a_worked_example() {
    let definition = furrier::cli::definition();
    for command in definition.get_subcommands() {
        let name = command.get_name();
        let example =
            predicate::str::contains("Examples:\n").and(predicate::str::contains(format!("  furrier {name} ")));
        furrier().args([name, "--help"]).assert().success().stdout(example);
    }
}

#[test]
fn impossible_command_lines_exit_with_2_and_say_nothing_on_stdout() {
    for arguments in [
        &[][..],
        &["frobnicate"],
        &["presets", "show"],
        &["presets", "show", "foxx"],
        &["presets", "list", "--frobnicate"],
        &["-q", "-v", "presets", "list"],
        &["completions", "bash", "--json"],
    ] {
        furrier().args(arguments).assert().code(2).stdout("").stderr(predicate::str::is_empty().not());
    }
}

#[test]
fn an_unknown_preset_is_answered_with_the_ones_there_are() {
    let answer = predicate::str::contains("found: foxx")
        .and(predicate::str::contains("mink"))
        .and(predicate::str::contains("help:"));
    furrier().args(["presets", "show", "foxx"]).assert().code(2).stderr(answer);
}

#[test]
fn results_as_json_are_json_and_nothing_else() {
    for arguments in [&["presets", "list"][..], &["presets", "show", "fox"]] {
        let output = furrier().args(arguments).args(["--json", "-vv"]).assert().success().get_output().clone();
        let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(value.is_array() || value.is_object());
    }
}

#[test]
fn a_shown_preset_can_be_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my-fox.toml");
    let shown = furrier().args(["presets", "show", "fox"]).assert().success().get_output().stdout.clone();
    std::fs::write(&path, &shown).unwrap();
    furrier().args(["presets", "show"]).arg(&path).assert().success().stdout(shown);
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = std::process::Command::new(furrier_path())
        .args(["completions", "zsh"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stdout_is_a_failure() {
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let status = std::process::Command::new(furrier_path())
        .args(["presets", "list"])
        .stdout(full)
        .stderr(std::process::Stdio::null())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(4));
}

/// Bakes a small coat on `sample:plane` into `folder`.
fn baked(folder: &std::path::Path) -> std::path::PathBuf {
    let output = folder.join("plane.glb");
    furrier().args(["bake", "sample:plane", "-o"]).arg(&output).args(crate::bake::SMALL).assert().success();
    output
}

fn json_of(arguments: &[&std::ffi::OsStr]) -> serde_json::Value {
    let output = furrier().args(arguments).arg("--json").assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).unwrap()
}

#[test]
fn an_atlas_says_that_it_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("atlas.glb");
    let report = folder.path().join("report.json");
    let mut args = vec!["bake".as_ref(), "sample:torus".as_ref(), "-o".as_ref(), output.as_os_str()];
    args.extend(["--report".as_ref(), report.as_os_str()]);
    // 64 texels instead of 16: charts need room.
    let texels = |option: &&'static str| if *option == "16" { "64" } else { *option };
    args.extend(crate::bake::SMALL.iter().map(texels).map(std::ffi::OsStr::new));
    args.extend(["--parameterisation", "atlas"].map(std::ffi::OsStr::new));
    furrier().args(&args).assert().success().stderr(predicate::str::contains("64² texels"));
    let inspected = json_of(&["inspect".as_ref(), output.as_os_str()]);
    assert_eq!(inspected["coat"]["tiles"][0]["sampled_on_skin"], true);
    assert_eq!(inspected["coat"]["tiles"][0]["texture_size"], 64);
    let used = inspected["coat"]["tiles"][0]["texels_used"].as_f64().unwrap();
    // Charts of a few texels and as much padding on every side.
    assert!((1e-4..0.9).contains(&used), "{used} of the texels");
    furrier()
        .arg("inspect")
        .arg(&output)
        .assert()
        .success()
        .stdout(predicate::str::contains("atlas 0 (fox)").and(predicate::str::contains("of its texels lie on skin")));
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    assert_eq!(report["counts"]["texels_used_by_tile"][0].as_f64(), Some(used));
    assert_eq!(report["error"]["coverage_by_tile"][0].as_array().unwrap().len(), 4);
}

#[test]
fn what_was_baked_is_what_is_inspected() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("plane.glb");
    let mut arguments = vec!["bake".as_ref(), "sample:plane".as_ref(), "-o".as_ref(), output.as_os_str()];
    arguments.extend(crate::bake::SMALL.iter().map(std::ffi::OsStr::new));
    let said = json_of(&arguments);
    let inspected = json_of(&["inspect".as_ref(), output.as_os_str()]);
    assert_eq!(said["materials"], inspected["materials"]);
    assert_eq!(said["coat"]["drawn_triangles"], inspected["coat"]["drawn_triangles"]);
    assert_eq!(inspected["coat"]["tiles"][0]["layers"], 4);
    assert_eq!(inspected["coat"]["tiles"][0]["preset"], "fox");
}

#[test]
fn progress_and_notes_are_lines_on_stderr_and_quiet_is_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("triangle.obj");
    std::fs::write(&input, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let bake = |quiet: &[&str]| {
        let mut command = furrier();
        command.arg("bake").arg(&input).arg("-o").arg(folder.path().join("again.glb"));
        command.args(crate::bake::SMALL).args(quiet).assert().success()
    };
    let spoken = bake(&[]);
    spoken.stderr(predicate::str::contains("tile …\n").and(predicate::str::contains("one unit of the file")));
    bake(&["-q"]).stderr("");
}

#[test]
fn two_presets_for_one_material_or_a_material_that_is_not_there_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for options in [
        &["--preset", "fox", "--preset", "mink"][..],
        &["--preset", "fur=fox", "--preset", "fur=mink"],
        &["--preset", "feathers=fox"],
        &["--material", "feathers"],
        &["--uv-set", "0"],
        &["--fallback", "shells:0"],
        &["--fallback", "some"],
        &["--layers", "1"],
        &["--texture-size", "100"],
        &["--threads", "0"],
        &["--set", "guard.length.mm=-1"],
    ] {
        let mut command = furrier();
        command.args(["bake", "sample:plane", "-o"]).arg(folder.path().join("out.glb")).args(options);
        command.assert().code(2).stdout("");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// The library knows no flags: the command line puts them where it names what they set.
#[test]
fn errors_and_notes_name_the_flag_to_change() {
    let folder = tempfile::tempdir().unwrap();
    for (options, said) in [
        (&["--material", "feathers"][..], &["field: --material\n"][..]),
        (&["--set", "guard=1"], &["field: --set guard=1\n", "as in `--set` guard.length.mm=30"]),
        (&["--parameterisation", "uv", "--uv-set", "7"], &["use `--parameterisation` atlas, or another `--uv-set`"]),
    ] {
        let mut command = furrier();
        command.args(["bake", "sample:plane", "-o"]).arg(folder.path().join("out.glb")).args(options);
        let error = String::from_utf8(command.assert().failure().get_output().stderr.clone()).unwrap();
        said.iter().for_each(|said| assert!(error.contains(said), "{said} is missing from: {error}"));
    }
    let view = furrier().args(["view", "no.glb", "--screenshot", "a.png", "--orbit", "1"]).assert().code(2);
    view.stderr(predicate::str::contains("--orbit").and(predicate::str::contains("`--orbit` 35,12,1")));
}

#[test]
fn a_report_has_its_steps_and_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (output, report) = (folder.path().join("out.glb"), folder.path().join("report.json"));
    let mut command = furrier();
    command.args(["bake", "sample:plane", "-o"]).arg(&output).args(crate::bake::SMALL).arg("--report").arg(&report);
    command.assert().success();
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert_eq!(report["schema_version"], 1);
    assert!(report["total_ms"].as_f64().unwrap() > 0.0);
    let steps: Vec<_> = report["steps"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert!(["read", "tile", "write"].iter().all(|name| steps.contains(name)), "{steps:?}");
    let rows = report["error"]["coverage_by_tile"][0].as_array().unwrap();
    assert_eq!(rows.len(), 6, "one row per angle");
}

#[test]
fn pictures_are_compared_and_a_limit_decides_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |name: &str, grey: u8| {
        let path = folder.path().join(name);
        image::RgbaImage::from_pixel(16, 16, image::Rgba([grey, grey, grey, 255])).save(&path).unwrap();
        path
    };
    let (a, b) = (picture("a.png", 100), picture("b.png", 180));
    furrier().arg("compare").args([&a, &a]).args(["--max-flip", "0"]).assert().code(0);
    furrier().arg("compare").args([&a, &b]).assert().code(0).stdout(predicate::str::contains("FLIP"));
    furrier().arg("compare").args([&a, &b]).args(["--max-flip", "0.01"]).assert().code(1);
    furrier().arg("compare").args([&a, &b]).args(["--max-flip", "2"]).assert().code(2);
    furrier().arg("compare").args([&a, &folder.path().join("c.png")]).assert().code(3);
}

#[test]
fn a_file_without_a_coat_is_answered_with_how_to_get_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bare.gltf");
    std::fs::write(&path, r#"{"asset":{"version":"2.0"}}"#).unwrap();
    furrier().arg("inspect").arg(&path).assert().code(3).stderr(predicate::str::contains("file:"));
}

#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_viewing_names_the_package_and_baking_works() {
    let folder = tempfile::tempdir().unwrap();
    let blind = |command: &mut Command| {
        command.env("VK_ICD_FILENAMES", "/dev/null").env("VK_DRIVER_FILES", "/dev/null");
    };
    let furry = folder.path().join("plane.glb");
    let mut bake = furrier();
    blind(bake.args(["bake", "sample:plane", "-o"]).arg(&furry).args(crate::bake::SMALL));
    bake.assert().success();
    let mut view = furrier();
    blind(view.arg("view").arg(&furry).arg("--screenshot").arg(folder.path().join("out.png")));
    view.assert().code(5).stderr(predicate::str::contains("mesa-vulkan-drivers"));
    assert!(!folder.path().join("out.png").exists());
    let mut devices = furrier();
    blind(devices.arg("devices"));
    devices.assert().success().stdout(predicate::str::contains("cpu")).stderr(predicate::str::contains("mesa-vulkan"));
}

#[test]
fn a_screenshot_shows_something_and_options_that_cannot_be_are_refused() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter");
    }
    let folder = tempfile::tempdir().unwrap();
    let (furry, picture) = (baked(folder.path()), folder.path().join("out.png"));
    let view = |options: &[&str]| {
        let mut command = furrier();
        command.arg("view").arg(&furry).arg("--screenshot").arg(&picture).args(options);
        command.assert()
    };
    view(&["--size", "64x48", "--orbit", "-30,40,1", "--transparent"]).code(0);
    let drawn = image::open(&picture).unwrap().to_rgba8();
    assert_eq!(drawn.dimensions(), (64, 48));
    assert!(drawn.pixels().filter(|p| p.0[3] > 128).count() > 300, "hardly anything was drawn");
    view(&["--turntable", "4", "--size", "32x32"]).code(0);
    view(&["--frames", "3", "--size", "32x32"]).code(0);
    for frame in ["0001", "0002", "0003"] {
        let file = picture.with_extension(format!("{frame}.png"));
        assert!(image::open(&file).is_ok(), "{}", file.display());
    }
    assert_eq!(image::open(&picture).unwrap().to_rgba8().dimensions(), (64, 64));
    for options in [
        &["--size", "0x5"][..],
        &["--size", "big"],
        &["--show", "bones"],
        &["--orbit", "1,2"],
        &["--light", "sun"],
        &["--ambient", "1,2"],
        &["--time", "1"],
        &["--animation", "Fly"],
        &["--turntable", "0"],
        &["--device", "abacus"],
    ] {
        view(options).code(2);
    }
}
