//! `inspect`'s numbers against counts made by hand.

use furrier::coat::summary::{draw_calls_note, summarise};
use furrier::data::coat::{Coat, CoatPrimitive, FinEdge, FinTexture, Sampled, ShellStack, Tile};
use furrier::data::image::Image8;
use furrier::data::shell::Slabs;
use furrier::math::{Vec2, Vec3, Vec4};

/// A tile of 5 layers of 4² with one mip level, and a quad that carries it with one fin.
fn coat() -> Coat {
    let image = |channels| vec![vec![Image8::new(4, 4, channels); 5]];
    let shells = ShellStack {
        layers: 5,
        slabs: Slabs::even(4),
        size: 4,
        gains: vec![vec![[1.0; 9]; 5]],
        slopes: vec![Vec2::ZERO; 5],
        extinction_scales_per_m: vec![1.0],
        albedo: image(4),
        medium: image(4),
        ends: image(1),
    };
    let fin_image = vec![Image8::new(8, 2, 4)];
    let fin =
        FinTexture { size: [8, 2], width_m: 0.01, thickness_m: 0.002, albedo: fin_image.clone(), tangent: fin_image };
    let worn = CoatPrimitive {
        base_vertex: vec![0, 1, 2, 3],
        uv: vec![Vec2::ZERO; 4],
        patch: vec![7, 7, 7, 9],
        offset: vec![Vec3::Y; 4],
        axis: vec![Vec3::X; 4],
        tint: vec![Vec4::ONE; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        fins: vec![FinEdge { ends: [0, 2], opposite: [1, 3], u: [0.0, 1.0], thickness: 1.0 }],
        ..CoatPrimitive::default()
    };
    let tile = Tile {
        preset: "made".into(),
        sampled: Sampled::Square,
        looks: None,
        levels: vec![],
        edge_m: 0.01,
        height_m: 0.02,
        shells,
        fin,
    };
    Coat { metres_per_unit: 1.0, tiles: vec![tile], primitives: vec![worn] }
}

#[test]
fn a_coat_is_counted_as_by_hand() {
    let summary = summarise(&coat());
    assert_eq!(summary.drawn_triangles, 2 * 4 + 2);
    assert_eq!(summary.draw_calls, 4 + 1);
    assert_eq!(summary.primitives[0].patches, 2);
    let textures = 5 * 16 * (4 + 4 + 1) + 2 * 16 * 4;
    assert_eq!(summary.tiles[0].vram_bytes, textures);
    assert_eq!(summary.vram_bytes, textures + 4 * 72 + 2 * 12 + 28);
    // 20 mm in 4 slabs: 5 mm spans 2 pixels of 1080 where the view is 2.7 m high.
    let half_view_m = summary.tiles[0].gap_distance_m * 20.0_f64.to_radians().tan();
    assert!((half_view_m - 1.35).abs() < 1e-6, "{half_view_m}");
}

#[test]
fn more_layers_fins_and_primitives_are_counted() {
    let plain = summarise(&coat());
    let mut more = coat();
    more.primitives.push(more.primitives[0].clone());
    more.primitives[1].fins.clear();
    let summary = summarise(&more);
    assert_eq!(summary.draw_calls, plain.draw_calls + 4);
    assert_eq!(summary.drawn_triangles, plain.drawn_triangles + 8);
}

#[test]
fn a_coat_of_many_draw_calls_says_how_to_have_fewer() {
    let mut many = coat();
    assert_eq!(draw_calls_note(&many), None);
    many.primitives = vec![many.primitives[0].clone(); 40];
    assert_eq!(draw_calls_note(&many), None, "200 draw calls");
    many.primitives.push(many.primitives[0].clone());
    let told = draw_calls_note(&many).unwrap();
    assert!(told.contains("205 draw calls over 41 primitives") && told.contains("joined"), "{told}");
    many.primitives.truncate(1);
    many.tiles[0].shells.layers = 300;
    let told = draw_calls_note(&many).unwrap();
    assert!(told.contains("300 draw calls") && told.contains("layers") && !told.contains("joined"), "{told}");
}
