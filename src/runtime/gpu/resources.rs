//! What pictures need on the device beside tiles: the geometry of a pose and the asset's textures.

use super::bindings::{bind, sampler, view};
use super::layout::{CoatVertex, FinInstance, PaintUniform, SkinVertex};
use super::pipelines::Layouts;
use super::tile::GpuTile;
use crate::data::image::Image8;
use crate::data::texture::Wrap;
use crate::error::Result;
use crate::gpu::{Coding, Gpu, TextureArray};
use crate::runtime::bends_per_m;
use crate::runtime::detail::Detail;
use crate::runtime::draw_list::{CoatMesh, SkinMesh};
use crate::runtime::sight::Sighted;

/// Bytes of a vertex or index list.
fn bytes_of<T>(list: &[T]) -> u64 {
    size_of_val(list) as u64
}

/// An opaque surface on the device.
pub struct GpuSkin {
    /// Group 2.
    pub material: wgpu::BindGroup,
    /// Vertex buffer.
    pub vertices: wgpu::Buffer,
    /// Index buffer, 32 bits.
    pub indices: wgpu::Buffer,
    /// How many indices.
    pub index_count: u32,
    /// Tile that shades it.
    pub tile: Option<usize>,
    /// What drawing it reads: geometry and textures.
    pub bytes: u64,
    /// Memory of its geometry.
    pub geometry_bytes: u64,
}

impl GpuSkin {
    /// Uploads `skin`, which shows `texture`; `painted` is what is painted on it.
    fn new(gpu: &Gpu, layouts: &Layouts, skin: &SkinMesh<'_>, [texture, painted]: [&TextureArray; 2]) -> Self {
        let wrap = |of: Option<(&Image8, [Wrap; 2])>| of.map_or([Wrap::Repeat; 2], |(_, wrap)| wrap);
        let samplers = [sampler(gpu, wrap(skin.texture), 8), sampler(gpu, wrap(skin.painted), 4)];
        let [base, paint] = samplers.each_ref().map(wgpu::BindingResource::Sampler);
        let material = bind(gpu, &layouts.material, &[base, view(texture), paint, view(painted)]);
        let vertices = SkinVertex::of(skin);
        let geometry_bytes = bytes_of(&vertices) + bytes_of(&skin.triangles);
        Self {
            material,
            vertices: gpu.buffer("skin vertices", &vertices, wgpu::BufferUsages::VERTEX),
            indices: gpu.buffer("skin indices", &skin.triangles, wgpu::BufferUsages::INDEX),
            index_count: 3 * skin.triangles.len() as u32,
            tile: skin.tile,
            bytes: geometry_bytes + texture.bytes + painted.bytes,
            geometry_bytes,
        }
    }
}

/// Textures of the asset on the device, each once.
pub struct Textures<'a> {
    white: Image8,
    images: Vec<(&'a Image8, bool, TextureArray)>,
    blank: Option<TextureArray>,
    /// Memory of all of them.
    pub bytes: u64,
}

impl<'a> Textures<'a> {
    /// None yet.
    pub fn new() -> Self {
        let white = Image8 { width: 1, height: 1, channels: 4, pixels: vec![255; 4] };
        Self { white, images: Vec::new(), blank: None, bytes: 0 }
    }

    /// Uploads `image` where it is not there yet, as colour or as plain numbers; a white one for none.
    ///
    /// # Errors
    /// As [`Gpu::texture_array`].
    pub fn add(&mut self, gpu: &Gpu, image: Option<(&'a Image8, [Wrap; 2])>, colour: bool) -> Result<()> {
        if self.blank.is_none() {
            self.blank = Some(gpu.texture_array("white", &mip_chain(&self.white, true), Coding::Srgb)?);
        }
        let Some((image, _)) = image else { return Ok(()) };
        if self.images.iter().all(|(known, as_colour, _)| !std::ptr::eq(*known, image) || *as_colour != colour) {
            let coding = if colour { Coding::Srgb } else { Coding::Linear };
            let array = gpu.texture_array("texture", &mip_chain(image, colour), coding)?;
            self.bytes += array.bytes;
            self.images.push((image, colour, array));
        }
        Ok(())
    }

    /// An image that was added.
    fn get(&self, image: Option<(&Image8, [Wrap; 2])>, colour: bool) -> Option<&TextureArray> {
        let known = |(image, _): (&Image8, [Wrap; 2])| {
            self.images.iter().find(|(known, as_colour, _)| std::ptr::eq(*known, image) && *as_colour == colour)
        };
        image.and_then(known).map(|(_, _, array)| array).or(self.blank.as_ref())
    }
}

/// Uploads what has triangles of `skins`, whose textures were added.
pub fn skins(gpu: &Gpu, layouts: &Layouts, skins: &[SkinMesh<'_>], textures: &Textures<'_>) -> Vec<GpuSkin> {
    let uploaded = |skin: &SkinMesh<'_>| {
        let shown = [textures.get(skin.texture, true)?, textures.get(skin.painted, false)?];
        Some(GpuSkin::new(gpu, layouts, skin, shown))
    };
    skins.iter().filter(|skin| !skin.triangles.is_empty()).filter_map(uploaded).collect()
}

/// Shells and fins on the device.
pub struct GpuFur {
    /// Group 2 of shells: of the finer level that is drawn, and of the coarser.
    pub shells: [wgpu::BindGroup; 2],
    /// Group 2 of fins.
    pub fins: wgpu::BindGroup,
    /// What of it can be seen from where.
    pub sighted: Sighted,
    /// Tile it carries.
    pub tile: usize,
    /// Whether its roots have textures.
    pub painted: bool,
    paint: PaintUniform,
    paints: [wgpu::Buffer; 2],
    /// Geometry memory.
    pub bytes: u64,
}

impl GpuFur {
    /// Uploads a coat on `tile` with how far its vertices are from where it ends, m; its textures were added; none without them.
    pub fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        (fur, away_m): (&CoatMesh<'_>, &[f32]),
        tile: &[GpuTile],
        textures: &Textures<'_>,
    ) -> Option<Self> {
        let bends_per_m = bends_per_m(fur);
        let sighted = GpuTile::sighted(tile, fur, away_m, &bends_per_m);
        let vertices = CoatVertex::of(fur, away_m, &bends_per_m);
        let fins: Vec<FinInstance> =
            fur.fins.iter().map(|fin| FinInstance::new(fin, tile[0].fin_thickness_m)).collect();
        let bytes = bytes_of(&vertices) + bytes_of(fur.triangles) + bytes_of(&fins);
        let vertices = gpu.buffer("coat vertices", &vertices, wgpu::BufferUsages::STORAGE);
        let indices = gpu.buffer("coat indices", fur.triangles, wgpu::BufferUsages::STORAGE);
        let edges = gpu.buffer("fins", &fins, wgpu::BufferUsages::STORAGE);
        let paint = PaintUniform::new(fur);
        let paints = [(); 2].map(|()| gpu.buffer("paint", &[paint], wgpu::BufferUsages::UNIFORM));
        let wrap = |of: Option<(&Image8, [Wrap; 2])>| of.map_or([Wrap::Repeat; 2], |(_, wrap)| wrap);
        let [colour, painted] = [sampler(gpu, wrap(fur.colour), 1), sampler(gpu, wrap(fur.painted), 1)];
        let shown = [textures.get(fur.colour, true)?, textures.get(fur.painted, false)?];
        let group = |faces: &wgpu::Buffer, paint: &wgpu::Buffer| {
            let resources = [
                vertices.as_entire_binding(),
                faces.as_entire_binding(),
                paint.as_entire_binding(),
                wgpu::BindingResource::Sampler(&colour),
                view(shown[0]),
                wgpu::BindingResource::Sampler(&painted),
                view(shown[1]),
            ];
            bind(gpu, &layouts.geometry, &resources)
        };
        Some(Self {
            shells: paints.each_ref().map(|paint| group(&indices, paint)),
            fins: group(&edges, &paints[0]),
            sighted,
            tile: fur.tile,
            painted: fur.colour.is_some() || fur.painted.is_some(),
            paint,
            paints,
            bytes,
        })
    }

    /// Sets what of it the next picture shows.
    pub fn set(&self, gpu: &Gpu, detail: Detail) {
        let mut shares = [0.0; 2];
        detail.levels().for_each(|(level, share)| shares[detail.turn(level)] = share);
        for (buffer, share) in self.paints.iter().zip(shares) {
            let paint = PaintUniform { share, fins: detail.fins(), ..self.paint };
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(&paint));
        }
    }
}

/// Halves `image` down to one texel, averaging linear light where it is colour, so that what is distant does not sparkle.
fn mip_chain(image: &Image8, colour: bool) -> Vec<Vec<Image8>> {
    use crate::data::image::{linear_from_srgb, srgb_from_linear, unorm8};
    let decoded = |value: f32| if colour { linear_from_srgb(value) } else { value };
    let coded = |value: f32| if colour { srgb_from_linear(value) } else { value };
    let table: Vec<f32> = (0..256).map(|byte| decoded(byte as f32 / 255.0)).collect();
    let mut chain = vec![vec![image.clone()]];
    loop {
        let last = &chain[chain.len() - 1][0];
        if last.width == 1 && last.height == 1 {
            return chain;
        }
        let mut half = Image8::new((last.width / 2).max(1), (last.height / 2).max(1), 4);
        for y in 0..half.height {
            for x in 0..half.width {
                let at =
                    |dx: u32, dy: u32| last.pixel((2 * x + dx).min(last.width - 1), (2 * y + dy).min(last.height - 1));
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                let start = ((y * half.width + x) * 4) as usize;
                for channel in 0..3 {
                    let mean = four.iter().map(|p| table[p[channel] as usize]).sum::<f32>() / 4.0;
                    half.pixels[start + channel] = unorm8(coded(mean));
                }
                half.pixels[start + 3] = (four.iter().map(|p| u32::from(p[3])).sum::<u32>() / 4) as u8;
            }
        }
        chain.push(vec![half]);
    }
}
