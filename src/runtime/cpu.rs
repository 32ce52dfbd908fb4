//! The law of a shell stack on the CPU: what a fragment shader does at one pixel, in plain steps.
//!
//! A tile is worn sheared: a point (x, y, z) of the tile sits at x·X + y·Y + z·O of the skin's frame, where X and Y are
//! unit tangents and O is the coat's offset over the stack's height. Hair keeps its diameter under that map, so the
//! medium changes with it (`docs/steps/shells.md`). X is the skin's own direction, whichever way the texture lies there:
//! where a patch is stretched or turned, its picture is, and not the medium.

use crate::data::coat::{GAIN_ANGLES_DEG, Sampled, ShellStack, Tile};
use crate::data::image::linear_from_srgb;
use crate::data::light::luminance;
use crate::math::{Mat2, Mat3, Vec2, Vec3};

/// Steepest view that the law is evaluated at: cos 87°.
const LEAST_COSINE: f32 = 0.052;
/// Longest anisotropic fetch in taps, as graphics hardware has it.
const MAX_TAPS: f32 = 16.0;

/// What lies behind hair that lets less than this through is not looked at.
const HIDDEN: f32 = 1e-3;

/// A texel as a shader sees it after filtering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Lateral extinction A, 1/m.
    pub extinction: f32,
    /// A times the mean tangent, 1/m.
    pub tangent: Vec3,
    /// End opacity 1 − e^−κ.
    pub ends: f32,
    /// Luminance of the albedo times the transmittance to the outside: how bright the hair is under a light above it.
    pub brightness: f32,
}

/// A stack with its texels decoded.
pub struct Stack<'a> {
    tile: &'a Tile,
    /// `[mip][layer]`, rows from the top.
    texels: Vec<Vec<Vec<Texel>>>,
}

/// How a tile is seen at one place of the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Direction of the ray in the skin's frame (x and y along the tile's axes, z the normal), unit, pointing in: z < 0.
    pub direction: Vec3,
    /// The skin's frame from the tile's: columns X, Y, O.
    pub skin_from_tile: Mat3,
    /// What a step along X and Y is in the texture: the identity where the texture is neither stretched nor turned.
    pub texture_from_tile: Mat2,
    /// Edge of the pixel on the skin, in tile edges.
    pub pixel: f32,
}

impl View {
    /// A texture that lies as the hair does.
    pub fn new(direction: Vec3, skin_from_tile: Mat3, pixel: f32) -> Self {
        Self { direction, skin_from_tile, texture_from_tile: Mat2::IDENTITY, pixel }
    }

    /// The ray's slope in the texture: sideways run per height.
    fn slope(&self) -> Vec2 {
        let d = self.in_tile();
        self.texture_from_tile * Vec2::new(d.x, d.y) / d.z
    }

    /// The ray's direction in tile space, at least as steep as the law allows; not unit: its z counts path per height.
    fn in_tile(&self) -> Vec3 {
        let d = self.skin_from_tile.inverse() * self.direction;
        Vec3::new(d.x, d.y, d.z.min(-LEAST_COSINE * d.length()))
    }

    /// Angle between ray and tile normal, degrees.
    pub fn theta_deg(&self) -> f32 {
        let d = self.in_tile();
        libm::acosf((-d.z / d.length()).min(1.0)).to_degrees()
    }
}

/// The gain at `theta_deg`, linear between the stored angles.
pub fn gain_at(gains: &[f32; 9], theta_deg: f32) -> f32 {
    let i = GAIN_ANGLES_DEG.partition_point(|&a| a <= theta_deg).clamp(1, 8);
    let (low, high) = (GAIN_ANGLES_DEG[i - 1], GAIN_ANGLES_DEG[i]);
    let t = ((theta_deg - low) / (high - low)).clamp(0.0, 1.0);
    gains[i - 1] + (gains[i] - gains[i - 1]) * t
}

/// Optical depth of one slab of height `slab_m` (in the tile), without gain.
pub fn slab_optical_depth(texel: &Texel, view: &View, slab_m: f32) -> f32 {
    let ends = -libm::log1pf(-texel.ends.min(0.999));
    let length = texel.tangent.length();
    if texel.extinction <= 0.0 || length <= 0.0 {
        return ends;
    }
    let map = view.skin_from_tile;
    let volume = map.determinant().max(1e-6);
    let stretch = (map * (texel.tangent / length)).length();
    let extinction = texel.extinction * stretch / volume;
    let along = view.direction.dot(map * texel.tangent) / volume;
    let lateral = (extinction * extinction - along * along).max(0.0).sqrt();
    lateral * slab_m / -view.in_tile().z + ends
}

/// Optical depth where a coat passes from one tile into another, with the weight of the second.
pub fn blended(first: f32, second: f32, weight: f32) -> f32 {
    (1.0 - weight) * first + weight * second
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

    /// Height of one slab, m.
    pub fn slab_m(&self) -> f32 {
        self.tile.height_m / (self.tile.shells.layers - 1) as f32
    }

    /// What a shader fetches for slab `layer` (1 … layers − 1) where the view ray passes the tile's plane z = 0 at `uv`.
    pub fn fetch(&self, layer: usize, uv: Vec2, view: &View) -> Texel {
        let slope = view.slope();
        let middle_m = (layer as f32 - 0.5) * self.slab_m();
        self.fetch_middle(layer, uv + slope * middle_m / self.tile.edge_m, view)
    }

    /// What a shader fetches for slab `layer` where the view ray passes the slab's middle at `uv`.
    pub fn fetch_middle(&self, layer: usize, uv: Vec2, view: &View) -> Texel {
        let run = (view.slope() - self.tile.shells.slopes[layer]) * self.slab_m() / self.tile.edge_m;
        self.fetch_along(layer, uv, run, view.pixel)
    }

    /// An anisotropic fetch: the pixel's footprint widened by `run`, both in tile edges.
    fn fetch_along(&self, layer: usize, centre: Vec2, run: Vec2, pixel: f32) -> Texel {
        let size = self.tile.shells.size as f32;
        let major = (pixel * pixel + run.length_squared()).sqrt();
        let taps = (major / pixel).ceil().clamp(1.0, MAX_TAPS);
        let level = libm::log2f((major / taps * size).max(1.0)).min((self.mips() - 1) as f32);
        let axis = run.normalize_or_zero() * (major - pixel).max(0.0);
        let mut sum = Texel::default();
        for tap in 0..taps as usize {
            let at = centre + axis * ((tap as f32 + 0.5) / taps - 0.5);
            let (low, t) = (level.floor() as usize, level.fract());
            sum.add(&self.bilinear(low, layer, at), (1.0 - t) / taps);
            if t > 0.0 {
                sum.add(&self.bilinear(low + 1, layer, at), t / taps);
            }
        }
        sum
    }

    fn bilinear(&self, mip: usize, layer: usize, uv: Vec2) -> Texel {
        let size = (self.tile.shells.size >> mip).max(1) as usize;
        let p = uv * size as f32 - 0.5;
        let (x, y) = (p.x.floor(), p.y.floor());
        let (fx, fy) = (p.x - x, p.y - y);
        let last = size as i64 - 1;
        // A tile repeats; what was sampled on the skin ends at its borders.
        let cell = |i: i64| match self.tile.sampled {
            Sampled::Square => i & last,
            Sampled::Skin => i.clamp(0, last),
        };
        let texels = &self.texels[mip][layer];
        let mut sum = Texel::default();
        for (dx, dy, weight) in
            [(0, 0, (1.0 - fx) * (1.0 - fy)), (1, 0, fx * (1.0 - fy)), (0, 1, (1.0 - fx) * fy), (1, 1, fx * fy)]
        {
            let (ix, iy) = (cell(x as i64 + dx), cell(y as i64 + dy));
            sum.add(&texels[iy as usize * size + ix as usize], weight);
        }
        sum
    }

    /// Optical depth of the whole stack along the view ray through `uv`, without gain; layer 0, the skin, left out.
    pub fn optical_depth(&self, uv: Vec2, view: &View) -> f32 {
        (1..self.tile.shells.layers as usize)
            .map(|layer| slab_optical_depth(&self.fetch(layer, uv, view), view, self.slab_m()))
            .sum()
    }

    /// Gain for this view at the mip that the pixel asks for.
    pub fn gain(&self, view: &View) -> f32 {
        let level = libm::log2f((view.pixel * self.tile.shells.size as f32).max(1.0)).min((self.mips() - 1) as f32);
        let theta = view.theta_deg();
        let at = |mip: usize| gain_at(&self.tile.shells.gains[mip.min(self.mips() - 1)], theta);
        let low = at(level.floor() as usize);
        low + (at(level.floor() as usize + 1) - low) * level.fract()
    }

    /// Luminance that leaves the stack towards the eye along the view ray through `uv`, under a light of radiosity 1
    /// above: slabs from the outside in, each by its opacity, then the skin. Hair stands `density` times as dense as in the
    /// tile.
    ///
    /// Fetches take the nearest texel of the nearest mip, not eight: means over many pixels are what this is for.
    pub fn brightness(&self, uv: Vec2, view: &View, density: f32) -> f32 {
        let gain = self.gain(view) * density;
        let (slope, slab_m) = (view.slope(), self.slab_m());
        let per_edge = slab_m / self.tile.edge_m;
        let (mut through, mut seen) = (1.0, 0.0);
        for layer in (1..self.tile.shells.layers as usize).rev() {
            if through < HIDDEN {
                return seen;
            }
            let centre = uv + slope * ((layer as f32 - 0.5) * per_edge);
            let run = (slope - self.tile.shells.slopes[layer]) * per_edge;
            let texel = self.fetch_nearest(layer, centre, run, view.pixel);
            let clear = libm::expf(-gain * slab_optical_depth(&texel, view, slab_m));
            seen += through * (1.0 - clear) * texel.brightness;
            through *= clear;
        }
        seen + through * self.nearest(0, 0, uv).brightness
    }

    fn fetch_nearest(&self, layer: usize, centre: Vec2, run: Vec2, pixel: f32) -> Texel {
        let major = (pixel * pixel + run.length_squared()).sqrt();
        let taps = (major / pixel).ceil().clamp(1.0, MAX_TAPS);
        let level = libm::log2f((major / taps * self.tile.shells.size as f32).max(1.0)).round();
        let mip = (level as usize).min(self.mips() - 1);
        let axis = run.normalize_or_zero() * (major - pixel).max(0.0);
        let mut sum = Texel::default();
        for tap in 0..taps as usize {
            sum.add(self.nearest(mip, layer, centre + axis * ((tap as f32 + 0.5) / taps - 0.5)), 1.0 / taps);
        }
        sum
    }

    fn nearest(&self, mip: usize, layer: usize, uv: Vec2) -> &Texel {
        let size = (self.tile.shells.size >> mip).max(1) as i64;
        let at = (uv * size as f32).floor();
        let (x, y) = (at.x as i64 & (size - 1), at.y as i64 & (size - 1));
        &self.texels[mip][layer][(y * size + x) as usize]
    }

    /// Coverage of the whole stack along the view ray through `uv`.
    pub fn coverage(&self, uv: Vec2, view: &View) -> f32 {
        -libm::expm1f(-self.gain(view) * self.optical_depth(uv, view))
    }
}

impl Texel {
    fn add(&mut self, other: &Self, weight: f32) {
        self.extinction += other.extinction * weight;
        self.tangent += other.tangent * weight;
        self.ends += other.ends * weight;
        self.brightness += other.brightness * weight;
    }
}

fn decode(stack: &ShellStack, mip: usize, layer: usize, linear: &[f32; 256]) -> Vec<Texel> {
    let unorm = |byte: u8| f32::from(byte) / 255.0;
    let signed = |byte: u8| (f32::from(byte) - 128.0) / 127.0;
    let scale_per_m = stack.extinction_scales_per_m[mip];
    let (medium, ends, albedo) = (&stack.medium[mip][layer], &stack.ends[mip][layer], &stack.albedo[mip][layer]);
    (0..ends.pixels.len())
        .map(|i| {
            let m = &medium.pixels[4 * i..4 * i + 4];
            let a = &albedo.pixels[4 * i..4 * i + 4];
            Texel {
                extinction: unorm(m[0]) * scale_per_m,
                tangent: Vec3::new(signed(m[1]), signed(m[2]), signed(m[3])) * scale_per_m,
                ends: unorm(ends.pixels[i]),
                brightness: luminance(Vec3::from_array([0, 1, 2].map(|c| linear[usize::from(a[c])]))) * unorm(a[3]),
            }
        })
        .collect()
}
