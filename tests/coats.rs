//! Coats made by hand: tiles of nearly upright hair deposited as the law needs them, on a plane and on a sphere. No step
//! of the bake has a part in them.

use furrier::data::coat::{FinEdge, FinTexture, Sampled, ShellStack, Tile};
use furrier::data::image::{Image8, srgb_from_linear, unorm8};
use furrier::data::shell::{Slabs, code_above};
use furrier::math::hash::Stream;
use furrier::math::{Vec2, Vec3, Vec4};
use furrier::runtime::{CoatMesh, DrawList, SkinMesh};
use std::collections::HashMap;

/// Hair of a made tile: `per_m2` hairs, each a straight cone.
#[derive(Clone, Copy)]
pub struct Hair {
    pub per_m2: f32,
    pub root_radius_m: f32,
    pub length_m: f32,
    /// Standard deviation of the tilt, rad.
    pub tilt_rad: f32,
    /// Linear RGB at root and tip.
    pub colours: [Vec3; 2],
}

/// Guard hair and undercoat of a reddish animal.
pub fn fox() -> Vec<Hair> {
    let brown = Vec3::new(0.30, 0.16, 0.08);
    let orange = Vec3::new(0.72, 0.33, 0.11);
    vec![
        Hair { per_m2: 4.0e6, root_radius_m: 35e-6, length_m: 0.012, tilt_rad: 0.18, colours: [brown, orange] },
        Hair { per_m2: 4.0e7, root_radius_m: 9e-6, length_m: 0.006, tilt_rad: 0.35, colours: [brown * 0.7, brown] },
    ]
}

/// What is deposited per voxel.
#[derive(Clone, Copy, Default)]
struct Voxel {
    length_times_diameter: f32,
    weighted_tangent: Vec3,
    weighted_colour: Vec3,
    end_area: f32,
}

/// Bakes `hairs` into a tile by plain deposit; gains are 1.
pub fn tile(hairs: &[Hair], edge_m: f32, layers: u32, size: u32, seed: u64) -> Tile {
    let height_m = hairs.iter().map(|hair| hair.length_m).fold(0.0, f32::max);
    let slabs = layers - 1;
    let slab_m = height_m / slabs as f32;
    let texel_m = edge_m / size as f32;
    let mut voxels = vec![vec![Voxel::default(); (size * size) as usize]; layers as usize];
    let fin_size = [size, size];
    let thickness_m = 0.0015_f32.min(edge_m);
    let mut fin = vec![Voxel::default(); (fin_size[0] * fin_size[1]) as usize];
    let mut stream = Stream::new(seed);
    for hair in hairs {
        for _ in 0..(hair.per_m2 * edge_m * edge_m).round() as u32 {
            let root = Vec3::new(stream.unit() * edge_m, stream.unit() * edge_m, 0.0);
            let tilt = Vec2::new(stream.normal(), stream.normal()) * hair.tilt_rad;
            let tangent = Vec3::new(tilt.x, tilt.y, 1.0).normalize();
            let length_m = hair.length_m * (1.0 - 0.15 * stream.unit());
            let shade = 1.0 + 0.12 * stream.normal();
            let steps = 4 * size;
            for step in 0..steps {
                let s = (step as f32 + 0.5) / steps as f32;
                let piece_m = length_m / steps as f32;
                let at = root + tangent * (s * length_m);
                if at.z >= height_m {
                    break;
                }
                let diameter = 2.0 * hair.root_radius_m * (1.0 - 0.8 * s);
                let amount = piece_m * diameter;
                let colour = hair.colours[0].lerp(hair.colours[1], s) * shade;
                let slab = 1 + ((at.z / slab_m) as u32).min(slabs - 1);
                let add = |voxel: &mut Voxel, share: f32| {
                    voxel.length_times_diameter += amount * share;
                    voxel.weighted_tangent += tangent * amount * share;
                    voxel.weighted_colour += colour * amount * share;
                };
                let place = Vec2::new(at.x, at.y) / texel_m - 0.5;
                let base = place.floor();
                let fraction = place - base;
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let wx = if dx == 1 { fraction.x } else { 1.0 - fraction.x };
                    let wy = if dy == 1 { fraction.y } else { 1.0 - fraction.y };
                    let x = (base.x as i32 + dx).rem_euclid(size as i32);
                    let y = (base.y as i32 + dy).rem_euclid(size as i32);
                    let voxel = &mut voxels[slab as usize][(y as u32 * size + x as u32) as usize];
                    add(voxel, wx * wy);
                    if step + 1 == steps {
                        voxel.end_area += wx * wy * std::f32::consts::PI * hair.root_radius_m * hair.root_radius_m;
                    }
                }
                if root.y < thickness_m {
                    let x = ((at.x / edge_m * fin_size[0] as f32) as i32).rem_euclid(fin_size[0] as i32) as u32;
                    let row = (((1.0 - at.z / height_m) * fin_size[1] as f32) as u32).min(fin_size[1] - 1);
                    add(&mut fin[(row * fin_size[0] + x) as usize], 1.0);
                }
            }
        }
    }
    Tile {
        preset: "made".into(),
        sampled: Sampled::Square,
        looks: None,
        levels: vec![],
        edge_m,
        height_m,
        shells: shells(voxels, size, layers, slab_m, texel_m),
        fin: fin_texture(&fin, fin_size, edge_m, height_m, thickness_m),
    }
}

fn shells(mut voxels: Vec<Vec<Voxel>>, size: u32, layers: u32, slab_m: f32, texel_m: f32) -> ShellStack {
    let mut stack = ShellStack {
        layers,
        slabs: Slabs::even(layers as usize - 1),
        size,
        gains: vec![],
        slopes: vec![Vec2::ZERO; layers as usize],
        extinction_scales_per_m: vec![],
        albedo: vec![],
        medium: vec![],
        ends: vec![],
    };
    let mut texel_m = texel_m;
    let mut size = size;
    loop {
        let volume = texel_m * texel_m * slab_m;
        let most = voxels.iter().flatten().map(|v| v.length_times_diameter).fold(0.0, f32::max);
        let scale = most / volume;
        stack.extinction_scales_per_m.push(scale);
        let mut above = vec![0.0_f32; (size * size) as usize];
        let mut mips = (vec![], vec![], vec![]);
        for layer in voxels.iter().rev() {
            let mut images = (Image8::new(size, size, 4), Image8::new(size, size, 4), Image8::new(size, size, 1));
            let mean = layer
                .iter()
                .fold((Vec3::ZERO, 1e-20), |(c, w), v| (c + v.weighted_colour, w + v.length_times_diameter));
            let mean_colour = mean.0 / mean.1;
            for (i, voxel) in layer.iter().enumerate() {
                let extinction = voxel.length_times_diameter / volume;
                let colour = (voxel.weighted_colour + mean_colour * 1e-12) / (voxel.length_times_diameter + 1e-12);
                above[i] += 0.5 * extinction * slab_m;
                let bytes = colour.to_array().map(|c| unorm8(srgb_from_linear(c)));
                images.0.pixels[4 * i..4 * i + 3].copy_from_slice(&bytes);
                images.0.pixels[4 * i + 3] = code_above(above[i]);
                above[i] += 0.5 * extinction * slab_m;
                images.1.pixels[4 * i] = unorm8(extinction / scale);
                let weighted = voxel.weighted_tangent / (volume * scale);
                images.1.pixels[4 * i + 1..4 * i + 4].copy_from_slice(&weighted.to_array().map(signed8));
                images.2.pixels[i] = unorm8(1.0 - (-voxel.end_area / (texel_m * texel_m)).exp());
            }
            mips.0.insert(0, images.0);
            mips.1.insert(0, images.1);
            mips.2.insert(0, images.2);
        }
        stack.gains.push(vec![[1.0; 9]; layers as usize]);
        stack.albedo.push(mips.0);
        stack.medium.push(mips.1);
        stack.ends.push(mips.2);
        if size == 1 {
            return stack;
        }
        voxels = voxels.iter().map(|layer| halve(layer, size)).collect();
        size /= 2;
        texel_m *= 2.0;
    }
}

fn halve(layer: &[Voxel], size: u32) -> Vec<Voxel> {
    let half = size / 2;
    (0..half * half)
        .map(|i| {
            let (x, y) = (2 * (i % half), 2 * (i / half));
            let mut sum = Voxel::default();
            for at in [y * size + x, y * size + x + 1, (y + 1) * size + x, (y + 1) * size + x + 1] {
                let voxel = layer[at as usize];
                sum.length_times_diameter += voxel.length_times_diameter;
                sum.weighted_tangent += voxel.weighted_tangent;
                sum.weighted_colour += voxel.weighted_colour;
                sum.end_area += voxel.end_area;
            }
            sum
        })
        .collect()
}

fn signed8(value: f32) -> u8 {
    (value.clamp(-1.0, 1.0) * 127.0 + 128.5) as u8
}

fn fin_texture(fin: &[Voxel], size: [u32; 2], edge_m: f32, height_m: f32, thickness_m: f32) -> FinTexture {
    let texel_area = edge_m / size[0] as f32 * height_m / size[1] as f32;
    let (mut albedo, mut tangent) = (Image8::new(size[0], size[1], 4), Image8::new(size[0], size[1], 4));
    let row_length = size[0] as usize;
    for column in 0..row_length {
        let mut above = 0.0;
        for row in 0..size[1] as usize {
            let i = row * row_length + column;
            let voxel = fin[i];
            let depth = voxel.length_times_diameter / texel_area;
            let row_voxels = &fin[row * row_length..(row + 1) * row_length];
            let mean = row_voxels
                .iter()
                .fold((Vec3::ZERO, 1e-20), |(c, w), v| (c + v.weighted_colour, w + v.length_times_diameter));
            let colour = (voxel.weighted_colour + mean.0 / mean.1 * 1e-12) / (voxel.length_times_diameter + 1e-12);
            let direction = (voxel.weighted_tangent + Vec3::Z * 1e-12) / (voxel.length_times_diameter + 1e-12);
            above += depth * height_m / size[1] as f32 / thickness_m;
            albedo.pixels[4 * i..4 * i + 3].copy_from_slice(&colour.to_array().map(|c| unorm8(srgb_from_linear(c))));
            albedo.pixels[4 * i + 3] = unorm8(1.0 - (-depth).exp());
            tangent.pixels[4 * i..4 * i + 3].copy_from_slice(&direction.to_array().map(signed8));
            tangent.pixels[4 * i + 3] = unorm8((-above).exp());
        }
    }
    FinTexture { size, width_m: edge_m, thickness_m, albedo: mip_chain(albedo), tangent: mip_chain(tangent) }
}

fn mip_chain(image: Image8) -> Vec<Image8> {
    let mut chain = vec![image];
    while chain[chain.len() - 1].width > 1 {
        let last = &chain[chain.len() - 1];
        let mut half = Image8::new(last.width / 2, last.height / 2, 4);
        for i in 0..half.pixels.len() as u32 {
            let (x, y, c) = (i / 4 % half.width, i / 4 / half.width, (i % 4) as usize);
            let sum: u32 = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .iter()
                .map(|(dx, dy)| u32::from(last.pixel(2 * x + dx, 2 * y + dy)[c]))
                .sum();
            half.pixels[i as usize] = (sum / 4) as u8;
        }
        chain.push(half);
    }
    chain
}

/// A surface with a coat, kept so that scenes can borrow from it.
pub struct Furred {
    pub positions_m: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub offsets_m: Vec<Vec3>,
    pub uv: Vec<Vec2>,
    pub tint: Vec<Vec4>,
    pub triangles: Vec<[u32; 3]>,
    pub fins: Vec<FinEdge>,
    pub skin_colour: Vec3,
}

impl Furred {
    /// The scene of this surface wearing `tiles[0]`.
    pub fn scene<'a>(&'a self, tiles: &'a [Tile]) -> DrawList<'a> {
        let skin = SkinMesh {
            positions_m: self.positions_m.clone(),
            normals: self.normals.clone(),
            colour: vec![self.skin_colour; self.positions_m.len()],
            tile: Some(0),
            coat_uv: self.uv.clone(),
            coat_density: vec![1.0; self.positions_m.len()],
            hair_m: self.offsets_m.iter().zip(&self.normals).map(|(o, n)| o.dot(*n)).collect(),
            triangles: self.triangles.clone(),
            ..Default::default()
        };
        let fur = CoatMesh {
            tile: 0,
            positions_m: self.positions_m.clone(),
            normals: self.normals.clone(),
            offsets_m: self.offsets_m.clone(),
            axes: vec![],
            uv: self.uv.as_slice().into(),
            tint: self.tint.as_slice().into(),
            triangles: &self.triangles,
            fins: self.fins.as_slice().into(),
            ..CoatMesh::default()
        };
        DrawList { skins: vec![skin], furs: vec![fur], tiles }
    }

    /// Fins on every edge, holding the coat once.
    fn with_fins(mut self, tile: &Tile) -> Self {
        let mut faces: HashMap<[Vec3Key; 2], Vec<(u32, u32, u32)>> = HashMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                let mut ends = [key(self.positions_m[from as usize]), key(self.positions_m[to as usize])];
                ends.sort_unstable();
                faces.entry(ends).or_default().push((from, to, opposite));
            }
        }
        let mut edges: Vec<_> = faces.into_values().map(|sides| (sides[0], sides[sides.len() - 1].2)).collect();
        edges.sort_unstable();
        let length = |a: u32, b: u32| self.positions_m[a as usize].distance(self.positions_m[b as usize]);
        let total: f32 = edges.iter().map(|((a, b, _), _)| length(*a, *b)).sum();
        let corner = |t: &[u32; 3], i: usize| self.positions_m[t[i] as usize];
        let area: f32 = self
            .triangles
            .iter()
            .map(|t| 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).length())
            .sum();
        let thickness = area / total / tile.fin.thickness_m;
        let mut stream = Stream::new(7);
        self.fins = edges
            .iter()
            .map(|&((a, b, opposite), other)| {
                let start = stream.unit();
                FinEdge {
                    ends: [a, b],
                    opposite: [opposite, other],
                    u: [start, start + length(a, b) / tile.fin.width_m],
                    thickness,
                }
            })
            .collect();
        self
    }
}

type Vec3Key = [i64; 3];

fn key(p: Vec3) -> Vec3Key {
    p.to_array().map(|c| (f64::from(c) * 1e7).round() as i64)
}

/// A square of `edge_m` in the xy plane, facing +z, tile axes along x and y; hair leans by `lean_rad` along x.
pub fn plane(edge_m: f32, cells: u32, lean_rad: f32, tile: &Tile) -> Furred {
    let n = cells + 1;
    let positions_m: Vec<_> = (0..n * n)
        .map(|i| Vec3::new((i % n) as f32 / cells as f32 - 0.5, (i / n) as f32 / cells as f32 - 0.5, 0.0) * edge_m)
        .collect();
    let triangles = grid(n, n);
    let offset = Vec3::new(lean_rad.sin(), 0.0, lean_rad.cos()) * tile.height_m;
    let count = positions_m.len();
    Furred {
        normals: vec![Vec3::Z; count],
        offsets_m: vec![offset; count],
        uv: positions_m.iter().map(|p| Vec2::new(p.x, p.y) / tile.edge_m).collect(),
        tint: vec![Vec4::ONE; count],
        triangles,
        fins: vec![],
        skin_colour: Vec3::new(0.45, 0.3, 0.25),
        positions_m,
    }
    .with_fins(tile)
}

fn grid(columns: u32, rows: u32) -> Vec<[u32; 3]> {
    let mut triangles = vec![];
    for y in 0..rows - 1 {
        for x in 0..columns - 1 {
            let i = y * columns + x;
            triangles.push([i, i + 1, i + columns + 1]);
            triangles.push([i, i + columns + 1, i + columns]);
        }
    }
    triangles
}

/// A sphere of `radius_m` from a cube of `cells`² squares a side, hair leaning by `lean_rad` down the -y way.
pub fn sphere(radius_m: f32, cells: u32, lean_rad: f32, tile: &Tile) -> Furred {
    let n = cells + 1;
    let mut made = Furred {
        positions_m: vec![],
        normals: vec![],
        offsets_m: vec![],
        uv: vec![],
        tint: vec![],
        triangles: vec![],
        fins: vec![],
        skin_colour: Vec3::new(0.45, 0.3, 0.25),
    };
    let axes = [
        (Vec3::X, Vec3::Y),
        (Vec3::NEG_X, Vec3::Y),
        (Vec3::Z, Vec3::X),
        (Vec3::NEG_Z, Vec3::X),
        (Vec3::Y, Vec3::Z),
        (Vec3::NEG_Y, Vec3::Z),
    ];
    for (side, right) in axes {
        let up = side.cross(right);
        let first = made.positions_m.len() as u32;
        for i in 0..n * n {
            let angle = |at: u32| (at as f32 / cells as f32 - 0.5) * std::f32::consts::FRAC_PI_2;
            let (a, b) = (angle(i % n), angle(i / n));
            let normal = (side + right * a.tan() + up * b.tan()).normalize();
            let down = (Vec3::NEG_Y - normal * normal.dot(Vec3::NEG_Y)).normalize_or_zero();
            made.positions_m.push(normal * radius_m);
            made.normals.push(normal);
            made.offsets_m.push((normal * lean_rad.cos() + down * lean_rad.sin()) * tile.height_m);
            made.uv.push(Vec2::new(a, b) * radius_m / tile.edge_m);
            made.tint.push(Vec4::ONE);
        }
        made.triangles.extend(grid(n, n).iter().map(|t| t.map(|v| v + first)));
    }
    made.with_fins(tile)
}
