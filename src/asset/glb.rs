//! The GLB container: a header, a JSON chunk, a binary chunk.

use crate::error::{Error, Result};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// What to try with files of the first version.
pub const CONVERT_1: &str = "convert it first, for example with `npx gltf-pipeline -i in.gltf -o out.glb`";

/// Whether `bytes` claim to be a GLB.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Bytes before the JSON of a GLB.
pub const BEFORE_JSON: u64 = 20;

/// How long the JSON is that begins after the first [`BEFORE_JSON`] bytes, where these are the start of a GLB.
pub fn json_length(start: &[u8]) -> Option<u64> {
    let length = start.get(12..16).filter(|_| is_glb(start))?;
    Some(u64::from(u32::from_le_bytes([length[0], length[1], length[2], length[3]])))
}

/// The JSON and binary chunks of a GLB, and what was odd about it.
///
/// # Errors
/// Names the part of the container that is missing, cut or contradictory.
pub fn parse<'a>(bytes: &'a [u8], warnings: &mut Vec<String>) -> Result<(&'a [u8], &'a [u8])> {
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(cut("GLB header", bytes.len(), 12));
    };
    if version != 2 {
        return Err(Error::input("only GLB version 2 can be read")
            .with_field("GLB version")
            .with_found(version)
            .with_expected("2")
            .with_hint(CONVERT_1));
    }
    if length as usize > bytes.len() {
        return Err(cut("GLB length", bytes.len(), length as usize));
    }
    if (length as usize) < bytes.len() {
        warnings.push(format!(
            "the GLB header gives a length of {length} bytes, the file has {}; read by its chunks",
            bytes.len()
        ));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (word(at), word(at + 4)) {
        let start = at + 8;
        let Some(chunk) = bytes.get(start..start.saturating_add(size as usize)) else {
            // Bytes after the stated length are not the container's: only a chunk within it must be whole.
            if start > length as usize && json.is_some() {
                break;
            }
            return Err(cut("GLB chunk length", bytes.len() - start, size as usize));
        };
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BIN if binary.is_none() => binary = Some(chunk),
            _ if start <= length as usize => warnings.push(format!("GLB chunk of unknown type {kind:#010x} left out")),
            _ => {}
        }
        at = start + size as usize;
    }
    let json = json.ok_or_else(|| {
        Error::input("the GLB has no JSON chunk")
            .with_field("GLB chunks")
            .with_found("none of type JSON")
            .with_expected("one")
    })?;
    Ok((json, binary.unwrap_or_default()))
}

fn cut(field: &str, found: usize, expected: usize) -> Error {
    Error::input("the file ends too early")
        .with_field(field)
        .with_found(format!("{found} bytes"))
        .with_expected(format!("{expected} bytes"))
        .with_hint("the file was cut; copy or export it again")
}

/// A GLB of a JSON text and a binary chunk, which is left out where empty.
///
/// # Errors
/// When the result would pass the format's 4 GiB.
pub fn assemble(json: &[u8], binary: &[u8]) -> Result<Vec<u8>> {
    let padded = |n: usize| n.div_ceil(4) * 4;
    let chunk = |n: usize| if n == 0 { 0 } else { 8 + padded(n) };
    let total = 12 + chunk(json.len()) + chunk(binary.len());
    let too_long = |_| {
        Error::new(crate::error::Kind::Output, "a GLB cannot hold more than 4 GiB")
            .with_found(format!("{total} bytes"))
            .with_hint("write .gltf instead, or lower `texture size`")
    };
    let length = u32::try_from(total).map_err(too_long)?;
    let mut out = Vec::with_capacity(total);
    out.extend_from_slice(MAGIC);
    out.extend_from_slice(&2_u32.to_le_bytes());
    out.extend_from_slice(&length.to_le_bytes());
    for (kind, bytes, filler) in [(JSON, json, b' '), (BIN, binary, 0)] {
        if bytes.is_empty() {
            continue;
        }
        out.extend_from_slice(&(padded(bytes.len()) as u32).to_le_bytes());
        out.extend_from_slice(&kind.to_le_bytes());
        out.extend_from_slice(bytes);
        out.resize(padded(out.len()), filler);
    }
    Ok(out)
}
