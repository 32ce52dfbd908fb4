// The camera, the pixels of the band that is drawn, and triangles met by pixels' rays: src/stage/projection.rs and src/hybrid/flat.rs.
#define_import_path furrier::camera

// In place of an infinite depth.
const NO_SKIN: f32 = 1e30;

struct View {
    eye_m: vec3<f32>,
    // Distance of the picture's plane, px.
    focal_px: f32,
    // Unit vectors.
    right: vec3<f32>,
    near_m: f32,
    up: vec3<f32>,
    // Items that the lists hold at most: fragments, starts, virtual fragments.
    most_fragments: u32,
    forward: vec3<f32>,
    most_starts: u32,
    centre_px: vec2<f32>,
    // Pixels per row and rows of the whole picture.
    size: vec2<u32>,
    // First row of the band and the one past its last.
    rows: vec2<u32>,
    most_virtual_fragments: u32,
    padding: u32,
}

// Where a pixel's items lie in a list.
struct Span {
    begin: u32,
    end: u32,
}

@group(2) @binding(0) var<uniform> view: View;
// What a band came to, read back by the host, at STARTS, FRAGMENTS, VIRTUAL_FRAGMENTS, STEPS and OVERFLOW. The last is not 0 where a list
// was too short, so that the band must be drawn again.
@group(2) @binding(1) var<storage, read_write> totals: array<atomic<u32>>;
// Of every pixel of the band: ~bits of the skin's depth and ~triangle, 0 where there is no skin.
@group(2) @binding(2) var<storage, read_write> skin_depth: array<atomic<u32>>;
@group(2) @binding(3) var<storage, read_write> skin_triangle: array<atomic<u32>>;
// Depth from which undercoat hides everything, m.
@group(2) @binding(4) var<storage, read_write> opaque_m: array<f32>;
// First virtual fragment of undercoat.
@group(2) @binding(5) var<storage, read_write> heads: array<u32>;
@group(2) @binding(6) var<storage, read_write> spans: array<Span>;
// While items are counted their number; while they are filled in the next one's position.
@group(2) @binding(7) var<storage, read_write> cursors: array<atomic<u32>>;

fn camera_from_world(point_m: vec3<f32>) -> vec3<f32> {
    let p = point_m - view.eye_m;
    return vec3(dot(p, view.right), -dot(p, view.up), dot(p, view.forward));
}

// Direction from the eye through a point of the picture, of depth 1.
fn direction_through(pixel: vec2<f32>) -> vec3<f32> {
    let p = (pixel - view.centre_px) / view.focal_px;
    return view.right * p.x - view.up * p.y + view.forward;
}

// The same in camera axes.
fn ray_through(pixel: vec2<f32>) -> vec3<f32> {
    return vec3((pixel - view.centre_px) / view.focal_px, 1.0);
}

fn pixel_count() -> u32 {
    return (view.rows.y - view.rows.x) * view.size.x;
}

// Column and row in the picture of pixel `at` of the band.
fn pixel_of(at: u32) -> vec2<u32> {
    return vec2(at % view.size.x, view.rows.x + at / view.size.x);
}

fn pixel_at(pixel: vec2<u32>) -> u32 {
    return (pixel.y - view.rows.x) * view.size.x + pixel.x;
}

fn skin_z(at: u32) -> f32 {
    let bits = atomicLoad(&skin_depth[at]);
    return select(NO_SKIN, bitcast<f32>(~bits), bits != 0u);
}

// Olano and Greer 1997: planes through the eye and the edges opposite to each corner, camera axes.
struct Flat {
    plane_a: vec3<f32>,
    plane_b: vec3<f32>,
    plane_c: vec3<f32>,
    volume: f32,
}

struct Meeting {
    met: bool,
    z_m: f32,
    barycentric: vec3<f32>,
}

fn flat_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> Flat {
    let plane = cross(b, c);
    return Flat(plane, cross(c, a), cross(a, b), dot(a, plane));
}

// The camera's y points down, so the counter-clockwise side has negative volume.
fn faces_eye(shape: Flat) -> bool {
    return shape.volume < 0.0;
}

fn plane_depth(shape: Flat, ray: vec3<f32>) -> f32 {
    return shape.volume / dot(shape.plane_a + shape.plane_b + shape.plane_c, ray);
}

fn meet(shape: Flat, ray: vec3<f32>) -> Meeting {
    let e = vec3(dot(shape.plane_a, ray), dot(shape.plane_b, ray), dot(shape.plane_c, ray));
    let inside = all(e >= vec3(0.0)) || all(e <= vec3(0.0));
    let sum = e.x + e.y + e.z;
    if !inside || sum == 0.0 {
        return Meeting(false, 0.0, vec3(0.0));
    }
    let z_m = shape.volume / sum;
    return Meeting(z_m > 0.0, z_m, e / sum);
}

// Pixels whose middles may lie in a triangle: first column and row, one past the last, all within the band.
fn window_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec4<u32> {
    let low = vec2<i32>(0, i32(view.rows.x));
    let high = vec2<i32>(i32(view.size.x), i32(view.rows.y));
    let behind = u32(a.z <= view.near_m) + u32(b.z <= view.near_m) + u32(c.z <= view.near_m);
    if behind == 3u {
        return vec4(0u);
    }
    if behind > 0u {
        return vec4<u32>(vec4(low, high));
    }
    let pa = a.xy * (view.focal_px / a.z);
    let pb = b.xy * (view.focal_px / b.z);
    let pc = c.xy * (view.focal_px / c.z);
    // Clamped before they become whole numbers: points may lie far outside.
    let least = clamp(min(min(pa, pb), pc) + view.centre_px - 0.5, vec2(-1.0), vec2(1e5));
    let most = clamp(max(max(pa, pb), pc) + view.centre_px - 0.5, vec2(-2.0), vec2(1e5));
    let first = clamp(vec2<i32>(ceil(least)), low, high);
    let past = clamp(vec2<i32>(floor(most)) + 1, low, high);
    return vec4<u32>(vec4(first, max(first, past)));
}
