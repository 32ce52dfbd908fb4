//! Bytes and texts changed at random.

use furrier::math::hash::Stream;

/// What is often handled wrongly where a number stands.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1e999",
    "-1e-999",
    "nan",
    "inf",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "0x10",
    "1.",
    ".",
    "-",
    "1e",
];
/// Words that mean something in one of the formats.
const WORDS: [&str; 28] = [
    "f 1 2 3\n",
    "f -1 -2 -3\n",
    "f 1/1/1 2// 3/\n",
    "v 1 2\n",
    "vt\n",
    "vn 0 0 0\n",
    "usemtl x y\n",
    "mtllib ../a.mtl\n",
    "newmtl \n",
    "map_Kd -s 1 1 1 a b.png\n",
    "Kd 1 2\n",
    "\\\n",
    "#\\\n",
    "[[",
    "]]",
    "{}",
    "[guard]\n",
    "length = { mm = 1 }\n",
    "\"",
    "'''",
    "\u{FEFF}",
    "\r",
    "\0",
    "/",
    "\\",
    "%2e%2e/",
    "data:;base64,",
    "\t",
];
/// 32-bit words that sizes and offsets go wrong with.
const WORDS_32: [u32; 8] = [0, 1, 0x7FFF_FFFF, 0x8000_0000, 0xFFFF_FFFF, 0xFFFF_FFFE, 0x0001_0000, 0x4000_0001];

/// Some bytes changed, taken out, doubled, or cut off.
pub fn bytes(seed: &[u8], stream: &mut Stream) -> Vec<u8> {
    let mut out = seed.to_vec();
    for _ in 0..1 + stream.bits() % 4 {
        let at = |stream: &mut Stream, out: &[u8]| stream.bits() as usize % out.len().max(1);
        let from = at(stream, &out);
        let until = (from + 1 + stream.bits() as usize % 32).min(out.len());
        match stream.bits() % 7 {
            0 if !out.is_empty() => out[from] ^= 1 << (stream.bits() % 8),
            1 if !out.is_empty() => out[from] = stream.bits() as u8,
            2 => out.truncate(from),
            3 => drop(out.drain(from..until)),
            4 => {
                let piece = out[from.min(until)..until].to_vec();
                let to = at(stream, &out);
                out.splice(to..to, piece);
            }
            // Headers are at the front.
            n => {
                let length = if n == 5 { out.len().min(128) } else { out.len() };
                let to = (stream.bits() as usize % length.max(1)) & !3;
                let word = WORDS_32[stream.bits() as usize % WORDS_32.len()];
                let word = if stream.bits().is_multiple_of(2) { word.to_le_bytes() } else { word.to_be_bytes() };
                if let Some(place) = out.get_mut(to..to + 4) {
                    place.copy_from_slice(&word);
                }
            }
        }
    }
    out
}

/// Some numbers replaced, words put in, lines taken out, doubled or exchanged; or bytes changed.
pub fn text(seed: &str, stream: &mut Stream) -> Vec<u8> {
    if stream.bits().is_multiple_of(4) {
        return bytes(seed.as_bytes(), stream);
    }
    let mut out = seed.to_owned();
    for _ in 0..1 + stream.bits() % 5 {
        let mut lines: Vec<&str> = out.split_inclusive('\n').collect();
        let line = stream.bits() as usize % lines.len().max(1);
        let next = match stream.bits() % 6 {
            0 if !lines.is_empty() => {
                lines.remove(line);
                lines.concat()
            }
            1 if !lines.is_empty() => {
                let other = stream.bits() as usize % lines.len();
                lines.swap(line, other);
                lines.concat()
            }
            2 if !lines.is_empty() => {
                lines.insert(line, lines[line]);
                lines.concat()
            }
            3 => {
                let mut place = stream.bits() as usize % (out.len() + 1);
                while !out.is_char_boundary(place) {
                    place -= 1;
                }
                let word = WORDS[stream.bits() as usize % WORDS.len()];
                format!("{}{word}{}", &out[..place], &out[place..])
            }
            _ => number_replaced(&out, stream),
        };
        out = next;
    }
    out.into_bytes()
}

/// A number of the text replaced by one that seldom fits.
fn number_replaced(text: &str, stream: &mut Stream) -> String {
    let of_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let starts: Vec<usize> = (text.char_indices().zip(std::iter::once(' ').chain(text.chars())))
        .filter(|((_, c), before)| of_number(*c) && !of_number(*before))
        .map(|((at, _), _)| at)
        .collect();
    if starts.is_empty() {
        return text.to_owned();
    }
    let start = starts[stream.bits() as usize % starts.len()];
    let end = text[start..].find(|c| !of_number(c)).map_or(text.len(), |length| start + length);
    let number = NUMBERS[stream.bits() as usize % NUMBERS.len()];
    format!("{}{number}{}", &text[..start], &text[end..])
}
