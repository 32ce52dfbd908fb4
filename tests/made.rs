//! Coats made up for tests of files: every field has its own numbers, so that a mix-up shows.

use furrier::asset::Asset;
use furrier::data::coat::{
    Blend, Coat, CoatPrimitive, FinEdge, FinTexture, LOOK, Level, Sampled, ShellStack, Tile, TileLooks,
};
use furrier::data::image::Image8;
use furrier::data::shell::Slabs;
use furrier::math::hash::Stream;
use furrier::math::{Vec2, Vec4};

fn noise(stream: &mut Stream, size: [u32; 2], channels: u32, top: u64) -> Image8 {
    let mut image = Image8::new(size[0], size[1], channels);
    image.pixels.iter_mut().for_each(|p| *p = (stream.bits() % top) as u8);
    image
}

fn looks(seed: u64) -> TileLooks {
    let mut stream = Stream::new(seed + 2);
    let mut some = || stream.unit();
    TileLooks {
        of: std::array::from_fn(|_| std::array::from_fn::<_, LOOK, _>(|_| std::array::from_fn(|_| some()))),
        crowding: [some(), some()],
        undercoat_share: (0..5).map(|_| some()).collect(),
    }
}

/// A tile of noise: 5 layers, 8 texels, 4 mips.
pub fn tile(seed: u64) -> Tile {
    let mut stream = Stream::new(seed);
    let mut stack = |channels, top| -> Vec<Vec<Image8>> {
        (0..4).map(|mip| (0..5).map(|_| noise(&mut stream, [8 >> mip; 2], channels, top)).collect()).collect()
    };
    let (albedo, ends) = (stack(4, 256), stack(1, 60));
    let mut medium = stack(4, 256);
    // Mean tangents at most as long as the extinction they belong to.
    for image in medium.iter_mut().flatten() {
        image
            .pixels
            .as_chunks_mut::<4>()
            .0
            .iter_mut()
            .for_each(|p| *p = [p[0], 128 + p[0] / 4, 128 + p[0] / 4, 128 + p[0] / 4]);
    }
    let mut stream = Stream::new(seed + 1);
    let mut fin = || (0..4).map(|mip| noise(&mut stream, [16 >> mip, 8 >> mip], 4, 256)).collect();
    let (fin_albedo, fin_tangent) = (fin(), fin());
    Tile {
        preset: format!("made {seed}"),
        sampled: if seed.is_multiple_of(2) { Sampled::Skin } else { Sampled::Square },
        levels: if seed == 1 {
            vec![Level { shells: tile(4).shells, undercoat_share: vec![0.25; 5], most_px: 9.0 }]
        } else {
            vec![]
        },
        looks: (!seed.is_multiple_of(3)).then(|| looks(seed)),
        edge_m: 0.008,
        height_m: 0.012,
        shells: ShellStack {
            layers: 5,
            slabs: Slabs::with_tops(vec![0.0, 0.4, 0.6, 0.75, 0.95]).expect("tops rise"),
            size: 8,
            gains: (0..4)
                .map(|mip| {
                    (0..5)
                        .map(move |layer| std::array::from_fn(move |i| 1.0 + 0.01 * (mip * 45 + layer * 9 + i) as f32))
                })
                .map(Iterator::collect)
                .collect(),
            slopes: (0..5).map(|i| Vec2::new(0.1 * i as f32, -0.05 * i as f32)).collect(),
            extinction_scales_per_m: vec![250.0; 4],
            albedo,
            medium,
            ends,
        },
        fin: FinTexture { size: [16, 8], width_m: 0.008, thickness_m: 0.002, albedo: fin_albedo, tangent: fin_tangent },
    }
}

/// A coat over every part: hair along the normals, a twentieth of the asset long.
pub fn coat_for(asset: &Asset) -> Coat {
    let mut coat = Coat { metres_per_unit: 0.5, tiles: vec![tile(1), tile(2), tile(3)], primitives: Vec::new() };
    let length = 0.05 * asset.diagonal_units as f32;
    for (index, part) in asset.parts.iter().enumerate() {
        let mesh = part.mesh(1.0).expect("a part is sound");
        let n = mesh.positions_m.len();
        let uv = |v: usize| mesh.uv_sets.first().map_or(mesh.positions_m[v].truncate(), |set| set[v]);
        let fin =
            |t: &[u32; 3]| FinEdge { ends: [t[0], t[1]], opposite: [t[2], t[0]], u: [0.25, 0.75], thickness: 0.5 };
        coat.primitives.push(CoatPrimitive {
            mesh: part.mesh,
            primitive: part.primitive,
            tile: index % 2,
            base_vertex: (0..n as u32).collect(),
            uv: (0..n).map(uv).collect(),
            patch: (0..n as u32).map(|v| v % 3).collect(),
            offset: (0..n).map(|v| part.local_offset(v, mesh.normals[v] * length, 1.0)).collect(),
            axis: (0..n).map(|v| part.local_offset(v, mesh.normals[v].any_orthonormal_vector(), 1.0)).collect(),
            tint: (0..n).map(|v| Vec4::new(1.0, 0.5, (v % 7) as f32 / 7.0, 1.0)).collect(),
            normal: part.stored.normals.clone(),
            colour: None,
            painted: None,
            cut: None,
            longest: (0..n).map(|v| 1.0 / (1 + v % 5) as f32).collect(),
            triangles: mesh.triangles.clone(),
            fins: mesh.triangles.iter().map(fin).collect(),
            blend: None,
        });
        // The first part lies on the skin in two pieces, one of them passing into a third tile.
        if index == 0 && mesh.triangles.len() > 1 {
            let whole = coat.primitives.remove(0);
            let half = whole.triangles.len() / 2;
            let mut passing = whole.part(|t| t >= half);
            let weight = (0..passing.uv.len()).map(|v| (v % 5) as f32 / 4.0).collect();
            passing.blend = Some(Blend { tile: 2, weight });
            coat.primitives.extend([whole.part(|t| t < half), passing]);
        }
    }
    coat
}
