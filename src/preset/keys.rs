//! Every key that a preset has, as the types define them: what help, the page of presets and error messages say of a key,
//! and what its numbers are checked against.

use super::Preset;
use super::path::Part;
use crate::error::{Error, Result};
use serde::Serialize;
use serde_json::Value;
use std::sync::LazyLock;

/// The types of a preset as JSON Schema.
static SCHEMA: LazyLock<Value> = LazyLock::new(|| schemars::schema_for!(Preset).to_value());

/// The last part of a key's name tells its unit.
const UNITS: [(&str, &str); 6] =
    [("_per_cm2", "per cm²"), ("_um", "µm"), ("_mm", "mm"), ("mm", "mm"), ("_deg", "degrees"), ("_m", "m")];

/// A table of a preset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Its keys' common start, as `guard.shape`, or `groom.whorls[0]` for an entry of a list; empty for the keys at the top.
    pub name: String,
    /// What it is for.
    pub what: String,
    /// Its keys that hold values, in the order of their definition.
    pub keys: Vec<Key>,
}

/// A key of a preset.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// Its whole name, as a setting has it: `guard.shape.noise`.
    pub key: String,
    /// What kind of value it has: `a number`, `3 numbers`, `one of upright, gravity`.
    pub value: String,
    /// What it is counted in.
    pub unit: Option<&'static str>,
    /// Least and most.
    pub range: Option<[f64; 2]>,
    /// What it is without a word; none for what must be given or is absent then.
    pub default: Option<Value>,
    /// What it does.
    pub what: String,
}

impl Key {
    /// What a value of it must be: kind, range and unit.
    pub fn expected(&self) -> String {
        let range = self.range.map(|[low, high]| format!(" from {low} to {high}")).unwrap_or_default();
        let unit = self.unit.map(|unit| format!(" {unit}")).unwrap_or_default();
        format!("{}{range}{unit}", self.value)
    }
}

/// All tables of a preset with their keys.
pub fn tables() -> Vec<Table> {
    let defaults = serde_json::to_value(Preset::default()).unwrap_or_default();
    let mut tables = Vec::new();
    collect("", &Node::root(), &defaults, "", &mut tables);
    tables
}

/// What the parts of a key lead to, where they lead somewhere.
pub fn find(parts: &[Part]) -> Option<Node> {
    parts.iter().try_fold(Node::root(), |node, part| node.step(part))
}

/// Checks every number of a preset against its range.
///
/// # Errors
/// Names the first key that is out of range.
pub fn check(preset: &Preset) -> Result<()> {
    let unreadable = |error: toml::ser::Error| Error::usage("the preset cannot be written").with_found(error);
    check_node("", &Node::root(), &toml::Value::try_from(preset).map_err(unreadable)?)
}

/// A place in the schema.
#[derive(Clone)]
pub struct Node {
    /// What the types say of it.
    schema: &'static Value,
    /// The field that it stands in, whose words come first.
    field: &'static Value,
    /// The field that tells the range of each way to write a length.
    ranges: &'static Value,
}

impl Node {
    /// The preset itself.
    pub fn root() -> Self {
        Self { schema: &SCHEMA, field: &Value::Null, ranges: &Value::Null }
    }

    fn of(field: &'static Value) -> Self {
        let target = field["$ref"].as_str().or_else(|| field["allOf"][0]["$ref"].as_str());
        let target = target.or_else(|| field["anyOf"][0]["$ref"].as_str());
        let schema = target.and_then(|path| SCHEMA.pointer(path.trim_start_matches('#')));
        Self { schema: schema.unwrap_or(field), field, ranges: &Value::Null }
    }

    /// The members of a table; the ways to write a value that has several, of which one is taken.
    fn members(&self) -> Vec<(&'static str, Self)> {
        let mut members = Vec::new();
        let own = self.schema["properties"].as_object().into_iter().flatten();
        members.extend(own.map(|(name, field)| (name.as_str(), Self::of(field))));
        for variant in self.schema["oneOf"].as_array().into_iter().flatten() {
            for (name, field) in variant["properties"].as_object().into_iter().flatten() {
                // The words of a way stand beside its only member.
                members.push((name.as_str(), Self { field: variant, ranges: self.field, ..Self::of(field) }));
            }
        }
        members
    }

    /// Whether it is written in one of several ways, each a table of one key.
    pub fn is_either(&self) -> bool {
        self.schema["oneOf"].as_array().is_some_and(|all| all.iter().any(|variant| variant["properties"].is_object()))
    }

    /// Whether it is a table of keys of which several may stand.
    pub fn is_table(&self) -> bool {
        self.schema["properties"].is_object()
    }

    /// The names of its members.
    pub fn names(&self) -> Vec<&'static str> {
        self.members().into_iter().map(|(name, _)| name).collect()
    }

    /// Whether it is a list.
    pub fn is_list(&self) -> bool {
        self.schema.get("items").is_some()
    }

    /// Whether it is a list of a length that is given.
    pub fn is_fixed(&self) -> bool {
        self.schema.get("maxItems").is_some()
    }

    /// What a part of a key leads to from here.
    pub fn step(&self, part: &Part) -> Option<Self> {
        match part {
            Part::Key(name) => self.members().into_iter().find(|(member, _)| member == name).map(|(_, node)| node),
            Part::Index(_) => self.entries(),
        }
    }

    /// What the entries of a list are.
    fn entries(&self) -> Option<Self> {
        self.schema.get("items").map(Self::of)
    }

    fn range(&self, variant: &str) -> Option<[f64; 2]> {
        match self.ranges[variant].as_array().map(Vec::as_slice) {
            Some([low, high]) => Some([low.as_f64()?, high.as_f64()?]),
            _ => Some([self.schema["minimum"].as_f64()?, self.schema["maximum"].as_f64()?]),
        }
    }

    /// The kind of its values, in words.
    fn value(&self) -> String {
        let kind = &self.schema["type"];
        let kind = kind.as_str().or_else(|| kind[0].as_str()).unwrap_or_default();
        let choices: Vec<&str> =
            self.schema["oneOf"].as_array().into_iter().flatten().filter_map(|v| v["const"].as_str()).collect();
        let choices = if choices.is_empty() {
            self.schema["enum"].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
        } else {
            choices
        };
        match (kind, self.entries()) {
            _ if !choices.is_empty() => format!("one of {}", choices.join(", ")),
            _ if self.is_either() => {
                let ways: Vec<String> = self.members().iter().map(|(name, _)| format!("{{ {name} = … }}")).collect();
                ways.join(" or ")
            }
            ("number", _) => "a number".into(),
            ("integer", _) if self.schema["powerOfTwo"] == true => "a power of two".into(),
            ("integer", _) => "a whole number".into(),
            ("boolean", _) => "true or false".into(),
            ("array", Some(entry)) if entry.is_table() => "a list of tables".into(),
            ("array", Some(entry)) => match (self.schema["maxItems"].as_u64(), entry.value().as_str()) {
                (Some(n), "a number") => format!("{n} numbers"),
                (Some(n), value) => format!("{n} times {value}"),
                (None, value) => format!("a list, each {value}"),
            },
            _ if self.is_table() => "a table".into(),
            _ => "a text".into(),
        }
    }

    fn what(&self) -> String {
        self.field["description"].as_str().map_or_else(|| self.words_of_type(), one_line)
    }

    fn words_of_type(&self) -> String {
        one_line(self.schema["description"].as_str().unwrap_or_default())
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn key(name: &str, node: &Node, default: Option<Value>) -> Key {
    let last = name.rsplit('.').next().unwrap_or(name);
    // Of a list of numbers, the range of each.
    let mut innermost = node.clone();
    while let Some(entry) = innermost.entries() {
        innermost = entry;
    }
    let mut what = node.what();
    for variant in node.schema["oneOf"].as_array().into_iter().flatten() {
        if let (Some(choice), Some(meaning)) = (variant["const"].as_str(), variant["description"].as_str()) {
            what += &format!(" {choice}: {meaning}");
        }
    }
    Key {
        key: name.to_owned(),
        value: node.value(),
        unit: UNITS.iter().find(|(end, _)| last.ends_with(end)).map(|(_, unit)| *unit),
        range: innermost.range(last),
        default: default.filter(|value| !value.is_null() && value.as_str() != Some("")),
        what,
    }
}

impl Node {
    /// What a value here must be, as a key of this name.
    pub fn expected(&self, name: &str) -> String {
        key(name, self, None).expected()
    }
}

/// What is out of range in `value`, which stands at `name`.
fn check_node(name: &str, node: &Node, value: &toml::Value) -> Result<()> {
    let number = match value {
        toml::Value::Table(table) => {
            for (member, node) in node.members() {
                if let Some(value) = table.get(member) {
                    let path = if name.is_empty() { member.to_owned() } else { format!("{name}.{member}") };
                    check_node(&path, &node, value)?;
                }
            }
            return Ok(());
        }
        toml::Value::Array(items) => {
            let Some(entry) = node.entries() else { return Ok(()) };
            return items.iter().enumerate().try_for_each(|(i, item)| match entry.is_table() {
                true => check_node(&format!("{name}[{i}]"), &entry, item),
                // Colours are named as a whole.
                false => check_node(name, &entry, item).map_err(|error| error.with_expected(node.expected(name))),
            });
        }
        // As they were written: numbers of presets are f32.
        toml::Value::Float(number) => (*number, (*number as f32).to_string()),
        toml::Value::Integer(number) => (*number as f64, number.to_string()),
        _ => return Ok(()),
    };
    let last = name.rsplit('.').next().unwrap_or(name);
    let (number, found) = number;
    let power = node.schema["powerOfTwo"] != true || (number as u64).is_power_of_two();
    match node.range(last) {
        // In f32, as the value is: 0.95 is in 0 to 0.95.
        Some([low, high]) if !(low as f32..=high as f32).contains(&(number as f32)) || !power => {
            Err(Error::usage("a preset value is out of range")
                .with_field(name)
                .with_found(found)
                .with_expected(node.expected(name)))
        }
        _ => Ok(()),
    }
}

/// Adds the keys of `node`, then its tables; `what` is its own description.
fn collect(name: &str, node: &Node, defaults: &Value, what: &str, tables: &mut Vec<Table>) {
    let at = tables.len();
    tables.push(Table { name: name.to_owned(), what: what.to_owned(), keys: Vec::new() });
    let (mut inner, mut lists) = (Vec::new(), Vec::new());
    for (member, node) in node.members() {
        let path = if name.is_empty() { member.to_owned() } else { format!("{name}.{member}") };
        let default = defaults.get(member).or(node.field.get("default")).cloned();
        if node.is_table() {
            inner.push((path, node, default.unwrap_or_default()));
            continue;
        }
        if let Some(entry) = node.entries().filter(Node::is_table) {
            lists.push((format!("{path}[0]"), entry));
        }
        if node.is_either() {
            // One key per way to write it; the default is that of the way it is written in.
            for (way, way_node) in node.members() {
                let default = default.as_ref().and_then(|value| value.get(way)).cloned();
                let mut key = key(&format!("{path}.{way}"), &way_node, default);
                key.what = format!("{} {}", node.what(), key.what);
                tables[at].keys.push(key);
            }
            continue;
        }
        tables[at].keys.push(key(&path, &node, default));
    }
    for (path, node, defaults) in inner {
        collect(&path, &node, &defaults, &node.words_of_type(), tables);
    }
    for (path, entry) in lists {
        collect(&path, &entry, &Value::Null, &entry.what(), tables);
    }
}
