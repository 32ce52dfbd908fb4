//! The bytes of an input file, told apart into what its document keeps anyway and the rest.

use crate::math::hash;

/// An input file: bytes, then the first `kept` bytes of the document's buffer, then bytes again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Of a GLB all up to its binary data, of a .gltf the whole text.
    pub before: Vec<u8>,
    /// How much of the document's buffer is in the file as it is, bytes.
    pub kept: usize,
    /// Padding, and chunks of unknown kinds.
    pub after: Vec<u8>,
    /// Length of the JSON, bytes.
    pub json: usize,
    /// [`hash::bytes`] of the file.
    pub hash: u64,
}

impl Origin {
    /// Of `file`, whose binary chunk is `chunk`, a part of it, and whose JSON has `json` bytes. `binary` is the buffer that
    /// the document made of it; whatever reading did to it, what is still as in the file is found by comparing.
    pub fn of(file: &[u8], chunk: &[u8], json: usize, binary: &[u8]) -> Self {
        let kept = chunk.iter().zip(binary).take_while(|(in_file, kept)| in_file == kept).count();
        let start = if kept == 0 { file.len() } else { chunk.as_ptr().addr() - file.as_ptr().addr() };
        Self {
            before: file[..start].to_vec(),
            kept,
            after: file[start + kept..].to_vec(),
            json,
            hash: hash::bytes(file),
        }
    }

    /// The file, put together with a buffer that starts as the document's did; none where it no longer does.
    pub fn whole(&self, binary: &[u8]) -> Option<Vec<u8>> {
        let file = [&self.before, binary.get(..self.kept)?, &self.after].concat();
        (hash::bytes(&file) == self.hash).then_some(file)
    }
}
