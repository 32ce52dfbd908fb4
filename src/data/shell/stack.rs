//! A stack with its texels decoded, and how it is fetched.

use super::guards::MOST_TAPS;
use super::{HairMedium, Incidence, Texel, above_of, gain_at, slab_optical_depth, unorm};
use crate::data::coat::{Sampled, ShellStack, Tile};
use crate::data::image::linear_from_srgb;
use crate::data::light::luminance;
use crate::math::{Vec2, Vec3};

/// A stack with its texels decoded.
pub struct Stack<'a> {
    tile: &'a Tile,
    /// `[mip][layer]`, rows from the top.
    texels: Vec<Vec<Vec<Texel>>>,
}

/// Taps of one level along a line, evenly spread.
struct Footprint {
    /// From the first to the last tap, in tile edges.
    line: Vec2,
    taps: usize,
    level: f32,
}

impl<'a> Stack<'a> {
    /// Decodes a tile's shells.
    pub fn new(tile: &'a Tile) -> Self {
        let linear = std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0));
        let layers = 0..tile.shells.layers as usize;
        let texels = (0..tile.shells.medium.len())
            .map(|mip| layers.clone().map(|layer| decode(&tile.shells, mip, layer, &linear)).collect())
            .collect();
        Self { tile, texels }
    }

    /// Number of mip levels.
    pub fn mips(&self) -> usize {
        self.texels.len()
    }

    /// Number of slabs.
    pub fn slabs(&self) -> usize {
        self.tile.shells.layers as usize - 1
    }

    /// Height of the slab of a layer above 0, m.
    pub fn slab_m(&self, layer: usize) -> f32 {
        self.tile.height_m * self.tile.shells.slabs.thickness(layer - 1)
    }

    /// Height of its middle over the skin, m.
    pub fn middle_m(&self, layer: usize) -> f32 {
        self.tile.height_m * self.tile.shells.slabs.middle(layer - 1)
    }

    /// What a shader fetches for slab `layer` (1 … layers − 1) where the view ray passes the tile's plane z = 0 at `uv`.
    pub fn fetch(&self, layer: usize, uv: Vec2, seen: &Incidence) -> Texel {
        self.fetch_middle(layer, self.middle(layer, uv, seen), seen)
    }

    /// Where the view ray through `uv` of the plane z = 0 passes the middle of slab `layer`.
    pub fn middle(&self, layer: usize, uv: Vec2, seen: &Incidence) -> Vec2 {
        uv + seen.slope() * self.middle_m(layer) / self.tile.edge_m
    }

    /// What a shader fetches for slab `layer` where the view ray passes the slab's middle at `uv`.
    pub fn fetch_middle(&self, layer: usize, uv: Vec2, seen: &Incidence) -> Texel {
        let Footprint { line, taps, level } = self.footprint(layer, seen);
        let (low, t) = (level.floor() as usize, level.fract());
        let weight = taps as f32;
        let mut sum = Texel::default();
        for tap in 0..taps {
            let at = uv + line * ((tap as f32 + 0.5) / weight - 0.5);
            sum.add(&self.bilinear(low, layer, at), (1.0 - t) / weight);
            if t > 0.0 {
                sum.add(&self.bilinear(low + 1, layer, at), t / weight);
            }
        }
        sum
    }

    /// [`Self::fetch_middle`] that takes the nearest texel of the nearest mip for each tap, not eight: for means over many
    /// pixels.
    pub fn fetch_nearest(&self, layer: usize, uv: Vec2, seen: &Incidence) -> Texel {
        let Footprint { line, taps, level } = self.footprint(layer, seen);
        let weight = taps as f32;
        let mut sum = Texel::default();
        for tap in 0..taps {
            let at = uv + line * ((tap as f32 + 0.5) / weight - 0.5);
            sum.add(self.nearest(level.round() as usize, layer, at), 1.0 / weight);
        }
        sum
    }

    /// The skin's texel of mip 0 nearest to `uv`.
    pub fn skin(&self, uv: Vec2) -> &Texel {
        self.nearest(0, 0, uv)
    }

    /// An anisotropic fetch: the pixel's footprint widened by the ray's run through the slab.
    fn footprint(&self, layer: usize, seen: &Incidence) -> Footprint {
        let run = (seen.slope() - self.tile.shells.slopes[layer]) * self.slab_m(layer) / self.tile.edge_m;
        let major = (seen.pixel * seen.pixel + run.length_squared()).sqrt();
        // Taps closer than a texel would see nothing new.
        let minor = seen.pixel.max(1.0 / self.tile.shells.size as f32);
        let taps = (major / minor).ceil().clamp(1.0, MOST_TAPS);
        let level = self.level(major.max(minor) / taps);
        Footprint { line: run.normalize_or_zero() * (major - minor).max(0.0), taps: taps as usize, level }
    }

    /// The level whose texels are `width` tile edges wide.
    fn level(&self, width: f32) -> f32 {
        libm::log2f((width * self.tile.shells.size as f32).max(1.0)).min((self.mips() - 1) as f32)
    }

    fn bilinear(&self, mip: usize, layer: usize, uv: Vec2) -> Texel {
        let size = (self.tile.shells.size >> mip).max(1) as usize;
        let p = uv * size as f32 - 0.5;
        let (x, y) = (p.x.floor(), p.y.floor());
        let (fx, fy) = (p.x - x, p.y - y);
        let texels = &self.texels[mip][layer];
        let mut sum = Texel::default();
        for (dx, dy, weight) in
            [(0, 0, (1.0 - fx) * (1.0 - fy)), (1, 0, fx * (1.0 - fy)), (0, 1, (1.0 - fx) * fy), (1, 1, fx * fy)]
        {
            let (ix, iy) = (self.wrapped(x as i64 + dx, size), self.wrapped(y as i64 + dy, size));
            sum.add(&texels[iy * size + ix], weight);
        }
        sum
    }

    fn nearest(&self, mip: usize, layer: usize, uv: Vec2) -> &Texel {
        let size = (self.tile.shells.size >> mip).max(1) as usize;
        let at = (uv * size as f32).floor();
        let (x, y) = (self.wrapped(at.x as i64, size), self.wrapped(at.y as i64, size));
        &self.texels[mip][layer][y * size + x]
    }

    /// A tile repeats; what was sampled on the skin ends at its borders.
    fn wrapped(&self, i: i64, size: usize) -> usize {
        let last = size as i64 - 1;
        match self.tile.sampled {
            Sampled::Square => (i & last) as usize,
            Sampled::Skin => i.clamp(0, last) as usize,
        }
    }

    /// Layers and their optical depths along the view ray through `uv`, without gain, from the outermost on.
    pub fn slab_depths(&self, uv: Vec2, seen: &Incidence) -> impl Iterator<Item = (usize, f32)> {
        let layers = (1..self.tile.shells.layers as usize).rev();
        layers.map(move |layer| (layer, slab_optical_depth(&self.fetch(layer, uv, seen), seen, self.slab_m(layer))))
    }

    /// Optical depth of the whole stack along the view ray through `uv`; layer 0, the skin, left out.
    pub fn optical_depth(&self, uv: Vec2, seen: &Incidence) -> f32 {
        self.slab_depths(uv, seen).map(|(layer, depth)| self.gain(layer, seen) * depth).sum()
    }

    /// Gain of a layer at the mip that the pixel asks for.
    pub fn gain(&self, layer: usize, seen: &Incidence) -> f32 {
        let level = self.level(seen.pixel);
        let theta = seen.theta_deg();
        let at = |mip: usize| gain_at(&self.tile.shells.gains[mip.min(self.mips() - 1)][layer], theta);
        let low = at(level.floor() as usize);
        low + (at(level.floor() as usize + 1) - low) * level.fract()
    }

    /// Coverage of the whole stack along the view ray through `uv`.
    pub fn coverage(&self, uv: Vec2, seen: &Incidence) -> f32 {
        -libm::expm1f(-self.optical_depth(uv, seen))
    }
}

fn decode(stack: &ShellStack, mip: usize, layer: usize, linear: &[f32; 256]) -> Vec<Texel> {
    let (medium, ends, albedo) = (&stack.medium[mip][layer], &stack.ends[mip][layer], &stack.albedo[mip][layer]);
    let texel = |i: usize| {
        let colour = &albedo.pixels[4 * i..4 * i + 4];
        let straight = Vec3::from_array([0, 1, 2].map(|c| linear[usize::from(colour[c])]));
        Texel {
            medium: HairMedium::decode(&medium.pixels[4 * i..4 * i + 4], stack.extinction_scales_per_m[mip]),
            ends: unorm(ends.pixels[i]),
            brightness: luminance(straight) * libm::expf(-above_of(colour[3])),
        }
    };
    (0..ends.pixels.len()).map(texel).collect()
}
