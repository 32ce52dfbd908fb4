// What a picture shows, the same for every pass: skin, fields, hair, lights.
#define_import_path furrier::scene

#import furrier::constants::TABLE_VALUES
#import furrier::prism::Prism
#import furrier::light::Light

struct Scene {
    triangle_count: u32,
    layers: u32,
    strand_count: u32,
    points_per_strand: u32,

    light_count: u32,
    // How many of the lights fall on undercoat.
    undercoat_light_count: u32,
    // Outer faces of the shell, and prisms that hold the eye.
    face_count: u32,
    inside_count: u32,

    // Undercoat.
    density_per_square_m: f32,
    diameter_m: f32,
    stretch: f32,
    slope: f32,
    pattern_amplitude: f32,
    pattern_wavelength_m: f32,
    pattern_jitter: f32,
    clump_spacing_m: f32,
    clump_strength: f32,
    step_depth: f32,
    step_layers: f32,
    // Virtual fragments per march.
    groups: f32,

    // Radiance from everywhere.
    ambient: vec3<f32>,
    // Attenuation of simplified blending, 1/m.
    attenuation_per_m: f32,
    skin_factor: vec3<f32>,
    taper: f32,

    undercoat_ramp: array<vec4<f32>, 3>,
    guard_ramp: array<vec4<f32>, 3>,
    // Heights of the tallest hair where the length field is 1, m; of both kinds in the table of hair area above.
    guard_top_m: f32,
    undercoat_top_m: f32,
    above_top_m: f32,

    tip_transparency: f32,
    tip_exponent: f32,
    // Transmittance below which what is seen already stands for what is behind it.
    opaque: f32,
    // Hair area per volume times diameter of guard hair, where the density field is 1, and of undercoat.
    guard_crowding: f32,
    undercoat_crowding: f32,
}

struct Triangle {
    corners: vec3<u32>,
    // Subdivisions of the stored density.
    density_splits: u32,
    // Beyond the edges opposite to each corner: triangle · 4 + its opposite corner, or nothing.
    beyond: vec3<u32>,
    // Subdivisions of the stored shadow.
    shadow_splits: u32,
    // First column of sub-elements in the stored density, or nothing; the same in the stored shadow.
    density_at: u32,
    shadow_at: u32,
    // Of the skin at rest, m².
    rest_area: f32,
    // AT_BORDER, LINEAR.
    traits: u32,
    // Subdivisions of the mean shadow, and where its columns begin.
    mean_splits: u32,
    mean_at: u32,
}

struct Vertex {
    position_m: vec3<f32>,
    density: f32,
    // Skin to the top of the shell, m.
    offset_m: vec3<f32>,
    length: f32,
    normal: vec3<f32>,
    clump: f32,
    lean: vec3<f32>,
    tint: vec3<f32>,
    // Of the skin at rest: patterns keep to it, so that they do not swim under a moving skin.
    rest_m: vec3<f32>,
    rest_normal: vec3<f32>,
}

struct Strand {
    tint: vec3<f32>,
    id: u32,
    // Of the root, corners 0 and 1.
    b: vec2<f32>,
    triangle: u32,
    root_radius_m: f32,
}

@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(2) var<storage, read> vertices: array<Vertex>;
// By heights of the undercoat's shell: share of hairs that reach it; hair area above it, of both kinds; where between stored levels
// of shadow it lies. By heights of above_top_m: hair area above. Then what shared/mean_shadow.wgsl reads.
@group(0) @binding(3) var<storage, read> tables: array<f32>;
// The first is the key.
@group(0) @binding(4) var<storage, read> lights: array<Light>;
@group(0) @binding(5) var<storage, read> strands: array<Strand>;
@group(0) @binding(6) var<storage, read> points_m: array<f32>;
// Of the mean shadow, by triangle and corner of its lattice.
@group(0) @binding(7) var<storage, read> columns: array<u32>;

fn prism_of(triangle: u32) -> Prism {
    let c = triangles[triangle].corners;
    return Prism(
        array(vertices[c.x].position_m, vertices[c.y].position_m, vertices[c.z].position_m),
        array(vertices[c.x].offset_m, vertices[c.y].offset_m, vertices[c.z].offset_m),
    );
}

fn position_at(triangle: u32, b: vec3<f32>) -> vec3<f32> {
    let c = triangles[triangle].corners;
    return vertices[c.x].position_m * b.x + vertices[c.y].position_m * b.y + vertices[c.z].position_m * b.z;
}

fn normal_at(triangle: u32, b: vec3<f32>) -> vec3<f32> {
    let c = triangles[triangle].corners;
    let sum = vertices[c.x].normal * b.x + vertices[c.y].normal * b.y + vertices[c.z].normal * b.z;
    return unit_or(sum, vec3(0.0, 1.0, 0.0));
}

fn lean_at(triangle: u32, b: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let c = triangles[triangle].corners;
    return unit_or(vertices[c.x].lean * b.x + vertices[c.y].lean * b.y + vertices[c.z].lean * b.z, otherwise);
}

fn tint_at(triangle: u32, b: vec3<f32>) -> vec3<f32> {
    let c = triangles[triangle].corners;
    return vertices[c.x].tint * b.x + vertices[c.y].tint * b.y + vertices[c.z].tint * b.z;
}

fn density_at(triangle: u32, b: vec3<f32>) -> f32 {
    let c = triangles[triangle].corners;
    return vertices[c.x].density * b.x + vertices[c.y].density * b.y + vertices[c.z].density * b.z;
}

fn length_at(triangle: u32, b: vec3<f32>) -> f32 {
    let c = triangles[triangle].corners;
    return vertices[c.x].length * b.x + vertices[c.y].length * b.y + vertices[c.z].length * b.z;
}

fn clump_at(triangle: u32, b: vec3<f32>) -> f32 {
    let c = triangles[triangle].corners;
    return vertices[c.x].clump * b.x + vertices[c.y].clump * b.y + vertices[c.z].clump * b.z;
}

// A table's value at height t, linear in between.
fn table_at(table: u32, t: f32) -> f32 {
    let at = clamp(t, 0.0, 1.0) * f32(TABLE_VALUES - 1u);
    let low = min(u32(at), TABLE_VALUES - 2u);
    let first = table * TABLE_VALUES + low;
    return tables[first] + (at - f32(low)) * (tables[first + 1u] - tables[first]);
}

fn point_of(index: u32) -> vec3<f32> {
    return vec3(points_m[3u * index], points_m[3u * index + 1u], points_m[3u * index + 2u]);
}

fn unit_or(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let size = length(v);
    return select(otherwise, v / size, size > 1e-30);
}

// Hair area of both kinds above `height_m` per skin area.
fn above_both(density: f32, length: f32, height_m: f32) -> f32 {
    return density * length * table_at(3u, height_m / max(scene.above_top_m * length, 1e-30));
}
