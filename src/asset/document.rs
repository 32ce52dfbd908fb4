//! A glTF document in memory: its JSON as it was written, and one binary buffer.

use super::glb;
use super::json::At;
use super::origin::Origin;
use crate::error::{Error, Result};
use serde_json::{Value, json};
use std::path::PathBuf;

/// glTF JSON, order kept, and the bytes of all its buffers in one.
#[derive(Clone, Debug)]
pub struct Document {
    /// The JSON. Its only buffer, if any, is `binary`.
    pub json: Value,
    /// The buffer.
    pub binary: Vec<u8>,
    /// What messages call the input.
    pub name: PathBuf,
    /// Where files named by URIs lie; none for meshes made in code.
    pub folder: Option<PathBuf>,
    /// Every file that was read.
    pub files: Vec<PathBuf>,
    /// The bytes of the glTF file that it was read from; none for what was made of something else.
    pub origin: Option<Origin>,
}

impl Document {
    /// An empty document for meshes made in code.
    pub fn made(name: &str) -> Self {
        let json = json!({"asset": {"version": "2.0", "generator": "furrier"}});
        Self { json, binary: Vec::new(), name: PathBuf::from(name), folder: None, files: Vec::new(), origin: None }
    }

    pub(super) fn root(&self) -> At<'_> {
        At::root(&self.json)
    }

    /// The document as GLB.
    ///
    /// # Errors
    /// When it would pass the format's 4 GiB.
    pub fn to_glb(&self) -> Result<Vec<u8>> {
        let json = serde_json::to_vec(&self.json)
            .map_err(|error| Error::new(crate::error::Kind::Output, format!("the JSON cannot be written: {error}")))?;
        glb::assemble(&json, &self.binary)
    }

    /// How many entries the top-level array `key` has.
    pub fn count(&self, key: &str) -> usize {
        self.json.get(key).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Appends `value` to the top-level array `key`, creating it, and gives its index.
    pub fn push(&mut self, key: &str, value: Value) -> usize {
        if let Some(root) = self.json.as_object_mut() {
            let list = root.entry(key).or_insert_with(|| Value::Array(Vec::new()));
            if let Some(list) = list.as_array_mut() {
                list.push(value);
                return list.len() - 1;
            }
        }
        0
    }

    /// Names an extension among those used, once.
    pub fn use_extension(&mut self, name: &str) {
        let named =
            self.json.get("extensionsUsed").and_then(Value::as_array).is_some_and(|used| used.contains(&json!(name)));
        if !named {
            self.push("extensionsUsed", json!(name));
        }
    }

    /// Strikes an extension off the lists of those used and required.
    pub fn forget_extension(&mut self, name: &str) {
        let Some(root) = self.json.as_object_mut() else { return };
        for key in ["extensionsRequired", "extensionsUsed"] {
            if let Some(list) = root.get_mut(key).and_then(Value::as_array_mut) {
                list.retain(|used| used != name);
                if list.is_empty() {
                    root.shift_remove(key);
                }
            }
        }
    }

    /// Appends bytes to the buffer, aligned to 8, as a new buffer view, and gives its index.
    pub fn push_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(8), 0);
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        if self.count("buffers") == 0 {
            self.push("buffers", json!({}));
        }
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        self.push("bufferViews", view)
    }
}

/// Removes an extension from what carries it.
pub(super) fn drop_extension(owner: &mut Value, name: &str) {
    if let Some(extensions) = owner.get_mut("extensions").and_then(Value::as_object_mut) {
        extensions.shift_remove(name);
        if extensions.is_empty() {
            owner.as_object_mut().and_then(|object| object.shift_remove("extensions"));
        }
    }
}
