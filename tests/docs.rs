//! Pages made from the code: `docs/cli.md` from the command line's definition, `docs/presets.md` from the preset's types.
//! `FURRIER_UPDATE=1 cargo test --release docs` writes them anew.

use furrier::preset::Preset;
use furrier::preset::keys::{Table, tables};
use serde_json::Value;
use std::fmt::Write;

/// Compares `page` with the file `docs/<name>`, or writes it where an update is asked for.
fn keep(name: &str, page: &str) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
    if std::env::var_os("FURRIER_UPDATE").is_some() {
        std::fs::write(&path, page).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    if let Some(difference) = first_difference(&kept, page) {
        panic!("docs/{name} is not current; FURRIER_UPDATE=1 cargo test --release docs writes it anew\n{difference}");
    }
}

/// The first line where two texts part, or `None` where they are the same.
pub fn first_difference(kept: &str, made: &str) -> Option<String> {
    if kept == made {
        return None;
    }
    let (mut kept_lines, mut made_lines) = (kept.lines(), made.lines());
    for line in 1.. {
        let (kept_line, made_line) = (kept_lines.next(), made_lines.next());
        if kept_line != made_line || kept_line.is_none() {
            return Some(format!("line {line}\n  kept: {kept_line:?}\n  made: {made_line:?}"));
        }
    }
    None
}

#[test]
fn the_command_line_page_is_current() {
    let mut page =
        String::from("# Command line\n\nMade from `furrier --help` and its subcommands' by tests/docs.rs.\n");
    let mut furrier = furrier::cli::definition().term_width(100);
    furrier.build();
    help(&mut furrier, &mut page);
    keep("cli.md", &page);
}

/// Appends the help of `command` and of everything below it.
fn help(command: &mut clap::Command, page: &mut String) {
    let name = command.get_bin_name().unwrap_or(command.get_name()).to_owned();
    let text = command.render_long_help().to_string();
    let lines: Vec<_> = text.lines().map(str::trim_end).collect();
    writeln!(page, "\n## {name}\n\n```text\n{}\n```", lines.join("\n").trim_end()).unwrap();
    for inner in command.get_subcommands_mut().filter(|c| c.get_name() != "help") {
        help(inner, page);
    }
}

#[test]
fn the_preset_page_is_current() {
    let mut page = String::from(
        "# Presets\n\nA preset is a TOML file with one table per step. Keys left out keep their default; unknown keys \
         are refused. `--set table.key=value` changes one value for one bake. Made from the code by tests/docs.rs.\n\n\
         ## Built in\n\n| name | what it is | size it describes, m |\n|---|---|---:|\n",
    );
    for preset in Preset::names().map(|name| Preset::load(name).unwrap()) {
        writeln!(page, "| `{}` | {} | {} |", preset.name, preset.description, preset.size_m).unwrap();
    }
    page.push_str("\n`furrier presets show NAME` prints one with the sources of its numbers.\n");
    for table in tables() {
        add_table(&table, &mut page);
    }
    keep("presets.md", &page);
}

/// Appends a table's keys.
fn add_table(table: &Table, page: &mut String) {
    // Entries of lists are written as TOML has them.
    let title = match table.name.strip_suffix("[0]") {
        _ if table.name.is_empty() => "Keys at the top".to_owned(),
        Some(list) => format!("`[[{list}]]`"),
        None => format!("`[{}]`", table.name),
    };
    if table.keys.is_empty() {
        return;
    }
    write!(page, "\n## {title}\n\n").unwrap();
    if !table.what.is_empty() {
        write!(page, "{}\n\n", cell(&table.what)).unwrap();
    }
    page.push_str("| key | default | value | what it is |\n|---|---|---|---|\n");
    for key in &table.keys {
        let name = key.key.strip_prefix(&table.name).unwrap_or(&key.key).trim_start_matches('.');
        let default = key.default.as_ref().map_or("none".to_owned(), |value| format!("`{}`", short(value)));
        writeln!(page, "| `{name}` | {default} | {} | {} |", cell(&key.expected()), cell(&key.what)).unwrap();
    }
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// JSON text, its numbers as the 32-bit floats they are.
fn short(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(short).collect::<Vec<_>>().join(", ")),
        Value::Number(n) if n.is_f64() => (n.as_f64().unwrap() as f32).to_string(),
        other => other.to_string(),
    }
}
