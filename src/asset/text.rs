//! Text out of bytes as people's programs write them.

use std::borrow::Cow;

/// Decodes a text file: UTF-8 with or without a byte order mark, or UTF-16 with one. Bytes that are not UTF-8 are taken as Latin-1;
/// the second value says where in the text they came to lie.
pub fn decode(bytes: &[u8]) -> (Cow<'_, str>, Vec<usize>) {
    let wide = |order: fn([u8; 2]) -> u16, bytes: &[u8]| {
        let units: Vec<u16> = bytes.as_chunks::<2>().0.iter().map(|pair| order(*pair)).collect();
        (Cow::Owned(String::from_utf16_lossy(&units)), Vec::new())
    };
    match bytes {
        [0xFF, 0xFE, rest @ ..] => return wide(u16::from_le_bytes, rest),
        [0xFE, 0xFF, rest @ ..] => return wide(u16::from_be_bytes, rest),
        _ => {}
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if let Ok(text) = str::from_utf8(bytes) {
        return (Cow::Borrowed(text), Vec::new());
    }
    let (mut text, mut places) = (String::with_capacity(bytes.len()), Vec::new());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        for &byte in chunk.invalid() {
            places.push(text.len());
            text.push(char::from(byte));
        }
    }
    (Cow::Owned(text), places)
}
