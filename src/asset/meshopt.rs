//! Decodes EXT_meshopt_compression, so that everything downstream sees plain buffer views.

use super::document::{Document, drop_extension};
use super::json::At;
use crate::error::{Error, Result};
use bytemuck::{Pod, cast_slice, cast_slice_mut};
use serde_json::json;

const NAME: &str = "EXT_meshopt_compression";

/// Most bytes all compressed views may decode to.
const MAX_BYTES: usize = 1 << 29;

/// Whether a buffer without data stands for decoded data.
pub fn is_fallback(buffer: &At<'_>) -> bool {
    buffer.get("extensions").and_then(|e| e.get(NAME)?.get("fallback")).is_some_and(|f| f.value == &json!(true))
}

/// Whether a buffer view is what compressed data decode to.
pub fn is_compressed(view: &At<'_>) -> bool {
    view.get("extensions").is_some_and(|e| e.get(NAME).is_some())
}

/// Replaces every compressed buffer view by what it decodes to and drops the extension.
///
/// # Errors
/// Names the view whose stream or description is broken.
pub fn decode(document: &mut Document, warnings: &mut Vec<String>) -> Result<()> {
    let mut decoded = Vec::new();
    let mut total = 0_usize;
    for (i, view) in document.root().list("bufferViews")?.iter().enumerate() {
        let Some(extension) = view.get("extensions").and_then(|e| e.get(NAME)) else { continue };
        let bytes = decode_view(document, view, &extension, &mut total)?;
        decoded.push((i, bytes));
    }
    if decoded.is_empty() {
        return Ok(());
    }
    warnings
        .push(format!("{} buffer views were decoded from {NAME}; the output holds them uncompressed", decoded.len()));
    for (i, bytes) in decoded {
        document.binary.resize(document.binary.len().next_multiple_of(8), 0);
        let offset = document.binary.len();
        document.binary.extend_from_slice(&bytes);
        let view = &mut document.json["bufferViews"][i];
        view["buffer"] = json!(0);
        view["byteOffset"] = json!(offset);
        drop_extension(view, NAME);
    }
    document.json["buffers"][0]["byteLength"] = json!(document.binary.len());
    drop_extension(&mut document.json["buffers"][0], NAME);
    document.forget_extension(NAME);
    Ok(())
}

fn decode_view(document: &Document, view: &At<'_>, extension: &At<'_>, total: &mut usize) -> Result<Vec<u8>> {
    let (stride_at, count_at) = (extension.need("byteStride")?, extension.need("count")?);
    let (stride, count) = (stride_at.size()?, count_at.size()?);
    let length = view.need("byteLength")?.size()?;
    extension.need("buffer")?.index_into("buffers", 1)?;
    let start = extension.size_or("byteOffset", 0)?;
    let size_at = extension.need("byteLength")?;
    let encoded = size_at
        .size()?
        .checked_add(start)
        .and_then(|end| document.binary.get(start..end))
        .ok_or_else(|| size_at.fault("a range within the buffer"))?;
    *total = total.saturating_add(length);
    // No stream of the codec shrinks data by more than 1024, so that a short stream cannot claim much memory.
    if count.checked_mul(stride) != Some(length) || *total > MAX_BYTES || length / 2048 > encoded.len() {
        return Err(count_at.fault(&format!("count × byteStride to be the view's {length} bytes")));
    }
    let mode = extension.need("mode")?;
    let filter = extension.get("filter");
    let filter = filter.as_ref().map_or(Ok("NONE"), At::text)?;
    let broken = |error: meshopt::Error| {
        Error::input(format!("a compressed buffer view cannot be decoded: {error}"))
            .with_field(extension.path.clone())
            .with_found(format!("a broken {NAME} stream"))
            .with_expected("a whole stream")
            .with_hint("compress the file again")
    };
    let mut bytes = match (mode.text()?, stride) {
        ("ATTRIBUTES", _) => {
            attributes(encoded, count, stride).ok_or_else(|| stride_at.fault("4 to 128, by 4"))?.map_err(broken)?
        }
        ("TRIANGLES", _) if !count.is_multiple_of(3) => return Err(count_at.fault("a multiple of 3")),
        ("TRIANGLES", 2) => words(meshopt::decode_index_buffer::<u16>(encoded, count)).map_err(broken)?,
        ("TRIANGLES", 4) => words(meshopt::decode_index_buffer::<u32>(encoded, count)).map_err(broken)?,
        ("INDICES", 2) => words(meshopt::decode_index_sequence::<u16>(encoded, count)).map_err(broken)?,
        ("INDICES", 4) => words(meshopt::decode_index_sequence::<u32>(encoded, count)).map_err(broken)?,
        ("TRIANGLES" | "INDICES", _) => return Err(stride_at.fault("2 or 4")),
        _ => return Err(mode.fault("ATTRIBUTES, TRIANGLES or INDICES")),
    };
    match (filter, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => meshopt::decode_filter_oct::<i8>(cast_slice_mut(&mut bytes)),
        ("OCTAHEDRAL", 8) => filtered::<[i16; 4]>(&mut bytes, meshopt::decode_filter_oct::<i16>),
        ("QUATERNION", 8) => filtered::<[i16; 4]>(&mut bytes, meshopt::decode_filter_quat),
        ("EXPONENTIAL", n) if n % 4 == 0 => filtered::<[u32; 1]>(&mut bytes, meshopt::decode_filter_exp::<1>),
        _ => return Err(extension.fault("a filter that fits the byteStride")),
    }
    Ok(bytes)
}

/// Runs a filter over a copy that is aligned as its elements are.
fn filtered<T: Pod>(bytes: &mut [u8], filter: impl Fn(&mut [T])) {
    let mut items: Vec<T> = bytemuck::pod_collect_to_vec(bytes);
    filter(&mut items);
    bytes.copy_from_slice(cast_slice(&items));
}

fn words<T: Pod>(decoded: meshopt::Result<Vec<T>>) -> meshopt::Result<Vec<u8>> {
    decoded.map(|list| cast_slice(&list).to_vec())
}

/// Vertex data of a stride known only at run time; the codec's binding wants it as a type.
fn attributes(encoded: &[u8], count: usize, stride: usize) -> Option<meshopt::Result<Vec<u8>>> {
    macro_rules! by_words {
        ($($words:literal)*) => {
            match stride {
                $(n if n == 4 * $words => Some(words(meshopt::decode_vertex_buffer::<[u32; $words]>(encoded, count))),)*
                _ => None,
            }
        };
    }
    by_words!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32)
}
