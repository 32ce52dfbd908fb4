//! A reader of cyHair files by their specification.

/// A file's contents, defaults filled in.
#[derive(Debug, Default, PartialEq)]
pub struct Hairs {
    pub flags: u32,
    pub segments: Vec<u16>,
    pub points: Vec<[f32; 3]>,
    pub thickness: Vec<f32>,
    pub transparency: Vec<f32>,
    pub colours: Vec<[f32; 3]>,
}

/// Reads a file; panics where it is not one.
pub fn read(bytes: &[u8]) -> Hairs {
    let (header, mut rest) = bytes.split_at(128);
    assert_eq!(&header[..4], b"HAIR");
    let word = |i: usize| u32::from_le_bytes(header[4 * i..4 * i + 4].try_into().unwrap());
    let float = |i: usize| f32::from_bits(word(i));
    let (hairs, points, flags) = (word(1) as usize, word(2) as usize, word(3));
    let mut next = |bytes: usize| {
        let (taken, left) = rest.split_at(bytes);
        rest = left;
        taken.to_vec()
    };
    let segments: Vec<u16> = match flags & 1 {
        0 => vec![word(4) as u16; hairs],
        _ => next(2 * hairs).chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect(),
    };
    assert_eq!(segments.iter().map(|&s| usize::from(s) + 1).sum::<usize>(), points);
    let mut floats = |there: bool, width: usize, default: &[f32]| -> Vec<f32> {
        if !there {
            return default.repeat(points);
        }
        next(4 * width * points).chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
    };
    assert!(flags & 2 != 0, "a hair file without points");
    let triples = |flat: Vec<f32>| flat.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
    let points = triples(floats(true, 3, &[]));
    let thickness = floats(flags & 4 != 0, 1, &[float(5)]);
    let transparency = floats(flags & 8 != 0, 1, &[float(6)]);
    let colours = triples(floats(flags & 16 != 0, 3, &[float(7), float(8), float(9)]));
    assert!(rest.is_empty(), "{} bytes too many", rest.len());
    Hairs { flags, segments, points, thickness, transparency, colours }
}
