//! Buffers and textures: made, filled, read back.

use super::Gpu;
use crate::data::image::Image8;
use crate::error::{Error, Kind, Result};
use std::marker::PhantomData;
use wgpu::util::DeviceExt;

/// How the bytes of an image are to be read and filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    /// Colour in sRGB coding, alpha linear.
    Srgb,
    /// Linear values in eight bits.
    Linear,
}

/// The bits of the half float nearest to `value`, which lies within what halves hold.
fn half_of(value: f32) -> u16 {
    let sign = (value.to_bits() >> 16) as u16 & 0x8000;
    let size = value.abs().min(65504.0);
    // Below 2^-14 halves are multiples of 2^-24; above, ten bits of the mantissa are kept and the exponent is counted from 15
    // instead of 127.
    let bits = if size < 1.0 / 16384.0 {
        (size * 16_777_216.0 + 0.5) as u16
    } else {
        ((size.to_bits() - (112 << 23) + (1 << 12)) >> 13) as u16
    };
    sign | bits
}

/// Where texels laid out as `T` wait to be read by the host.
pub struct ReadBack<T> {
    buffer: wgpu::Buffer,
    texels: PhantomData<T>,
    row_bytes: u32,
    /// Of a row in the buffer: rows begin at multiples of what the device can copy to.
    padded_bytes: u32,
}

impl<T: bytemuck::Pod> ReadBack<T> {
    /// Records the copy of `texture`, the one it was made for.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) {
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.padded_bytes), rows_per_image: None };
        let into = wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), into, texture.size());
    }

    /// The texels, rows from the top, once the copy was submitted and done.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn texels(&self, gpu: &Gpu) -> Result<Vec<T>> {
        let bytes = gpu.read_buffer(&self.buffer)?;
        let rows = bytes.chunks_exact(self.padded_bytes as usize);
        Ok(rows.flat_map(|row| bytemuck::pod_collect_to_vec::<u8, T>(&row[..self.row_bytes as usize])).collect())
    }
}

/// A texture of one or more layers, with mips, and the bytes it holds.
pub struct TextureArray {
    /// All layers and mips, as a 2D array.
    pub view: wgpu::TextureView,
    /// Memory of all layers and mips.
    pub bytes: u64,
}

impl Gpu {
    /// A buffer with `contents`; never empty, because an empty one cannot be bound.
    pub fn buffer<T: bytemuck::NoUninit>(
        &self,
        label: &str,
        contents: &[T],
        usage: wgpu::BufferUsages,
    ) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(contents);
        // Filled by the queue: a buffer mapped at its creation would end the program where the device is lost.
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.len().max(256).next_multiple_of(4) as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (whole, rest) = bytes.split_at(bytes.len() / 4 * 4);
        self.queue.write_buffer(&buffer, 0, whole);
        if !rest.is_empty() {
            let mut last = [0; 4];
            last[..rest.len()].copy_from_slice(rest);
            self.queue.write_buffer(&buffer, whole.len() as u64, &last);
        }
        buffer
    }

    /// A 2D array texture of `images[mip][layer]`, four channels or one, filtered as `coding` says.
    ///
    /// # Errors
    /// [`Kind::Input`] where the images are not a chain of halved, equally long mips, naming the first that is not;
    /// [`Kind::Device`] where the adapter cannot hold as many layers or texels.
    pub fn texture_array(&self, label: &str, images: &[Vec<Image8>], coding: Coding) -> Result<TextureArray> {
        let four = images.first().and_then(|layers| layers.first()).is_none_or(|base| base.channels == 4);
        let format = match (four, coding) {
            (false, _) => wgpu::TextureFormat::R8Unorm,
            (true, Coding::Srgb) => wgpu::TextureFormat::Rgba8UnormSrgb,
            (true, Coding::Linear) => wgpu::TextureFormat::Rgba8Unorm,
        };
        self.array(label, images, format, &|_, image, bytes| bytes.extend_from_slice(&image.pixels))
    }

    /// The same of half floats: `decode` says what a byte of a mip and channel stands for. Software adapters round the filtered
    /// values of eight-bit textures to eight bits again, which is too coarse where a shader takes their differences.
    ///
    /// # Errors
    /// As [`Self::texture_array`].
    pub fn half_array(
        &self,
        label: &str,
        images: &[Vec<Image8>],
        decode: &dyn Fn(usize, usize, u8) -> f32,
    ) -> Result<TextureArray> {
        let channels = images.first().and_then(|layers| layers.first()).map_or(4, |base| base.channels as usize);
        let format = if channels == 1 { wgpu::TextureFormat::R16Float } else { wgpu::TextureFormat::Rgba16Float };
        let mut mips = Vec::with_capacity(images.len());
        for mip in 0..images.len() {
            let table =
                |channel: usize| -> Vec<u16> { (0..=255).map(|byte| half_of(decode(mip, channel, byte))).collect() };
            mips.push((0..channels).map(table).collect::<Vec<_>>());
        }
        self.array(label, images, format, &|mip, image, bytes| {
            for texel in image.pixels.chunks_exact(channels) {
                bytes
                    .extend(texel.iter().zip(&mips[mip]).flat_map(|(&byte, table)| table[byte as usize].to_le_bytes()));
            }
        })
    }

    fn array(
        &self,
        label: &str,
        images: &[Vec<Image8>],
        format: wgpu::TextureFormat,
        push: &dyn Fn(usize, &Image8, &mut Vec<u8>),
    ) -> Result<TextureArray> {
        let base = images.first().and_then(|layers| layers.first());
        let base = base.ok_or_else(|| Error::input("a texture has no images").with_field(label))?;
        let layers = images[0].len();
        let limits = self.device.limits();
        if layers as u32 > limits.max_texture_array_layers
            || base.width.max(base.height) > limits.max_texture_dimension_2d
        {
            return Err(Error::new(Kind::Device, "a texture is too large for this adapter")
                .with_field(label)
                .with_found(format!("{} x {} texels, {layers} layers", base.width, base.height))
                .with_expected(format!(
                    "at most {0} x {0} texels, {1} layers",
                    limits.max_texture_dimension_2d, limits.max_texture_array_layers
                )));
        }
        let mut bytes = Vec::new();
        for (mip, row) in images.iter().enumerate() {
            let expected = [(base.width >> mip).max(1), (base.height >> mip).max(1), base.channels];
            for (layer, image) in row.iter().enumerate() {
                if [image.width, image.height, image.channels] != expected || row.len() != layers {
                    return Err(Error::input("a mip of a texture has the wrong size")
                        .with_field(format!("{label}[{mip}][{layer}]"))
                        .with_found(format!(
                            "{} x {} x {}, {} layers",
                            image.width,
                            image.height,
                            image.channels,
                            row.len()
                        ))
                        .with_expected(format!(
                            "{} x {} x {}, {layers} layers",
                            expected[0], expected[1], expected[2]
                        )));
                }
                push(mip, image, &mut bytes);
            }
        }
        let descriptor = wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: base.width, height: base.height, depth_or_array_layers: layers as u32 },
            mip_level_count: images.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let order = wgpu::util::TextureDataOrder::MipMajor;
        let texture = self.device.create_texture_with_data(&self.queue, &descriptor, order, &bytes);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Ok(TextureArray { view, bytes: bytes.len() as u64 })
    }

    /// A texture to draw into, to read in shaders and, with one sample per texel, to read back.
    ///
    /// # Errors
    /// [`Kind::Usage`] where it is larger than the adapter allows.
    pub fn target(
        &self,
        label: &str,
        size: [u32; 2],
        samples: u32,
        format: wgpu::TextureFormat,
    ) -> Result<wgpu::Texture> {
        let limit = self.device.limits().max_texture_dimension_2d;
        if size.iter().any(|&edge| edge == 0 || edge > limit) {
            return Err(Error::usage("the picture does not fit this adapter")
                .with_parameter("size")
                .with_found(format!("{} x {} with its samples", size[0], size[1]))
                .with_expected(format!("1 to {limit} along an edge, samples counted"))
                .with_hint("ask for fewer pixels or fewer samples per pixel"));
        }
        Ok(self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | if samples > 1 { wgpu::TextureUsages::empty() } else { wgpu::TextureUsages::COPY_SRC },
            view_formats: &[],
        }))
    }

    /// A way for the texels of `texture`, whose format is laid out as `T`, to come back, picture after picture.
    pub fn read_back<T: bytemuck::Pod>(&self, texture: &wgpu::Texture) -> ReadBack<T> {
        let row_bytes = texture.width() * size_of::<T>() as u32;
        let padded_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(padded_bytes) * u64::from(texture.height()),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        ReadBack { buffer, texels: PhantomData, row_bytes, padded_bytes }
    }

    /// The bytes of a buffer made with `MAP_READ`.
    ///
    /// # Errors
    /// [`Kind::Device`] where the device was lost.
    pub fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>> {
        let (sender, receiver) = std::sync::mpsc::channel();
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // The receiver lives until the poll below has returned.
            let _ = sender.send(result);
        });
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| self.failed(error.to_string()))?;
        receiver
            .recv()
            .map_err(|error| self.failed(error.to_string()))?
            .map_err(|error| self.failed(error.to_string()))?;
        let bytes = buffer.slice(..).get_mapped_range().map_err(|error| self.failed(error.to_string()))?.to_vec();
        buffer.unmap();
        Ok(bytes)
    }
}
