//! Images of a document: found, their size checked in the header, and only then decoded.

use super::basis;
use super::document::Document;
use super::uri;
use crate::data::image::Image8;
use crate::error::{Error, Kind, Result};
use image::{ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;

/// Longest side that is decoded, pixels.
pub const MAX_SIDE: u32 = 16_384;
/// Most pixels that are decoded (256 MiB as RGBA).
pub const MAX_PIXELS: u64 = 1 << 26;

/// What is said of an image of a kind that is not decoded.
const FOREIGN: &str = "is neither PNG, JPEG, WebP nor KTX2";

/// What there is to know of an image before decoding it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// Can be decoded.
    Usable {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The file it names is not there.
    Missing,
    /// Of another kind, elsewhere or broken: what is the matter with it.
    Unusable(String),
}

impl Document {
    /// The encoded bytes of image `index`; none where the file it names is not there.
    ///
    /// # Errors
    /// Names images that point nowhere, or outside the input's folder.
    pub fn image_bytes(&self, index: usize) -> Result<Option<Vec<u8>>> {
        let image = self.root().entry("images", index)?;
        if let Some(view) = image.get("bufferView") {
            return Ok(Some(self.view(view.size()?)?.to_vec()));
        }
        let Some(at) = image.get("uri") else { return Ok(None) };
        match uri::resolve(at.text()?, self.folder.as_deref(), &at.path)? {
            uri::Target::Data { base64 } => uri::decode_base64(base64, &at.path).map(Some),
            uri::Target::File(path) if path.exists() => uri::read_file(&path).map(Some),
            uri::Target::File(_) => Ok(None),
        }
    }

    /// Reads the header of image `index`.
    ///
    /// # Errors
    /// When the header claims more pixels than are ever decoded.
    pub fn find_image(&self, index: usize) -> Result<Found> {
        // Nothing that lies elsewhere is opened; that alone is no reason to do without the rest.
        let bytes = match self.image_bytes(index) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => return Ok(Found::Missing),
            Err(error) => return Ok(Found::Unusable(format!("cannot be read: {}", error.what))),
        };
        let (width, height) = if basis::is_ktx2(&bytes) {
            match basis::size(&bytes) {
                Ok([width, height]) => (width, height),
                Err(fault) => return Ok(Found::Unusable(format!("is a KTX2 texture that cannot be decoded: {fault}"))),
            }
        } else {
            let Some(format) = format(&bytes) else { return Ok(Found::Unusable(FOREIGN.into())) };
            let size = ImageReader::with_format(Cursor::new(&bytes), format).into_dimensions();
            size.map_err(|error| self.broken_image(index, &error))?
        };
        if width.max(height) > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(self
                .told(Error::input("an image is too large"))
                .with_field(format!("images[{index}]"))
                .with_found(format!("{width} × {height} pixels in its header"))
                .with_expected(format!("at most {MAX_SIDE} a side and {MAX_PIXELS} in all"))
                .with_hint("scale the image down"));
        }
        Ok(Found::Usable { width, height })
    }

    /// Image `index` as RGBA; none where it is missing or of a kind that is not decoded.
    ///
    /// # Errors
    /// When it is broken or too large.
    pub fn decode_image(&self, index: usize) -> Result<Option<Image8>> {
        let Found::Usable { .. } = self.find_image(index)? else { return Ok(None) };
        let Some(bytes) = self.image_bytes(index)? else { return Ok(None) };
        if basis::is_ktx2(&bytes) {
            return basis::decode(&bytes).map(Some).map_err(|fault| self.broken_image(index, &fault));
        }
        let Some(format) = format(&bytes) else { return Ok(None) };
        decode(&bytes, format).map(Some).map_err(|error| self.broken_image(index, &error))
    }

    /// With the file that was read.
    fn told(&self, error: Error) -> Error {
        match self.files.first() {
            Some(file) => error.with_file(file),
            None => error,
        }
    }

    fn broken_image(&self, index: usize, error: &dyn std::fmt::Display) -> Error {
        self.told(Error::input("an image cannot be decoded"))
            .with_field(format!("images[{index}]"))
            .with_found(error)
            .with_expected("a whole PNG, JPEG, WebP or KTX2")
            .with_hint("save the image again")
    }
}

/// Decodes a PNG, JPEG or WebP file as RGBA.
///
/// # Errors
/// When it cannot be read, is of another kind, broken or too large.
pub fn load(path: &Path) -> Result<Image8> {
    let (bytes, format) = read(path)?;
    decode(&bytes, format).map_err(|error| broken(path, error.to_string()))
}

/// Whether a file looks like what [`load`] decodes, at a glance.
///
/// # Errors
/// When it cannot be read or is of another kind.
pub fn check(path: &Path) -> Result<()> {
    read(path).map(|_| ())
}

fn read(path: &Path) -> Result<(Vec<u8>, ImageFormat)> {
    let bytes = uri::read_file(path)?;
    let format = format(&bytes).ok_or_else(|| broken(path, "another kind of file".into()))?;
    Ok((bytes, format))
}

fn broken(path: &Path, found: String) -> Error {
    Error::input("an image cannot be decoded")
        .with_file(path)
        .with_found(found)
        .with_expected("a whole PNG, JPEG or WebP of a moderate size")
}

fn decode(bytes: &[u8], format: ImageFormat) -> image::ImageResult<Image8> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_PIXELS * 8);
    reader.limits(limits);
    let image = reader.decode()?.into_rgba8();
    Ok(Image8 { width: image.width(), height: image.height(), channels: 4, pixels: image.into_raw() })
}

fn format(bytes: &[u8]) -> Option<ImageFormat> {
    let format = image::guess_format(bytes).ok()?;
    matches!(format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP).then_some(format)
}

/// Media type of encoded image bytes, as glTF names it.
pub fn media_type(bytes: &[u8]) -> Option<&'static str> {
    if basis::is_ktx2(bytes) {
        return Some("image/ktx2");
    }
    Some(match format(bytes)? {
        ImageFormat::Png => "image/png",
        ImageFormat::Jpeg => "image/jpeg",
        _ => "image/webp",
    })
}

/// An RGBA image as PNG.
///
/// # Errors
/// When it cannot be encoded.
pub fn png(image: &Image8) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = ::image::codecs::png::PngEncoder::new(&mut bytes);
    let colour = ::image::ExtendedColorType::Rgba8;
    ::image::ImageEncoder::write_image(encoder, &image.pixels, image.width, image.height, colour)
        .map_err(|error| Error::new(Kind::Output, format!("a texture cannot be written as PNG: {error}")))?;
    Ok(bytes)
}
