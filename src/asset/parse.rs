//! A glTF document from bytes: its buffers joined and decoded, and nothing left unchecked.

use super::document::Document;
use super::origin::Origin;
use super::{draco, glb, mend, meshopt, uri, validate};
use crate::error::{Error, Result};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Extensions that may be required: they are read here, or change nothing that matters to fur.
const UNDERSTOOD: [&str; 11] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "MSFT_texture_dds",
];

/// What is said of files of the first version.
const OF_VERSION_1: &str = "this is glTF 1.0, which is another format";

impl Document {
    /// Reads `.glb` or `.gltf` bytes; `path` names them and tells where their buffers lie.
    ///
    /// # Errors
    /// Names the field of the first fault: nothing that a later step relies on is left unchecked.
    pub fn parse(bytes: &[u8], path: &Path, warnings: &mut Vec<String>) -> Result<Self> {
        let (text, chunk) = if glb::is_glb(bytes) {
            glb::parse(bytes, warnings)?
        } else if bytes.first().is_some_and(|b| b"{ \n\r\t\xEF".contains(b)) {
            (bytes, &[][..])
        } else {
            let start: String = bytes.iter().take(4).map(|b| std::ascii::escape_default(*b).to_string()).collect();
            return Err(Error::input("this is not a glTF file")
                .with_field("first bytes")
                .with_found(if start.is_empty() { "an empty file".to_owned() } else { format!("`{start}`") })
                .with_expected("`glTF`, or `{` of a JSON text")
                .with_hint("inputs are .glb, .gltf and .obj"));
        };
        let json = mend::read(text, warnings)?;
        let folder = path.parent().map(|p| if p.as_os_str().is_empty() { PathBuf::from(".") } else { p.to_owned() });
        let (name, files) = (path.to_owned(), vec![path.to_owned()]);
        let mut document = Self { json, binary: Vec::new(), name, folder, files, origin: None };
        document.check_version()?;
        document.check_required()?;
        document.join_buffers(chunk)?;
        meshopt::decode(&mut document, warnings)?;
        draco::decode(&mut document, warnings)?;
        validate::document(&document)?;
        document.origin = Some(Origin::of(bytes, chunk, text.len(), &document.binary));
        Ok(document)
    }

    fn check_version(&self) -> Result<()> {
        let version = self.root().need("asset")?.need("version")?;
        // Some exporters write a number.
        let stated = version.value.as_str().map_or_else(|| version.value.to_string(), str::to_owned);
        if stated.starts_with("2.") || stated == "2" {
            return Ok(());
        }
        let fault = version.fault("2.0");
        if stated.starts_with('1') {
            return Err(Error { what: OF_VERSION_1.into(), ..fault }.with_hint(glb::CONVERT_1));
        }
        Err(fault.with_hint("export it as glTF 2.0"))
    }

    fn check_required(&self) -> Result<()> {
        for required in self.root().list("extensionsRequired")? {
            let name = required.text()?;
            if UNDERSTOOD.contains(&name) || name.starts_with("KHR_materials_") || name == "KHR_lights_punctual" {
                continue;
            }
            return Err(Error::input(format!("the file requires the extension {name}, which is not supported"))
                .with_field(required.path.clone())
                .with_found(name)
                .with_expected(format!("one of {}, or KHR_materials_*", UNDERSTOOD.join(", ")))
                .with_hint("export without this extension, or as optional"));
        }
        Ok(())
    }

    /// Brings all buffers into `binary`, one behind the other, and points the buffer views there.
    fn join_buffers(&mut self, chunk: &[u8]) -> Result<()> {
        let mut starts = Vec::new();
        let (mut binary, mut files) = (Vec::new(), Vec::new());
        for (i, buffer) in self.root().list("buffers")?.iter().enumerate() {
            let length_at = buffer.need("byteLength")?;
            let length = length_at.size()?;
            let bytes: Vec<u8> = match buffer.get("uri") {
                Some(at) => match uri::resolve(at.text()?, self.folder.as_deref(), &at.path)? {
                    uri::Target::Data { base64 } => uri::decode_base64(base64, &at.path)?,
                    uri::Target::File(path) => {
                        files.push(path.clone());
                        uri::read_file(&path).map_err(|e| Error { field: Some(at.path.clone()), ..e })?
                    }
                },
                // Stands for what EXT_meshopt_compression decodes to.
                None if meshopt::is_fallback(buffer) && (i > 0 || chunk.is_empty()) => {
                    starts.push((usize::MAX, length));
                    continue;
                }
                None if i == 0 => chunk.to_vec(),
                None => return Err(buffer.fault("a uri")),
            };
            let Some(bytes) = bytes.get(..length) else {
                return Err(Error::input("a buffer is shorter than it says")
                    .with_field(length_at.path)
                    .with_found(format!("{} bytes of data", bytes.len()))
                    .with_expected(format!("{length} bytes"))
                    .with_hint("the file was cut; copy or export it again"));
            };
            binary.resize(usize::next_multiple_of(binary.len(), 8), 0);
            starts.push((binary.len(), length));
            binary.extend_from_slice(bytes);
            if binary.len() as u64 > uri::MAX_FILE_BYTES {
                return Err(buffer.fault("buffers of at most 1 GiB in all"));
            }
        }
        let moved = self.moved_views(&starts)?;
        if let Some(views) = self.json.get_mut("bufferViews").and_then(Value::as_array_mut) {
            for (view, offset) in views.iter_mut().zip(moved) {
                if let Some(offset) = offset {
                    view["buffer"] = json!(0);
                    view["byteOffset"] = json!(offset);
                }
            }
        }
        if let Some(buffers) = self.json.get_mut("buffers").and_then(Value::as_array_mut) {
            buffers.truncate(1);
            if let Some(buffer) = buffers.first_mut().and_then(Value::as_object_mut) {
                buffer.shift_remove("uri");
                buffer.insert("byteLength".into(), json!(binary.len()));
            }
        }
        self.binary = binary;
        self.files.extend(files);
        Ok(())
    }

    /// Per buffer view: its new offset where it moves.
    fn moved_views(&self, starts: &[(usize, usize)]) -> Result<Vec<Option<usize>>> {
        let mut moved = Vec::new();
        for view in self.root().list("bufferViews")? {
            let buffer = view.need("buffer")?.index_into("buffers", starts.len())?;
            let (start, length) = starts[buffer];
            let offset = view.size_or("byteOffset", 0)?;
            let size_at = view.need("byteLength")?;
            if offset.checked_add(size_at.size()?).is_none_or(|end| end > length) {
                return Err(Error::input("a buffer view reaches beyond its buffer")
                    .with_field(size_at.path.clone())
                    .with_found(format!("{} bytes from byte {offset}", size_at.size()?))
                    .with_expected(format!("within the {length} bytes of buffers[{buffer}]"))
                    .with_hint("the file was cut or written by a faulty exporter; export it again"));
            }
            if start == usize::MAX && !meshopt::is_compressed(&view) {
                return Err(view.need("buffer")?.fault("a buffer with data: nothing decodes to this view"));
            }
            moved.push((buffer > 0 && start != usize::MAX).then(|| start + offset));
        }
        Ok(moved)
    }
}
