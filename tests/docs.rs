//! Pages made from the code: `docs/cli.md` from the command line's definition, `docs/presets.md` from the preset's types.
//! `FURRIER_UPDATE=1 cargo test --release docs` writes them anew.

use furrier::preset::Preset;
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
    let schema = schemars::schema_for!(Preset).to_value();
    let defaults = serde_json::to_value(Preset::default()).unwrap();
    table("", &schema, &defaults, &schema, &mut page);
    keep("presets.md", &page);
}

/// Appends the keys of the object that `schema` describes, then the tables inside it.
fn table(name: &str, schema: &Value, defaults: &Value, root: &Value, page: &mut String) {
    let title = if name.is_empty() { "Keys at the top".to_owned() } else { format!("`[{name}]`") };
    write!(page, "\n## {title}\n\n").unwrap();
    if let Some(text) = schema["description"].as_str().filter(|_| !name.is_empty()) {
        write!(page, "{}\n\n", one_line(text)).unwrap();
    }
    page.push_str("| key | default | what it is |\n|---|---|---|\n");
    let (mut tables, mut lists) = (Vec::new(), Vec::new());
    for (key, property) in schema["properties"].as_object().unwrap() {
        let inner = resolved(property, root);
        let text = property["description"].as_str().or(inner["description"].as_str()).unwrap_or_default();
        if inner["properties"].is_object() {
            tables.push((key, inner));
            continue;
        }
        let (text, choices) = (one_line(text), choices(inner));
        let item = resolved(&property["items"], root);
        if item["properties"].is_object() {
            lists.push((key, item));
        }
        // What an entry of a list must say has no default.
        let required = schema["required"].as_array().is_some_and(|keys| keys.contains(&key.as_str().into()));
        let default = defaults.get(key).or(property.get("default")).unwrap_or(&Value::Null);
        let default = if required { "must be given".to_owned() } else { toml_text(default) };
        writeln!(page, "| `{key}` | {default} | {text}{choices} |").unwrap();
    }
    for (key, inner) in tables {
        let path = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
        table(&path, inner, &defaults[key], root, page);
    }
    for (key, item) in lists {
        table(&format!("[{name}.{key}]"), item, &Value::Null, root, page);
    }
}

/// `schema`, or the definition it points to.
fn resolved<'a>(schema: &'a Value, root: &'a Value) -> &'a Value {
    let target = schema["$ref"].as_str().or(schema["allOf"][0]["$ref"].as_str());
    target.map_or(schema, |path| root.pointer(path.trim_start_matches('#')).unwrap())
}

/// What the variants of an enum mean, as sentences to follow its description.
fn choices(schema: &Value) -> String {
    let variants = schema["oneOf"].as_array().into_iter().flatten();
    let mut text = String::new();
    for variant in variants {
        let keyed = variant["properties"].as_object().and_then(|p| p.keys().next());
        let key = variant["const"].as_str().map(|name| format!("`\"{name}\"`"));
        let key = key.or(keyed.map(|name| format!("`{{ {name} = … }}`"))).unwrap();
        let meaning = variant["description"].as_str().unwrap_or_default();
        write!(text, "<br>{key}: {}", one_line(meaning)).unwrap();
    }
    text
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

/// A default as one would write it in TOML; nothing where there is none.
fn toml_text(value: &Value) -> String {
    let plain = match value {
        Value::Null => return "none".to_owned(),
        Value::String(text) if text.is_empty() => return "none".to_owned(),
        Value::Object(entries) => {
            let inner: Vec<_> = entries.iter().map(|(key, value)| format!("{key} = {}", short(value))).collect();
            format!("{{ {} }}", inner.join(", "))
        }
        other => short(other),
    };
    format!("`{plain}`")
}

/// JSON text, its numbers as the 32-bit floats they are.
fn short(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(short).collect::<Vec<_>>().join(", ")),
        Value::Number(n) if n.is_f64() => (n.as_f64().unwrap() as f32).to_string(),
        other => other.to_string(),
    }
}
