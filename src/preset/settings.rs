//! Single values of a preset changed by their keys.

use super::Preset;
use super::keys::{self, Node};
use super::path::{Part, Shown, parse};
use crate::error::{Error, Result};
use toml::{Table, Value};

/// How alike a key must be to one there is to be taken for a slip of the pen, 1 for the same.
const ALIKE: f64 = 0.6;

impl Preset {
    /// This preset with settings of the form `table.key=value` applied in order. A value is TOML; a bare word is a string.
    /// `list[0]` is an entry of a list; the number behind the last one adds one. Keys of a table that is given as a whole
    /// (`guard.shape={noise=0.1}`) are set one by one. Setting a length in one unit drops it in the other.
    ///
    /// # Errors
    /// Names the setting that is malformed, unknown or out of range, and what its key expects.
    pub fn with_settings(self, settings: &[String]) -> Result<Self> {
        settings.iter().try_fold(self, |preset, setting| preset.with_setting(setting))?.checked()
    }

    fn with_setting(self, setting: &str) -> Result<Self> {
        let fault = |found: &dyn std::fmt::Display, expected: String| {
            Error::usage("the setting is not valid")
                .with_parameter("set")
                .with_field(setting)
                .with_found(found)
                .with_expected(expected)
                .with_hint(
                    "write table.key=value, as in `set` guard.length.mm=30; `furrier presets keys` prints every key",
                )
        };
        let Some((key, value)) = setting.split_once('=') else {
            return Err(fault(&"no `=`", "table.key=value".into()));
        };
        let parts =
            parse(key.trim()).ok_or_else(|| fault(&format!("the key `{key}`"), "names with dots between".into()))?;
        let Some(node) = keys::find(&parts) else {
            return Err(fault(&format!("no key `{}`", key.trim()), there_is(&parts)));
        };
        let name = Shown(&parts).to_string();
        let mut root = Value::try_from(&self).map_err(|e| fault(&e, "a preset that TOML can hold".into()))?;
        let mut place = Place { value: &mut root, node: Node::root() };
        for (i, part) in parts.iter().enumerate() {
            place = place.step(part).map_err(|expected| fault(&Shown(&parts[..=i]), expected))?;
        }
        place.put(toml_value(value.trim()));
        let changed: Self = root.try_into().map_err(|e: toml::de::Error| fault(&e.message(), node.expected(&name)))?;
        keys::check(&changed).map_err(|error| error.with_parameter("set"))?;
        Ok(changed)
    }
}

/// A value of a preset, and what the types say of it.
struct Place<'a> {
    value: &'a mut Value,
    node: Node,
}

impl<'a> Place<'a> {
    /// Goes to a part of it, which is made where it is not there yet.
    ///
    /// # Errors
    /// Says what would have been there.
    fn step(self, part: &Part) -> std::result::Result<Self, String> {
        let node = self.node.step(part).ok_or_else(|| "a key that there is".to_owned())?;
        let grows = !self.node.is_fixed();
        let value = match (part, self.value) {
            (Part::Key(name), Value::Table(table)) => {
                // A length is one value in one of two units, not a table of two.
                if self.node.is_either() {
                    table.retain(|key, _| key == name);
                }
                table.entry(name.clone()).or_insert_with(|| empty(&node))
            }
            (Part::Index(index), Value::Array(list)) => {
                let length = list.len();
                if *index == length && grows {
                    list.push(empty(&node));
                }
                list.get_mut(*index).ok_or_else(|| match length {
                    0 => "[0], which adds the first entry".to_owned(),
                    _ if grows => format!("an entry from [0] to [{}], or [{length}] to add one", length - 1),
                    _ => format!("an entry from [0] to [{}]", length - 1),
                })?
            }
            _ => return Err("a table or a list".to_owned()),
        };
        Ok(Place { value, node })
    }

    /// Puts `new` there.
    fn put(self, new: Value) {
        match (self.value, new) {
            (Value::Table(own), Value::Table(new)) if self.node.is_table() => {
                for (name, value) in new {
                    // What is no key is found when the preset is read again.
                    match self.node.step(&Part::Key(name.clone())) {
                        Some(node) => {
                            let at = own.entry(name).or_insert_with(|| empty(&node));
                            Place { value: at, node }.put(value);
                        }
                        None => drop(own.insert(name, value)),
                    }
                }
            }
            (own, new) => *own = new,
        }
    }
}

/// What stands where nothing does yet.
fn empty(node: &Node) -> Value {
    if node.is_list() { Value::Array(Vec::new()) } else { Value::Table(Table::new()) }
}

/// The key that is most like one that there is not, or those of the table that it would be in.
fn there_is(parts: &[Part]) -> String {
    // Entries of lists are told by their first one.
    let first = |part: &Part| if matches!(part, Part::Index(_)) { Part::Index(0) } else { part.clone() };
    let asked = Shown(&parts.iter().map(first).collect::<Vec<_>>()).to_string();
    let all = keys::tables().into_iter().flat_map(|table| table.keys);
    let last = |key: &str| key.rsplit('.').next().unwrap_or_default().to_owned();
    let likeness = |key: &keys::Key| {
        let whole = strsim::normalized_damerau_levenshtein(&asked, &key.key);
        whole.max(0.9 * strsim::normalized_damerau_levenshtein(&last(&asked), &last(&key.key)))
    };
    let nearest = all.map(|key| (likeness(&key), key)).max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((likeness, key)) = nearest
        && likeness >= ALIKE
    {
        return format!("perhaps {}, {}", key.key, key.expected());
    }
    let known = (0..parts.len()).rev().find_map(|n| Some((n, keys::find(&parts[..n])?)));
    let (n, node) = known.unwrap_or_else(|| (0, Node::root()));
    let names = node.names().join(", ");
    match n {
        0 => format!("one of {names}"),
        _ => format!("one of {names} in {}", Shown(&parts[..n])),
    }
}

/// `text` as a TOML value, or as a string where it is none.
fn toml_value(text: &str) -> Value {
    toml::from_str::<Table>(&format!("value = {text}"))
        .ok()
        .filter(|table| table.len() == 1)
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| Value::String(text.to_owned()))
}
