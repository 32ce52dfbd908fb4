//! A reader of USD text by its grammar (openusd.org, "Usda file format"), enough for prims with attributes.

use std::collections::BTreeMap;

/// A value as it is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
    List(Vec<Value>),
}

impl Value {
    pub fn list(&self) -> &[Value] {
        match self {
            Self::List(list) => list,
            other => panic!("{other:?} is no list"),
        }
    }

    /// All numbers inside, tuples flattened.
    pub fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Number(n) => vec![*n],
            Self::List(list) => list.iter().flat_map(Self::numbers).collect(),
            Self::Text(text) => panic!("{text:?} is no number"),
        }
    }
}

/// Attributes and metadata by their paths: `Prim/Child.attribute`, `Prim.attribute(interpolation)`, `(upAxis)`; the type of
/// each prim at its own path, and of each attribute before its name's value.
#[derive(Debug, Default)]
pub struct Layer {
    pub values: BTreeMap<String, Value>,
    pub types: BTreeMap<String, String>,
}

struct Reader<'a> {
    text: &'a str,
    layer: Layer,
}

/// Reads a layer; panics with the place where the grammar is broken.
pub fn read(text: &str) -> Layer {
    let body = text.strip_prefix("#usda 1.0\n").expect("a usda header");
    let mut reader = Reader { text: body, layer: Layer::default() };
    reader.metadata("");
    while !reader.end() {
        reader.prim("");
    }
    reader.layer
}

impl<'a> Reader<'a> {
    fn space(&mut self) {
        loop {
            self.text = self.text.trim_start();
            let Some(comment) = self.text.strip_prefix('#') else { return };
            self.text = comment.split_once('\n').map_or("", |(_, rest)| rest);
        }
    }

    fn end(&mut self) -> bool {
        self.space();
        self.text.is_empty()
    }

    fn take(&mut self, token: &str) -> bool {
        self.space();
        let rest = self.text.strip_prefix(token);
        self.text = rest.unwrap_or(self.text);
        rest.is_some()
    }

    fn need(&mut self, token: &str) {
        assert!(self.take(token), "{token:?} expected before {:.80?}", self.text);
    }

    fn word(&mut self) -> &'a str {
        self.space();
        let end = self.text.find(|c: char| !(c.is_alphanumeric() || "_:.".contains(c))).unwrap_or(self.text.len());
        assert!(end > 0, "a word expected before {:.80?}", self.text);
        let (word, rest) = self.text.split_at(end);
        self.text = rest;
        word
    }

    fn string(&mut self) -> String {
        for quote in ["\"\"\"", "\""] {
            if self.take(quote) {
                let (inside, rest) = self.text.split_once(quote).expect("a closing quote");
                self.text = rest;
                return inside.to_owned();
            }
        }
        panic!("a string expected before {:.80?}", self.text)
    }

    fn metadata(&mut self, path: &str) {
        if !self.take("(") {
            return;
        }
        while !self.take(")") {
            self.space();
            if self.text.starts_with('"') {
                self.string();
                continue;
            }
            let mut key = self.word();
            if ["prepend", "append", "add", "delete"].contains(&key) {
                key = self.word();
            }
            self.need("=");
            let value = self.value();
            self.layer.values.insert(format!("{path}({key})"), value);
            self.take(";");
        }
    }

    fn prim(&mut self, parent: &str) {
        assert!(["def", "over", "class"].contains(&self.word()), "a prim expected before {:.80?}", self.text);
        self.space();
        let kind = if self.text.starts_with('"') { "" } else { self.word() };
        let name = self.string();
        let path = if parent.is_empty() { name } else { format!("{parent}/{name}") };
        self.layer.types.insert(path.clone(), kind.to_owned());
        self.metadata(&path);
        self.need("{");
        while !self.take("}") {
            if ["def ", "over ", "class "].iter().any(|word| self.text.starts_with(word)) {
                self.prim(&path);
            } else {
                self.attribute(&path);
            }
            self.take(";");
        }
    }

    fn attribute(&mut self, prim: &str) {
        let mut kind = self.word();
        while ["custom", "uniform", "varying"].contains(&kind) {
            kind = self.word();
        }
        let array = if self.take("[") { "[]" } else { "" };
        if array == "[]" {
            self.need("]");
        }
        let path = format!("{prim}.{}", self.word());
        self.layer.types.insert(path.clone(), format!("{kind}{array}"));
        if self.take("=") {
            let value = self.value();
            self.layer.values.insert(path.clone(), value);
        }
        self.metadata(&path);
    }

    fn value(&mut self) -> Value {
        for (open, close) in [("[", "]"), ("(", ")")] {
            if self.take(open) {
                let mut list = Vec::new();
                while !self.take(close) {
                    list.push(self.value());
                    if !self.take(",") {
                        self.need(close);
                        break;
                    }
                }
                return Value::List(list);
            }
        }
        for (open, close) in [("@", "@"), ("<", ">")] {
            if self.take(open) {
                let (inside, rest) = self.text.split_once(close).expect("a closing mark");
                self.text = rest;
                return Value::Text(inside.to_owned());
            }
        }
        self.space();
        if self.text.starts_with('"') {
            return Value::Text(self.string());
        }
        let end = self.text.find(|c: char| !(c.is_alphanumeric() || "+-._".contains(c))).unwrap_or(self.text.len());
        let (token, rest) = self.text.split_at(end);
        self.text = rest;
        token.parse().map_or_else(|_| Value::Text(token.to_owned()), Value::Number)
    }
}
