//! The real binary: help, exit codes, what goes to which stream.

use crate::common::furrier_path;
use assert_cmd::Command;
use predicates::prelude::*;

/// The binary under test.
fn furrier() -> Command {
    Command::new(furrier_path())
}

#[test]
fn help_names_every_exit_code() {
    let codes = [1, 2, 3, 4, 5].map(|code| predicate::str::contains(format!("\n  {code}  ")));
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
