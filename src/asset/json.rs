//! A cursor into a JSON document that knows its own path, so that every message can name the field.

use crate::error::{Error, Result};
use serde_json::Value;

/// A value inside a document, with the path that leads there.
#[derive(Clone, Debug)]
pub struct At<'a> {
    pub value: &'a Value,
    pub path: String,
}

impl<'a> At<'a> {
    /// The whole document.
    pub fn root(value: &'a Value) -> Self {
        Self { value, path: String::new() }
    }

    /// The member `key`, where there is one.
    pub fn get(&self, key: &str) -> Option<At<'a>> {
        let value = self.value.get(key)?;
        let dot = if self.path.is_empty() { "" } else { "." };
        Some(At { value, path: format!("{}{dot}{key}", self.path) })
    }

    /// The member `key`, which must be there.
    pub fn need(&self, key: &str) -> Result<At<'a>> {
        self.get(key).ok_or_else(|| {
            Error::input("the glTF lacks a field it must have")
                .with_field(if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) })
                .with_found("nothing")
                .with_expected("a value")
        })
    }

    /// The entries of the array `key`; none where the member is absent.
    pub fn list(&self, key: &str) -> Result<Vec<At<'a>>> {
        self.get(key).map_or(Ok(Vec::new()), |list| list.entries())
    }

    /// The entries of this array.
    pub fn entries(&self) -> Result<Vec<At<'a>>> {
        let entries = self.value.as_array().ok_or_else(|| self.fault("an array"))?;
        Ok(entries.iter().enumerate().map(|(i, value)| At { value, path: format!("{}[{i}]", self.path) }).collect())
    }

    /// Entry `index` of the array `key`.
    pub fn entry(&self, key: &str, index: usize) -> Result<At<'a>> {
        let list = self.need(key)?;
        let path = format!("{}[{index}]", list.path);
        match list.value.get(index) {
            Some(value) => Ok(At { value, path }),
            None => Err(Error::input("the glTF names something it does not have")
                .with_field(path)
                .with_found("nothing")
                .with_expected("an entry")),
        }
    }

    /// The members of an object, in the document's order.
    pub fn members(&self) -> Result<Vec<(&'a str, At<'a>)>> {
        let object = self.value.as_object().ok_or_else(|| self.fault("an object"))?;
        Ok(object
            .iter()
            .map(|(key, value)| (key.as_str(), At { value, path: format!("{}.{key}", self.path) }))
            .collect())
    }

    /// A whole number that fits memory.
    pub fn size(&self) -> Result<usize> {
        let number = self.value.as_u64().or_else(|| {
            // Some exporters write 3.0 where 3 is meant.
            self.value.as_f64().filter(|n| n.fract() == 0.0 && (0.0..9e15).contains(n)).map(|n| n as u64)
        });
        number.and_then(|n| usize::try_from(n).ok()).ok_or_else(|| self.fault("a whole number from 0"))
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64> {
        self.value.as_f64().filter(|n| n.is_finite()).ok_or_else(|| self.fault("a finite number"))
    }

    /// An array of exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N]> {
        let fault = || self.fault(&format!("{N} finite numbers"));
        let list = self.value.as_array().filter(|list| list.len() == N).ok_or_else(fault)?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(list) {
            *number = value.as_f64().filter(|n| n.is_finite()).ok_or_else(fault)?;
        }
        Ok(numbers)
    }

    /// A text.
    pub fn text(&self) -> Result<&'a str> {
        self.value.as_str().ok_or_else(|| self.fault("a text"))
    }

    /// The whole number `key`, or `default` where it is absent.
    pub fn size_or(&self, key: &str, default: usize) -> Result<usize> {
        self.get(key).map_or(Ok(default), |at| at.size())
    }

    /// The index `key` into a list of `length` entries, where the member is present.
    pub fn reference(&self, key: &str, list: &str, length: usize) -> Result<Option<usize>> {
        self.get(key).map(|at| at.index_into(list, length)).transpose()
    }

    /// This value as an index into a list of `length` entries.
    pub fn index_into(&self, list: &str, length: usize) -> Result<usize> {
        let index = self.size()?;
        if index < length {
            return Ok(index);
        }
        Err(Error::input("the glTF points at something it does not have")
            .with_field(self.path.clone())
            .with_found(index)
            .with_expected(match length {
                0 => format!("no reference: the file has no {list}"),
                _ => format!("an index into `{list}`, 0 to {}", length - 1),
            })
            .with_hint("the file was cut or written by a faulty exporter; export it again"))
    }

    /// An error about this value.
    pub fn fault(&self, expected: &str) -> Error {
        let mut found = self.value.to_string();
        if found.len() > 60 {
            found = found.chars().take(57).chain("...".chars()).collect();
        }
        let fault = Error::input("the glTF holds a value it must not")
            .with_field(self.path.clone())
            .with_found(found)
            .with_expected(expected);
        if self.value.is_null() {
            return fault.with_hint("glTF has no null: leave out members that have no value, or export again");
        }
        fault
    }
}
