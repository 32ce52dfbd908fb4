// The key light's shadow in hair as dense as it is in the mean, as src/volume/mean/ keeps it.
#define_import_path furrier::mean_shadow

#import furrier::constants::{LINEAR, MEAN_LAYERS, TABLES, TABLE_VALUES}
#import furrier::scene::{scene, triangles, tables, columns}
#import furrier::prism::around_corners

// Height of the tallest hair where the length field is 1, m; 0 where none grows.
fn tips_m() -> f32 {
    return max(scene.guard_top_m, scene.undercoat_top_m);
}

// Parts of a depth: undercoat, guard hair, and hair of other limbs.
fn of_level(column: u32, level: u32) -> vec3<f32> {
    let first = 3u * (column * (MEAN_LAYERS + 1u) + level) + TABLES * TABLE_VALUES;
    return vec3(tables[first], tables[first + 1u], tables[first + 2u]);
}

// Number `which` of a triangle's lattice.
fn of_column(triangle: u32, which: u32, at: f32) -> vec3<f32> {
    let column = columns[triangles[triangle].mean_at + which];
    let low = min(u32(at), MEAN_LAYERS - 1u);
    return mix(of_level(column, low), of_level(column, low + 1u), at - f32(low));
}

// Optical depths of the undercoat that a march meets and of all other hair towards the key light, at a height given as a share of
// the tips'. What hair lets through is linear from column to column; but of the hair around depth is, where a trait says so.
fn mean_depths(triangle: u32, b: vec3<f32>, share: f32) -> vec2<f32> {
    let at = clamp(share, 0.0, 1.0) * f32(MEAN_LAYERS);
    let lattice = around_corners(b, triangles[triangle].mean_splits);
    let corners = lattice.corners;
    let weights = lattice.weights;
    let around = select(1.0, 0.0, (triangles[triangle].traits & LINEAR) != 0u);
    // By part, of the three corners.
    let parts = transpose(mat3x3(of_column(triangle, corners.x, at), of_column(triangle, corners.y, at), of_column(triangle, corners.z, at)));
    let other = parts[2] + parts[1] * around;
    let all_through = dot(exp(-(other + parts[0] * around)), weights);
    let other_through = dot(exp(-other), weights);
    let depths = -log(max(vec2(all_through, other_through), vec2(1.1754944e-38)));
    let linear = vec2(dot(parts[0], weights), dot(parts[1], weights)) * (1.0 - around);
    return linear + vec2(depths.x - depths.y, depths.y);
}
