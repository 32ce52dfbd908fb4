//! What pictures need on the device: tiles, and the geometry of a pose.

use super::layout::{
    CoatVertex, FinInstance, LayerLook, Mip, PaintUniform, SkinVertex, TileUniform, medium_unit_per_m,
};
use super::pipelines::Layouts;
use crate::data::coat::{FinEdge, FinTexture, LOOK, Sampled, ShellStack, Tile};
use crate::data::image::Image8;
use crate::data::shell::{signed, unorm};
use crate::data::texture::Wrap;
use crate::error::Result;
use crate::gpu::{Coding, Gpu, TextureArray};
use crate::math::Vec2;
use crate::runtime::draw_list::{CoatMesh, SkinMesh};
use crate::runtime::sight::{Before, Point, Sighted};
use crate::runtime::{bends_per_m, outer_edge_m};

/// Bytes of a vertex or index list.
fn bytes_of<T>(list: &[T]) -> u64 {
    size_of_val(list) as u64
}

/// Resources in the order of their bindings.
pub fn bind(gpu: &Gpu, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

fn view(array: &TextureArray) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&array.view)
}

/// Trilinear; `wrap` per axis.
fn sampler(gpu: &Gpu, wrap: [Wrap; 2], anisotropy: u16) -> wgpu::Sampler {
    let mode = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: mode(wrap[0]),
        address_mode_v: mode(wrap[1]),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: anisotropy,
        ..Default::default()
    })
}

/// A tile's textures and tables.
pub struct GpuTile {
    /// Group 1, with each of its looks.
    pub groups: [wgpu::BindGroup; 2],
    /// Group 3 of fins.
    pub fin: wgpu::BindGroup,
    /// Layers, the skin counted.
    pub layers: u32,
    /// Thickness of the hair that its fin texture holds, m.
    pub fin_thickness_m: f32,
    /// Height of the stack, m.
    height_m: f32,
    /// The hair before each layer; empty where its density does not stand for all of it.
    before: Vec<Before>,
    /// Which look each layer has.
    looks: Vec<usize>,
    /// Texture memory.
    pub bytes: u64,
}

impl GpuTile {
    /// Uploads `tile`.
    ///
    /// # Errors
    /// As [`Gpu::texture_array`].
    pub fn new(gpu: &Gpu, layouts: &Layouts, tile: &Tile) -> Result<Self> {
        let shells = &tile.shells;
        let albedo = gpu.texture_array("shell albedo", &shells.albedo, Coding::Srgb)?;
        let (unit_per_m, scales_per_m) = (medium_unit_per_m(shells), &shells.extinction_scales_per_m);
        let medium = gpu.half_array("shell medium", &shells.medium, &|mip, channel, byte| {
            let scale = scales_per_m.get(mip).copied().unwrap_or(0.0) / unit_per_m;
            scale * if channel == 0 { unorm(byte) } else { signed(byte) }
        })?;
        let ends = gpu.half_array("shell ends", &shells.ends, &|_, _, byte| unorm(byte))?;
        let single = |images: &[Image8]| images.iter().map(|image| vec![image.clone()]).collect::<Vec<_>>();
        let fin_albedo = gpu.texture_array("fin albedo", &single(&tile.fin.albedo), Coding::Srgb)?;
        let fin_tangent = gpu.texture_array("fin tangent", &single(&tile.fin.tangent), Coding::Linear)?;
        let uniform = gpu.buffer("tile", &[TileUniform::new(tile)], wgpu::BufferUsages::UNIFORM);
        let slopes: Vec<[f32; 2]> = shells.slopes.iter().map(|slope| slope.to_array()).collect();
        let slopes = gpu.buffer("slopes", &slopes, wgpu::BufferUsages::STORAGE);
        let mips = gpu.buffer("mips", &Mip::of(tile), wgpu::BufferUsages::STORAGE);
        let lit = LayerLook::of(tile)?;
        let layer_looks = gpu.buffer("layer looks", &lit.layers, wgpu::BufferUsages::STORAGE);
        let wrap = if tile.sampled == Sampled::Square { Wrap::Repeat } else { Wrap::Clamp };
        let hair_sampler = sampler(gpu, [wrap; 2], 1);
        let group = |look: &[[f32; 4]; LOOK]| {
            let look = gpu.buffer("look", look, wgpu::BufferUsages::STORAGE);
            let resources = [
                uniform.as_entire_binding(),
                slopes.as_entire_binding(),
                mips.as_entire_binding(),
                wgpu::BindingResource::Sampler(&hair_sampler),
                view(&albedo),
                view(&medium),
                view(&ends),
                look.as_entire_binding(),
                layer_looks.as_entire_binding(),
            ];
            bind(gpu, &layouts.tile, &resources)
        };
        let groups = lit.looks.each_ref().map(group);
        let fin_sampler = sampler(gpu, [Wrap::Repeat, Wrap::Clamp], 4);
        let fin = bind(
            gpu,
            &layouts.fin,
            &[wgpu::BindingResource::Sampler(&fin_sampler), view(&fin_albedo), view(&fin_tangent)],
        );
        let bytes = [&albedo, &medium, &ends, &fin_albedo, &fin_tangent].iter().map(|texture| texture.bytes).sum();
        let before = if tile.sampled == Sampled::Square { before(tile, &lit.layers) } else { vec![] };
        let fin_thickness_m = tile.fin.thickness_m;
        Ok(Self {
            groups,
            fin,
            layers: shells.layers,
            fin_thickness_m,
            height_m: tile.height_m,
            before,
            looks: lit.kinds,
            bytes,
        })
    }

    /// A coat on this tile as far as sight goes, whose vertices are so far from where it ends, m, and whose skin bends so, 1/m.
    fn sighted(&self, fur: &CoatMesh<'_>, away_m: &[f32], bends_per_m: &[f32]) -> Sighted {
        let point = |i: usize| Point {
            position_m: fur.positions_m[i],
            offset_m: fur.offsets_m[i],
            normal: fur.normals[i],
            density: fur.tint[i].w,
            bend_per_m: bends_per_m[i],
            away_m: away_m[i],
        };
        let fin = |fin: &FinEdge| {
            let [start, end] = fin.ends.map(|v| fur.positions_m[v as usize]);
            (fin.ends, (fin.u[1] - fin.u[0]).abs() / start.distance(end).max(f32::MIN_POSITIVE))
        };
        Sighted {
            points: (0..fur.positions_m.len()).map(point).collect(),
            triangles: fur.triangles.to_vec(),
            fins: fur.fins.iter().map(fin).collect(),
            height_m: self.height_m,
            before: if fur.painted.is_some() { vec![] } else { self.before.clone() },
            looks: self.looks.clone(),
            layers: self.layers,
            edge_m: outer_edge_m(fur),
            over_last: fur.over_last,
        }
    }
}

/// The hair before each layer of a tile, seen by pixels that span all of it.
fn before(tile: &Tile, layers: &[LayerLook]) -> Vec<Before> {
    let mut above_top = [0.0; 9];
    let mut before: Vec<Before> = Vec::with_capacity(layers.len());
    let gains = tile.shells.gains.last().map_or(&[][..], |gains| &gains[..]);
    for (layer, gains) in layers.iter().zip(gains).rev() {
        before.push(Before { above_top, scale_slabs: layer.scale_slabs });
        above_top.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += layer.area * gain);
    }
    before.reverse();
    before
}

/// A tile of nothing: transmittance 1 everywhere.
pub fn bare_tile() -> Tile {
    let texel =
        |channels: u32| vec![vec![Image8 { width: 1, height: 1, channels, pixels: vec![255; channels as usize] }]];
    let fin = texel(4).remove(0);
    Tile {
        preset: String::new(),
        sampled: Sampled::Square,
        edge_m: 1.0,
        height_m: 1.0,
        shells: ShellStack {
            layers: 2,
            size: 1,
            gains: vec![vec![[1.0; 9]; 2]],
            slopes: vec![Vec2::ZERO; 2],
            extinction_scales_per_m: vec![1.0],
            albedo: texel(4),
            medium: texel(4),
            ends: texel(1),
        },
        looks: None,
        fin: FinTexture { size: [1, 1], width_m: 1.0, thickness_m: 1.0, albedo: fin.clone(), tangent: fin },
    }
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
        let samplers = [sampler(gpu, wrap(skin.texture), 16), sampler(gpu, wrap(skin.painted), 4)];
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
    /// Group 2 of shells.
    pub shells: wgpu::BindGroup,
    /// Group 2 of fins.
    pub fins: wgpu::BindGroup,
    /// What of it can be seen from where.
    pub sighted: Sighted,
    /// Tile it carries.
    pub tile: usize,
    /// Whether its roots have textures.
    pub painted: bool,
    /// Geometry memory.
    pub bytes: u64,
}

impl GpuFur {
    /// Uploads a coat on `tile` with how far its vertices are from where it ends, m; its textures were added; none without them.
    pub fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        (fur, away_m): (&CoatMesh<'_>, &[f32]),
        tile: &GpuTile,
        textures: &Textures<'_>,
    ) -> Option<Self> {
        let bends_per_m = bends_per_m(fur);
        let sighted = tile.sighted(fur, away_m, &bends_per_m);
        let vertices = CoatVertex::of(fur, away_m, &bends_per_m);
        let fins: Vec<FinInstance> = fur.fins.iter().map(|fin| FinInstance::new(fin, tile.fin_thickness_m)).collect();
        let bytes = bytes_of(&vertices) + bytes_of(fur.triangles) + bytes_of(&fins);
        let vertices = gpu.buffer("coat vertices", &vertices, wgpu::BufferUsages::STORAGE);
        let indices = gpu.buffer("coat indices", fur.triangles, wgpu::BufferUsages::STORAGE);
        let edges = gpu.buffer("fins", &fins, wgpu::BufferUsages::STORAGE);
        let paint = gpu.buffer("paint", &[PaintUniform::new(fur)], wgpu::BufferUsages::UNIFORM);
        let wrap = |of: Option<(&Image8, [Wrap; 2])>| of.map_or([Wrap::Repeat; 2], |(_, wrap)| wrap);
        let [colour, painted] = [sampler(gpu, wrap(fur.colour), 4), sampler(gpu, wrap(fur.painted), 4)];
        let shown = [textures.get(fur.colour, true)?, textures.get(fur.painted, false)?];
        let group = |faces: &wgpu::Buffer| {
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
            shells: group(&indices),
            fins: group(&edges),
            sighted,
            tile: fur.tile,
            painted: fur.colour.is_some() || fur.painted.is_some(),
            bytes,
        })
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
