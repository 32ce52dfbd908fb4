//! KTX 2.0 textures (Khronos KTX File Format Specification 2.0): 2D, arrays and mips, eight bits a channel, each level
//! compressed by Zstandard.

use crate::data::image::Image8;
use crate::error::{Error, Result};

const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";
const ZSTD: u32 = 2;
/// Zstandard's level: higher ones gain nothing on hair.
const EFFORT: i32 = 9;
/// Most bytes a texture may unpack to.
const MAX_BYTES: usize = 1 << 28;

/// How texels are coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One linear channel.
    R8,
    /// Four linear channels.
    Rgba8,
    /// Three channels in sRGB coding and linear alpha.
    Rgba8Srgb,
}

impl Format {
    /// VkFormat.
    fn code(self) -> u32 {
        match self {
            Self::R8 => 9,
            Self::Rgba8 => 37,
            Self::Rgba8Srgb => 43,
        }
    }

    fn of_code(code: u32) -> Option<Self> {
        [Self::R8, Self::Rgba8, Self::Rgba8Srgb].into_iter().find(|format| format.code() == code)
    }

    /// Bytes of a texel.
    pub fn channels(self) -> u32 {
        if self == Self::R8 { 1 } else { 4 }
    }

    /// The data format descriptor (Khronos Data Format 1.3): a basic block with one sample per channel.
    fn descriptor(self) -> Vec<u8> {
        let channels = self.channels();
        let block = 24 + 16 * channels;
        let transfer: u32 = if self == Self::Rgba8Srgb { 2 } else { 1 };
        let mut words = vec![4 + block, 0, 2 | (block << 16), 1 | (1 << 8) | (transfer << 16), 0, channels, 0];
        for channel in 0..channels {
            // Channel ids are R 0, G 1, B 2, A 15; alpha of an sRGB format is marked as linear.
            let alpha = channel == 3;
            let id = if alpha { 15 } else { channel };
            let linear = if alpha && transfer == 2 { 0x10 } else { 0 };
            words.extend([(channel * 8) | (7 << 16) | ((id | linear) << 24), 0, 0, 255]);
        }
        words.iter().flat_map(|word: &u32| word.to_le_bytes()).collect()
    }
}

/// A KTX2 file of images `[mip][layer]`; `array` tells an array of one layer from a plain texture.
///
/// # Errors
/// When mips or layers do not fit together.
pub fn encode(images: &[Vec<&Image8>], format: Format, array: bool) -> Result<Vec<u8>> {
    let first = images.first().and_then(|level| level.first());
    let layers = images.first().map_or(0, Vec::len);
    let fits = |(mip, level): (usize, &Vec<&Image8>)| {
        let size = |edge: u32| (edge >> mip).max(1);
        let expected = first.map(|f| (size(f.width), size(f.height), format.channels()));
        level.len() == layers && level.iter().all(|i| Some((i.width, i.height, i.channels)) == expected && whole(i))
    };
    let Some(first) = first.filter(|_| images.iter().enumerate().all(fits)) else {
        return Err(Error::new(crate::error::Kind::Output, "the levels of a texture do not fit together"));
    };
    let descriptor = format.descriptor();
    let writer = b"KTXwriter\0furrier\0";
    let mut values = (writer.len() as u32).to_le_bytes().to_vec();
    values.extend_from_slice(writer);
    values.resize(values.len().next_multiple_of(4), 0);
    let index_end = 80 + 24 * images.len();
    let values_start = index_end + descriptor.len();
    let mut out = IDENTIFIER.to_vec();
    let header = [
        format.code(),
        1,
        first.width,
        first.height,
        0,
        if array { layers as u32 } else { 0 },
        1,
        images.len() as u32,
        ZSTD,
        index_end as u32,
        descriptor.len() as u32,
        values_start as u32,
        values.len() as u32,
    ];
    out.extend(header.iter().flat_map(|word| word.to_le_bytes()));
    out.extend([0; 16]);
    out.resize(index_end, 0);
    out.extend(descriptor);
    out.extend(values);
    // The smallest mip comes first in the file, the largest first in the index.
    for (mip, level) in images.iter().enumerate().rev() {
        let texels: Vec<u8> = level.iter().flat_map(|image| &image.pixels).copied().collect();
        let packed = zstd::bulk::compress(&texels, EFFORT)
            .map_err(|e| Error::new(crate::error::Kind::Output, format!("a texture cannot be compressed: {e}")))?;
        let entry = [out.len() as u64, packed.len() as u64, texels.len() as u64];
        let bytes: Vec<u8> = entry.iter().flat_map(|n| n.to_le_bytes()).collect();
        out[80 + 24 * mip..][..24].copy_from_slice(&bytes);
        out.extend(packed);
    }
    Ok(out)
}

fn whole(image: &Image8) -> bool {
    image.pixels.len() == image.width as usize * image.height as usize * image.channels as usize
}

/// The images `[mip][layer]` of a KTX2 file that [`encode`] could have written.
///
/// # Errors
/// Names what is broken, or of another kind.
pub fn decode(bytes: &[u8], format: Format) -> Result<Vec<Vec<Image8>>> {
    let broken = |what: &str, found: String, expected: String| {
        Error::input("a KTX2 texture cannot be read").with_field(what).with_found(found).with_expected(expected)
    };
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let header: Option<Vec<u32>> = (0..9).map(|i| word(12 + 4 * i)).collect();
    let Some(header) = header.filter(|_| bytes.starts_with(&IDENTIFIER)) else {
        return Err(broken("KTX2 header", format!("{} bytes", bytes.len()), "a KTX2 file".into()));
    };
    let [code, _, width, height, depth, layers, faces, levels, scheme] = header[..] else {
        return Err(broken("KTX2 header", "too few words".into(), "nine".into()));
    };
    if Format::of_code(code) != Some(format) {
        return Err(broken("vkFormat", code.to_string(), format!("{} ({format:?})", format.code())));
    }
    if depth != 0 || faces != 1 || scheme != ZSTD || width == 0 || height == 0 || levels == 0 || levels > 16 {
        let found = format!("{width} × {height} × {depth}, {faces} faces, {levels} levels, scheme {scheme}");
        return Err(broken("KTX2 header", found, "a 2D texture or array with 1 to 16 levels under Zstandard".into()));
    }
    let mut mips = Vec::new();
    for mip in 0..levels as usize {
        let long = |at: usize| word(at).zip(word(at + 4)).map(|(low, high)| u64::from(low) | (u64::from(high) << 32));
        let entry = 80 + 24 * mip;
        let (width, height) = ((width >> mip).max(1), (height >> mip).max(1));
        let texels =
            (width as usize).checked_mul(height as usize).and_then(|n| n.checked_mul(format.channels() as usize));
        let size = texels.and_then(|n| n.checked_mul(layers.max(1) as usize)).filter(|&n| n <= MAX_BYTES);
        let packed = long(entry).zip(long(entry + 8)).and_then(|(start, length)| {
            let start = usize::try_from(start).ok()?;
            bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
        });
        let unpacked = size.zip(packed).and_then(|(size, packed)| zstd::bulk::decompress(packed, size).ok());
        let Some(unpacked) = unpacked.filter(|u| Some(u.len()) == size) else {
            return Err(broken(&format!("levels[{mip}]"), "a broken or cut level".into(), format!("{size:?} bytes")));
        };
        let layer = |pixels: &[u8]| Image8 { width, height, channels: format.channels(), pixels: pixels.to_vec() };
        mips.push(unpacked.chunks_exact(texels.unwrap_or(1).max(1)).map(layer).collect());
    }
    Ok(mips)
}
