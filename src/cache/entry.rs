//! A value's file: magic, format, epoch, key, hash, length, and the value compressed by Zstandard.

use super::key::{EPOCH, FORMAT};
use std::io::Result;

const MAGIC: [u8; 8] = *b"FURCACHE";
/// Where what the hash is of begins: behind magic and hash.
const HASHED: usize = 8 + 32;
/// Where the value begins: behind format, epoch, key and the value's length too.
const VALUE: usize = HASHED + 4 + 16 + 32 + 8;
/// Zstandard's level: higher ones cost more than they save.
const EFFORT: i32 = 1;

/// The file of `value`, which `key` names.
///
/// # Errors
/// Where it cannot be compressed.
pub fn bytes(value: &[u8], key: &[u8; 32]) -> Result<Vec<u8>> {
    let packed = zstd::bulk::compress(value, EFFORT)?;
    let mut file = Vec::with_capacity(VALUE + packed.len());
    file.extend(MAGIC);
    file.extend([0; 32]);
    file.extend(FORMAT.to_le_bytes());
    file.extend(EPOCH.as_bytes());
    file.extend(key);
    file.extend((value.len() as u64).to_le_bytes());
    file.extend(packed);
    let hash = blake3::hash(&file[HASHED..]);
    file[8..HASHED].copy_from_slice(hash.as_bytes());
    Ok(file)
}

/// The value in a file that `key` names, or what is wrong with the file.
pub fn value(file: &[u8], key: &[u8; 32]) -> std::result::Result<Vec<u8>, String> {
    if file.len() < VALUE {
        return Err(format!("it has {} bytes, fewer than any value", file.len()));
    }
    if file[..8] != MAGIC {
        return Err("it is no file of a cache".into());
    }
    if blake3::hash(&file[HASHED..]).as_bytes() != &file[8..HASHED] {
        return Err("its hash is not that of what it holds".into());
    }
    if file[HASHED + 20..HASHED + 52] != key[..] {
        return Err("it holds the value of another key".into());
    }
    let length = file[HASHED + 52..VALUE].iter().rev().fold(0, |length, byte| length << 8 | u64::from(*byte));
    let length = usize::try_from(length).map_err(|error| error.to_string())?;
    zstd::bulk::decompress(&file[VALUE..], length).map_err(|error| error.to_string())
}

/// Whether the start of a file says that this build's code made it.
pub fn is_of_this_build(start: &[u8]) -> bool {
    start.get(..8) == Some(&MAGIC)
        && start.get(HASHED..HASHED + 4) == Some(&FORMAT.to_le_bytes())
        && start.get(HASHED + 4..HASHED + 20) == Some(EPOCH.as_bytes())
}

/// How much of a file [`is_of_this_build`] looks at, bytes.
pub const START: usize = HASHED + 20;
