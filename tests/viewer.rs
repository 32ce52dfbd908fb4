//! Pictures of assets with coats: framing, animation, sheets.

use crate::coats;
use furrier::asset::{self, Asset};
use furrier::data::coat::{Coat, CoatPrimitive, FinEdge};
use furrier::math::{Vec2, Vec4};
use furrier::viewer::{self, Options};

/// `tile` worn on every part of `asset` that is not bare, hair along the normals, one fin on each triangle's first edge.
pub fn dressed(asset: &Asset, tile: furrier::data::coat::Tile, metres_per_unit: f64) -> Coat {
    let mut coat = Coat { metres_per_unit, ..Coat::default() };
    for part in asset.parts.iter().filter(|part| !asset::is_bare(&part.material_name)) {
        let mesh = part.mesh(metres_per_unit).unwrap();
        let count = mesh.positions_m.len();
        let normals = mesh.smooth_normals();
        let offset = (0..count).map(|v| part.local_offset(v, normals[v] * tile.height_m, metres_per_unit)).collect();
        let edge = |a: u32, b: u32| mesh.positions_m[a as usize].distance(mesh.positions_m[b as usize]);
        let fins = mesh.triangles.iter().map(|&[a, b, c]| FinEdge {
            ends: [a, b],
            opposite: [c, c],
            u: [0.0, edge(a, b) / tile.fin.width_m],
            thickness: 0.5 * edge(b, c) / tile.fin.thickness_m,
        });
        let uv = |v: usize| {
            Vec2::new(mesh.positions_m[v].x, mesh.positions_m[v].y + 0.7 * mesh.positions_m[v].z) / tile.edge_m
        };
        coat.primitives.push(CoatPrimitive {
            mesh: part.mesh,
            primitive: part.primitive,
            tile: 0,
            base_vertex: (0..count as u32).collect(),
            uv: (0..count).map(uv).collect(),
            patch: vec![0; count],
            offset,
            tint: vec![Vec4::ONE; count],
            triangles: part.stored.triangles.clone(),
            fins: fins.collect(),
        });
    }
    coat.tiles.push(tile);
    coat
}

fn save(image: &furrier::data::image::Image8, name: &str) {
    if let Ok(folder) = std::env::var("FURRIER_PICTURES") {
        image::save_buffer(
            format!("{folder}/{name}.png"),
            &image.pixels,
            image.width,
            image.height,
            image::ColorType::Rgba8,
        )
        .unwrap();
    }
}

#[test]
fn samples() {
    for name in ["creature", "torus"] {
        let asset = asset::load(&format!("sample:{name}")).unwrap();
        let coat = dressed(&asset, coats::tile(&coats::fox(), 0.008, 16, 128, 1), 1.0);
        let options = Options { size: [640, 480], ..Options::default() };
        let shot = viewer::screenshot(&asset, &coat, &options).unwrap();
        println!("{name}: {}", serde_json::to_string(&shot.report).unwrap());
        save(&shot.image, name);
    }
}
