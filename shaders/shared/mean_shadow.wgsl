// The key light's shadow in hair as dense as it is in the mean, as src/render/mean.rs keeps it.
#define_import_path furrier::mean_shadow

#import furrier::scene::{scene, triangles, tables, TABLE}

// Intervals of height up to the tips.
const LAYERS: u32 = 24u;
// Tables before the depths of the first vertex.
const BEFORE: u32 = 3u;

// Height of the tallest hair where the length field is 1, m; 0 where none grows.
fn tips_m() -> f32 {
    return max(scene.guard_kind.top_m, scene.undercoat_kind.top_m);
}

fn of_level(triangle: u32, b: vec3<f32>, level: u32) -> vec2<f32> {
    let first = triangles[triangle].corners * (2u * (LAYERS + 1u)) + BEFORE * (TABLE + 1u) + 2u * level;
    let undercoat = vec3(tables[first.x], tables[first.y], tables[first.z]);
    let guard = vec3(tables[first.x + 1u], tables[first.y + 1u], tables[first.z + 1u]);
    return vec2(dot(undercoat, b), dot(guard, b));
}

// Optical depths of undercoat and guard hair towards the key light, at a height given as a share of the tips'.
fn mean_depths(triangle: u32, b: vec3<f32>, share: f32) -> vec2<f32> {
    let at = clamp(share, 0.0, 1.0) * f32(LAYERS);
    let low = min(u32(at), LAYERS - 1u);
    return mix(of_level(triangle, b, low), of_level(triangle, b, low + 1u), at - f32(low));
}
