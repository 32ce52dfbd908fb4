//! The input file inside the baked one: what the output's buffer does not hold anyway, compressed, and two hashes.

use super::NAME;
use crate::asset::document::Document;
use crate::asset::glb::{self, is_glb};
use crate::asset::json::At;
use crate::asset::mend;
use crate::asset::origin::Origin;
use crate::error::{Error, Kind, Result};
use crate::math::hash;
use serde_json::{Value, json};
use std::io::Read;
use std::path::Path;

/// What may be stored beside as many bytes as the input's JSON has. A kilobyte of 4 is left for what describes it.
const MOST_BESIDE_JSON: usize = 3 << 10;
/// Most bytes that are stored or unpacked.
const MOST_BYTES: usize = 1 << 28;
/// Level of compression.
const EFFORT: i32 = 12;

/// Adds to a document with a coat what gives its input back, and seals it: call it when all else is as it will be
/// written. Gives a sentence where the input cannot be given back.
///
/// # Errors
/// When the JSON cannot be encoded.
pub fn store(document: &mut Document) -> Result<Option<String>> {
    let Some(origin) = document.origin.clone() else { return Ok(None) };
    let rest = [&origin.before[..], &origin.after].concat();
    let packed = zstd::bulk::compress(&rest, EFFORT)
        .map_err(|error| Error::new(Kind::Output, format!("the input's JSON cannot be compressed: {error}")))?;
    if packed.len() > origin.json + MOST_BESIDE_JSON
        || rest.len() > MOST_BYTES
        || origin.whole(&document.binary).is_none()
    {
        return Ok(Some(format!(
            "{} bytes of the input are neither its JSON nor the data that it names, too many to keep: `furrier strip` will \
             take the coat off, but not give back the input's bytes",
            rest.len().saturating_sub(origin.json)
        )));
    }
    let view = document.push_view(&packed, None);
    document.json["extensions"][NAME]["input"] = json!({
        "bufferView": view,
        "before": origin.before.len(),
        "kept": origin.kept,
        "after": origin.after.len(),
        "hash": text(origin.hash),
    });
    let seal = seal(document)?;
    document.json["extensions"][NAME]["input"]["seal"] = json!(text(seal));
    Ok(None)
}

/// What became of the input that a file with a coat was baked from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// Its bytes.
    Whole(Vec<u8>),
    /// They are not there, for this reason.
    Lost(&'static str),
}

/// Gives the input back, if the file is as it was baked.
///
/// # Errors
/// Names what is wrong with the stored piece.
pub fn give_back(document: &Document) -> Result<Input> {
    let root = document.root();
    let Some(extension) = root.get("extensions").and_then(|e| e.get(NAME)) else {
        return Ok(Input::Lost("another program dropped the extension"));
    };
    let Some(stored) = extension.get("input") else {
        return Ok(Input::Lost(
            "the file holds nothing of its input: that was an OBJ or a built-in mesh, or an older version baked it",
        ));
    };
    let mut unsealed = document.json.clone();
    let seal_at = stored.need("seal")?;
    if let Some(input) = unsealed["extensions"][NAME]["input"].as_object_mut() {
        input.shift_remove("seal");
    }
    if parse(&seal_at)? != hash_of(&unsealed, &document.binary)? {
        return Ok(Input::Lost("the file was changed after it was baked"));
    }
    let [before, kept, after] = ["before", "kept", "after"].map(|key| stored.need(key).and_then(|at| at.size()));
    let (before, kept, after) = (before?, kept?, after?);
    let view = stored.need("bufferView")?;
    let mut rest = unpack(document.view(view.size()?)?).ok_or_else(|| view.fault("a view of whole Zstandard data"))?;
    if before.checked_add(after) != Some(rest.len()) {
        return Err(stored.need("before")?.fault(&format!("with `after` {} bytes", rest.len())));
    }
    let after = rest.split_off(before);
    let origin = Origin { before: rest, kept, after, json: 0, hash: parse(&stored.need("hash")?)? };
    let whole =
        origin.whole(&document.binary).ok_or_else(|| stored.fault("the pieces of the input that was hashed"))?;
    Ok(Input::Whole(whole))
}

/// Says which files a glTF names that do not lie beside `out`, where its bytes go.
///
/// # Errors
/// When its JSON cannot be read.
pub fn files_beside(bytes: &[u8], out: &Path) -> Result<Option<String>> {
    let text = if is_glb(bytes) { glb::parse(bytes, &mut Vec::new())?.0 } else { bytes };
    // As it was read when it was baked: what was odd about it was said then.
    let json = mend::read(text, &mut Vec::new())?;
    let root = At::root(&json);
    let owners = [root.list("buffers")?, root.list("images")?].concat();
    let named = owners.iter().filter_map(|owner| owner.value["uri"].as_str()).filter(|uri| !uri.starts_with("data:"));
    let folder = out.parent().unwrap_or(Path::new(""));
    let missing = |uri: &&str| {
        let path = percent_encoding::percent_decode_str(uri).decode_utf8_lossy();
        !folder.join(path.as_ref()).exists()
    };
    let missing: Vec<&str> = named.filter(missing).collect();
    Ok((!missing.is_empty()).then(|| {
        format!("the file names {}, not part of it: copy them from beside the input that was baked", missing.join(", "))
    }))
}

fn unpack(packed: &[u8]) -> Option<Vec<u8>> {
    let mut rest = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(packed).ok()?;
    decoder.take(MOST_BYTES as u64).read_to_end(&mut rest).ok()?;
    Some(rest)
}

/// The hash of a document as it is.
fn seal(document: &Document) -> Result<u64> {
    hash_of(&document.json, &document.binary)
}

fn hash_of(json: &Value, binary: &[u8]) -> Result<u64> {
    let text = serde_json::to_vec(json)
        .map_err(|error| Error::new(Kind::Output, format!("the JSON cannot be written: {error}")))?;
    Ok(hash::combine(hash::bytes(&text), hash::bytes(binary)))
}

/// A hash as the file says it: JSON's numbers are not exact in every program.
fn text(hash: u64) -> String {
    format!("{hash:016x}")
}

fn parse(at: &At<'_>) -> Result<u64> {
    u64::from_str_radix(at.text()?, 16).map_err(|_| at.fault("16 hexadecimal digits"))
}
