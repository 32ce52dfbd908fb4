//! A key as a setting writes it: names with dots between, entries of lists in brackets.

use std::fmt;

/// One step into a preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// A member of a table.
    Key(String),
    /// An entry of a list, from 0.
    Index(usize),
}

/// Reads `groom.whorls[0].spin_deg`; none where it is no key.
pub fn parse(text: &str) -> Option<Vec<Part>> {
    let mut parts = Vec::new();
    for piece in text.split('.') {
        let (name, indices) = piece.split_once('[').map_or((piece, None), |(name, rest)| (name, Some(rest)));
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(plain) {
            return None;
        }
        parts.push(Part::Key(name.to_owned()));
        if let Some(indices) = indices {
            for index in indices.strip_suffix(']')?.split("][") {
                parts.push(Part::Index(index.parse().ok()?));
            }
        }
    }
    Some(parts)
}

/// Parts as they are written.
pub struct Shown<'a>(pub &'a [Part]);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, part) in self.0.iter().enumerate() {
            match part {
                Part::Key(name) if i == 0 => f.write_str(name)?,
                Part::Key(name) => write!(f, ".{name}")?,
                Part::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}
