//! Lines of OBJ and MTL files: comments, continued lines, keywords.

use crate::error::{Error, Result};
use std::borrow::Cow;

/// Lines of numbers go on behind a `\` at their end and stop at any `#`. In other lines both may be part of a name, such as
/// `Material #25` or a Windows path.
const NUMBERS: [&str; 6] = ["v", "vt", "vn", "f", "l", "p"];

/// Calls `read` with keyword and rest of every line.
///
/// # Errors
/// Those of `read`, with the line's number.
pub fn each(text: &str, mut read: impl FnMut(&str, &str) -> Result<()>) -> Result<()> {
    // Lines of old Macs end in a carriage return alone.
    let old = if text.contains('\n') { Cow::Borrowed(text) } else { Cow::Owned(text.replace('\r', "\n")) };
    let mut lines = old.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = if NUMBERS.contains(&keyword) {
            let mut joined = Cow::Borrowed(uncommented(rest));
            while let Some(open) = joined.trim_end().strip_suffix('\\') {
                let more = lines.next().map_or("", |(_, more)| uncommented(more));
                joined = Cow::Owned(format!("{open}{more}"));
            }
            joined
        } else if keyword.starts_with('#') {
            continue;
        } else {
            Cow::Borrowed(name(rest))
        };
        read(keyword, &rest).map_err(|error| Error { field: Some(format!("line {}", number + 1)), ..error })?;
    }
    Ok(())
}

fn uncommented(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// What stands before a comment: a `#` with space on both sides.
fn name(rest: &str) -> &str {
    let comment = rest.match_indices('#').find(|(at, _)| {
        let around = [rest[..*at].chars().next_back(), rest[at + 1..].chars().next()];
        around.iter().all(|c| c.is_none_or(char::is_whitespace))
    });
    rest[..comment.map_or(rest.len(), |(at, _)| at)].trim()
}
