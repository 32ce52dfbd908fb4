//! Reads accessors: any component type, stride, normalisation and sparse changes, checked before a byte is touched.

use super::document::Document;
use super::json::At;
use crate::error::{Error, Result};

/// Most elements an accessor may have without data behind it (they are zeros by the format).
const MAX_ZEROS: usize = 1 << 22;

/// How one element's components are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(at: &At<'_>) -> Result<Self> {
        Ok(match at.size()? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(at.fault("5120, 5121, 5122, 5123, 5125 or 5126")),
        })
    }

    /// Bytes of one component.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn float(self, bytes: &[u8], normalised: bool) -> f32 {
        let scaled = |value: f32, top: f32| if normalised { (value / top).max(-1.0) } else { value };
        match self {
            Self::I8 => scaled(f32::from(bytes[0] as i8), 127.0),
            Self::U8 => scaled(f32::from(bytes[0]), 255.0),
            Self::I16 => scaled(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => scaled(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32,
            Self::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }

    fn integer(self, bytes: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => u32::from(bytes[0]),
            Self::I16 | Self::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}

/// Where an accessor's elements lie; every element is within the buffer.
#[derive(Clone, Debug)]
pub struct AccessorLayout {
    /// Elements.
    pub count: usize,
    /// Components of an element.
    pub components: usize,
    /// Their type.
    pub component: Component,
    /// Whether integers stand for [0, 1] or [-1, 1].
    pub normalised: bool,
    /// First byte and step from element to element; none where all are zero.
    place: Option<(usize, usize)>,
    sparse: Option<Sparse>,
}

#[derive(Clone, Debug)]
struct Sparse {
    count: usize,
    index: Component,
    indices: usize,
    values: usize,
}

impl AccessorLayout {
    /// The checked layout of accessor `index`.
    ///
    /// # Errors
    /// Names the field that contradicts the buffer or the format.
    pub fn of(document: &Document, index: usize) -> Result<Self> {
        let accessor = document.root().entry("accessors", index)?;
        let type_at = accessor.need("type")?;
        let components = match type_at.text()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" | "MAT2" => 4,
            "MAT3" => 9,
            "MAT4" => 16,
            _ => return Err(type_at.fault("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4")),
        };
        let component = Component::of(&accessor.need("componentType")?)?;
        let count_at = accessor.need("count")?;
        let count = count_at.size()?;
        let element = components * component.size();
        let place = match accessor.get("bufferView") {
            Some(view) => Some(place(document, &accessor, &view, &count_at, element)?),
            None if count > MAX_ZEROS => {
                return Err(count_at
                    .fault(&format!("at most {MAX_ZEROS} elements where no bufferView stands behind them"))
                    .with_hint("the file was written by a faulty exporter; export it again"));
            }
            None => None,
        };
        let sparse = accessor.get("sparse").map(|s| sparse(document, &s, count, element)).transpose()?;
        let normalised = accessor.get("normalized").is_some_and(|n| n.value.as_bool() == Some(true));
        Ok(Self { count, components, component, normalised, place, sparse })
    }

    /// Bytes of one element.
    pub fn element(&self) -> usize {
        self.components * self.component.size()
    }

    /// Every element's bytes, tightly packed, with sparse changes applied.
    pub fn bytes(&self, document: &Document) -> Vec<u8> {
        let element = self.element();
        let mut out = vec![0; self.count * element];
        if let Some((start, stride)) = self.place {
            for (i, to) in out.chunks_exact_mut(element).enumerate() {
                to.copy_from_slice(&document.binary[start + i * stride..][..element]);
            }
        }
        if let Some(sparse) = &self.sparse {
            for i in 0..sparse.count {
                let to = sparse.index.integer(&document.binary[sparse.indices + i * sparse.index.size()..]) as usize;
                let from = sparse.values + i * element;
                out[to * element..][..element].copy_from_slice(&document.binary[from..from + element]);
            }
        }
        out
    }

    /// All components as numbers, element by element; normalised integers are scaled.
    pub fn floats(&self, document: &Document) -> Vec<f32> {
        let bytes = self.bytes(document);
        bytes.chunks_exact(self.component.size()).map(|c| self.component.float(c, self.normalised)).collect()
    }

    /// All components as unsigned integers.
    pub fn integers(&self, document: &Document) -> Vec<u32> {
        self.bytes(document).chunks_exact(self.component.size()).map(|c| self.component.integer(c)).collect()
    }
}

/// First byte and stride of an accessor with a buffer view.
fn place(
    document: &Document,
    accessor: &At<'_>,
    view: &At<'_>,
    count: &At<'_>,
    element: usize,
) -> Result<(usize, usize)> {
    let (start, length, stride) = view_range(document, view)?;
    let stride = stride.unwrap_or(element);
    let offset = accessor.size_or("byteOffset", 0)?;
    if stride < element {
        return Err(view.fault(&format!("a bufferView with a byteStride of at least {element}")));
    }
    let n = count.size()?;
    let end =
        n.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(element)?.checked_add(offset));
    if end.is_none_or(|end| end > length) {
        let room = length.saturating_sub(offset);
        let fits = if room < element { 0 } else { (room - element) / stride + 1 };
        return Err(Error::input("an accessor reaches beyond its buffer view")
            .with_field(count.path.clone())
            .with_found(n)
            .with_expected(format!("at most {fits} elements ({length} bytes in bufferViews[{}])", view.size()?))
            .with_hint("the file was cut or written by a faulty exporter; export it again"));
    }
    Ok((start + offset, stride))
}

fn view_range(document: &Document, view: &At<'_>) -> Result<(usize, usize, Option<usize>)> {
    let index = view.index_into("bufferViews", document.count("bufferViews"))?;
    let at = document.root().entry("bufferViews", index)?;
    let stride = at.get("byteStride").map(|s| s.size()).transpose()?;
    let range = (at.size_or("byteOffset", 0)?, at.need("byteLength")?.size()?);
    if range.0.checked_add(range.1).is_none_or(|end| end > document.binary.len()) {
        return Err(at.fault("a range within the buffer"));
    }
    Ok((range.0, range.1, stride))
}

fn sparse(document: &Document, sparse: &At<'_>, elements: usize, element: usize) -> Result<Sparse> {
    let count_at = sparse.need("count")?;
    let count = count_at.size()?;
    let part = |key: &str, size: usize| -> Result<usize> {
        let at = sparse.need(key)?;
        let (start, length, _) = view_range(document, &at.need("bufferView")?)?;
        let offset = at.size_or("byteOffset", 0)?;
        if count.checked_mul(size).and_then(|bytes| bytes.checked_add(offset)).is_none_or(|end| end > length) {
            return Err(count_at.fault(&format!("at most what the {key}' buffer view holds")));
        }
        Ok(start + offset)
    };
    let indices_at = sparse.need("indices")?;
    let type_at = indices_at.need("componentType")?;
    let index = Component::of(&type_at)?;
    if !matches!(index, Component::U8 | Component::U16 | Component::U32) {
        return Err(type_at.fault("5121, 5123 or 5125"));
    }
    let found = Sparse { count, index, indices: part("indices", index.size())?, values: part("values", element)? };
    for i in 0..count {
        let to = index.integer(&document.binary[found.indices + i * index.size()..]);
        if to as usize >= elements {
            return Err(Error::input("a sparse accessor changes an element it does not have")
                .with_field(format!("{} (entry {i})", indices_at.path))
                .with_found(to)
                .with_expected(format!("indices below {elements}")));
        }
    }
    Ok(found)
}

impl Document {
    /// The bytes of buffer view `index`.
    ///
    /// # Errors
    /// Names the view that does not exist.
    pub fn view(&self, index: usize) -> Result<&[u8]> {
        let at = self.root().entry("bufferViews", index)?;
        let (offset, length) = (at.size_or("byteOffset", 0)?, at.need("byteLength")?.size()?);
        let range = offset.checked_add(length).and_then(|end| self.binary.get(offset..end));
        range.ok_or_else(|| at.fault("a range within the buffer"))
    }

    /// Accessor `index` as numbers, element by element.
    ///
    /// # Errors
    /// When it does not have `components` components, or contradicts its buffer.
    pub fn floats(&self, index: usize, components: usize) -> Result<Vec<f32>> {
        let layout = self.layout(index, components)?;
        Ok(layout.floats(self))
    }

    /// Accessor `index` as unsigned integers, element by element.
    ///
    /// # Errors
    /// When it does not have `components` components, holds floats, or contradicts its buffer.
    pub fn integers(&self, index: usize, components: usize) -> Result<Vec<u32>> {
        let layout = self.layout(index, components)?;
        if matches!(layout.component, Component::U8 | Component::U16 | Component::U32) {
            return Ok(layout.integers(self));
        }
        let at = self.root().entry("accessors", index)?.need("componentType")?;
        Err(at.fault("5121, 5123 or 5125, because it holds indices"))
    }

    fn layout(&self, index: usize, components: usize) -> Result<AccessorLayout> {
        let layout = AccessorLayout::of(self, index)?;
        if layout.components == components {
            return Ok(layout);
        }
        let at = self.root().entry("accessors", index)?.need("type")?;
        Err(at.fault(&format!("a type of {components} components, as its use demands")))
    }
}
