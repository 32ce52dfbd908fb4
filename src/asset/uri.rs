//! Resolves URIs: data URIs, and files inside the input's own folder. Nothing else is ever opened.

use crate::error::{Error, Result};
use base64::Engine;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Longest file that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// What a URI stands for.
pub enum Target<'a> {
    /// The text after the comma, still in base64.
    Data { base64: &'a str },
    /// A file below the input's folder.
    File(PathBuf),
}

/// Sorts a URI, given the input's folder.
///
/// # Errors
/// Names URIs with a scheme, absolute paths and paths that leave the folder.
pub fn resolve<'a>(uri: &'a str, folder: Option<&Path>, field: &str) -> Result<Target<'a>> {
    let refuse = |what: &str, hint: &str| {
        let shown: String = uri.chars().take(80).collect();
        Err(Error::input(what)
            .with_field(field)
            .with_found(shown)
            .with_expected("a data URI, or a file inside the input's folder")
            .with_hint(hint))
    };
    if let Some(rest) = uri.strip_prefix("data:") {
        let Some((_, base64)) = rest.split_once(";base64,") else {
            return refuse("a data URI is not in base64", "export again with embedded buffers in base64, or as GLB");
        };
        return Ok(Target::Data { base64 });
    }
    let scheme = uri.split_once(':').is_some_and(|(scheme, _)| !scheme.contains(['/', '?', '#']));
    if scheme {
        return refuse(
            "nothing is fetched from elsewhere",
            "put the file beside the input and name it by its file name",
        );
    }
    let Ok(path) = percent_encoding::percent_decode_str(uri).decode_utf8() else {
        return refuse("a URI is not UTF-8", "rename the file to plain letters");
    };
    // Programs on Windows write their own separator.
    let path = path.replace('\\', "/");
    let plain = |name: &str| !matches!(name, "" | "." | "..") && !name.contains([':', '\0']);
    if !path.split('/').filter(|name| *name != ".").all(plain) {
        return refuse("a URI leaves the input's folder", "put the file beside the input and name it by its file name");
    }
    let Some(folder) = folder else {
        return refuse("a made-up mesh has no folder to read from", "use a file as input");
    };
    let full = folder.join(&path);
    // A link may point out of the folder even where the name does not.
    if let (Ok(inside), Ok(real)) = (folder.canonicalize(), full.canonicalize())
        && !real.starts_with(&inside)
    {
        return refuse("a link leaves the input's folder", "copy the file it points to into the folder");
    }
    Ok(Target::File(full))
}

/// Finds a file that an older format names as its writer's disk had it: separators of either kind, letters in another case, a folder
/// of another machine. Gives its path below `folder`, outside of which nothing is looked for.
pub fn find(name: &str, folder: &Path) -> Option<String> {
    let name = name.trim().trim_matches('"').replace('\\', "/");
    let last = name.rsplit('/').next()?;
    let inside =
        |path: &String| matches!(resolve(&encode(path), Some(folder), ""), Ok(Target::File(full)) if full.is_file());
    [name.as_str(), last].into_iter().filter_map(|name| in_any_case(name, folder)).find(inside)
}

/// A path as the disk has it, for one that may have its letters in another case.
fn in_any_case(name: &str, folder: &Path) -> Option<String> {
    let (mut at, mut found) = (folder.to_owned(), Vec::new());
    if name.starts_with('/') {
        return None;
    }
    for part in name.split('/').filter(|part| !matches!(*part, "" | ".")) {
        if part == ".." {
            return None;
        }
        let listed = || {
            let names = std::fs::read_dir(&at).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
            names.filter(|other| other.to_lowercase() == part.to_lowercase()).min()
        };
        let real = if at.join(part).exists() { part.to_owned() } else { listed()? };
        at.push(&real);
        found.push(real);
    }
    (!found.is_empty()).then(|| found.join("/"))
}

/// What a URI may not hold as it is.
const UNSAFE: &percent_encoding::AsciiSet = &percent_encoding::CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'\\')
    .add(b':');

/// A path as a URI.
pub fn encode(path: &str) -> String {
    percent_encoding::utf8_percent_encode(path, UNSAFE).to_string()
}

/// The bytes of a base64 text.
///
/// # Errors
/// Says that the text is not base64.
pub fn decode_base64(text: &str, field: &str) -> Result<Vec<u8>> {
    base64::engine::general_purpose::STANDARD.decode(text.trim_end()).map_err(|error| {
        Error::input("a data URI is not valid base64")
            .with_field(field)
            .with_found(error)
            .with_expected("base64 text")
            .with_hint("export again, or as GLB")
    })
}

/// A whole file, at most [`MAX_FILE_BYTES`] long.
///
/// # Errors
/// Says why it cannot be read.
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    let fail = |error: std::io::Error| {
        Error::input("cannot read the file")
            .with_file(path)
            .with_found(error)
            .with_expected("a file that is there and may be read")
    };
    let mut file = File::open(path).map_err(fail)?;
    let about = file.metadata().map_err(fail)?;
    if !about.is_file() {
        return Err(Error::input("the input is not a file").with_file(path).with_expected("a file"));
    }
    if about.len() > MAX_FILE_BYTES {
        return Err(Error::input("the file is too long")
            .with_file(path)
            .with_found(format!("{} bytes", about.len()))
            .with_expected(format!("at most {MAX_FILE_BYTES} bytes"))
            .with_hint("split the scene, or remove what needs no fur"));
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    file.by_ref().take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(fail)?;
    Ok(bytes)
}
