//! JSON as exporters write it: what is wrong with the text alone is mended, and said.

use super::text;
use crate::error::{Error, Result};
use serde_json::Value;

/// Chunks begin at multiples of 4 bytes, in some programs of 8.
const MOST_PADDING: usize = 7;

/// Reads the JSON of a file.
///
/// # Errors
/// Where it is no JSON even so.
pub fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Value> {
    let end = bytes.iter().rposition(|byte| !b"\0 \t\r\n".contains(byte)).map_or(0, |last| last + 1);
    let zeros = bytes[end..].iter().filter(|&&byte| byte == 0).count();
    if zeros > 0 {
        warnings.push(format!("the JSON is padded with {zeros} zeros, where the format has spaces; left out"));
    }
    let bytes = bytes[..end].strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes[..end]);
    let unread = match serde_json::from_slice(bytes) {
        Ok(json) => return Ok(json),
        Err(error) => error,
    };
    if let Some((json, behind)) = padded_otherwise(bytes) {
        warnings
            .push(format!("the JSON is padded with {behind} bytes of anything, where the format has spaces; left out"));
        return Ok(json);
    }
    let (decoded, odd) = text::decode(bytes);
    let (mended, halves) = whole_characters(&decoded);
    let (mended, raw) = escaped(&mended);
    let named = |text: &str, places: &[usize]| {
        let mut names: Vec<String> = places.iter().map(|&at| around(text, at)).collect();
        names.dedup();
        names.truncate(5);
        names.join(", ")
    };
    let json = serde_json::from_str(&mended).map_err(|_| {
        Error::input("the JSON cannot be read")
            .with_field("JSON")
            .with_found(unread)
            .with_expected("valid JSON, nested at most 127 deep")
            .with_hint("the file is damaged or its exporter faulty; export it again")
    })?;
    if !odd.is_empty() {
        let names = named(&decoded, &odd);
        warnings
            .push(format!("{} bytes of the JSON are not UTF-8; read as Latin-1, and so written: {names}", odd.len()));
    }
    if !halves.is_empty() {
        let names = named(&mended, &halves);
        warnings.push(format!("{} characters of the JSON are half a surrogate pair; replaced: {names}", halves.len()));
    }
    if !raw.is_empty() {
        let names = named(&mended, &raw);
        warnings.push(format!(
            "{} characters of the JSON must not stand in a text as they do; escaped: {names}",
            raw.len()
        ));
    }
    Ok(json)
}

/// JSON with less behind it than a chunk is padded with, and how many bytes that are.
fn padded_otherwise(bytes: &[u8]) -> Option<(Value, usize)> {
    let mut values = serde_json::Deserializer::from_slice(bytes).into_iter::<Value>();
    let json = values.next()?.ok()?;
    let behind = bytes.len() - values.byte_offset();
    (json.is_object() && behind <= MOST_PADDING).then_some((json, behind))
}

/// Escapes control characters within texts, such as tabs, and says where.
fn escaped(text: &str) -> (String, Vec<usize>) {
    let (mut escaped, mut places) = (String::with_capacity(text.len()), Vec::new());
    let (mut within, mut behind) = (false, false);
    for c in text.chars() {
        if within && c < ' ' {
            places.push(escaped.len());
            escaped.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            escaped.push(c);
        }
        within ^= c == '"' && !behind;
        behind = within && c == '\\' && !behind;
    }
    (escaped, places)
}

/// Replaces escapes that stand for one half of a surrogate pair, and says where.
fn whole_characters(text: &str) -> (String, Vec<usize>) {
    let unit = |at: usize| {
        let escape = text.get(at..at + 6).filter(|escape| escape.starts_with("\\u"))?;
        u16::from_str_radix(&escape[2..], 16).ok()
    };
    let (mut mended, mut places) = (String::with_capacity(text.len()), Vec::new());
    let (mut from, mut at) = (0, 0);
    while let Some(found) = text[at..].find('\\') {
        at += found;
        match unit(at) {
            Some(0xD800..=0xDBFF) if matches!(unit(at + 6), Some(0xDC00..=0xDFFF)) => at += 12,
            Some(0xD800..=0xDFFF) => {
                mended.push_str(&text[from..at]);
                places.push(mended.len());
                mended.push_str("\\uFFFD");
                at += 6;
                from = at;
            }
            // The character behind a backslash may be one itself.
            _ => at += 1 + text[at + 1..].chars().next().map_or(0, char::len_utf8),
        }
    }
    mended.push_str(&text[from..]);
    (mended, places)
}

/// The string that a place of a JSON text is in.
fn around(text: &str, at: usize) -> String {
    let start = text[..at].rfind('"').map_or(0, |quote| quote + 1);
    let end = text[at..].find('"').map_or(text.len(), |quote| at + quote);
    text[start..end].chars().take(60).collect()
}
