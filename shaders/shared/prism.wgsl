// One prism of the shell and its sub-elements, as src/volume/shell/.
#define_import_path furrier::prism

struct Prism {
    // Corners on the skin, m.
    foot_m: array<vec3<f32>, 3>,
    // Skin to the top, m.
    offset_m: array<vec3<f32>, 3>,
}

// x = Σ bᵢ (pᵢ + t oᵢ).
struct ShellPoint {
    // Barycentric coordinates of corners 1 and 2.
    b: vec2<f32>,
    // Height, 0 on the skin to 1 at the top.
    t: f32,
}

// The nearest point inside: a march that rounding or a folded prism has led astray must not read beyond the corners.
fn inside_of(point: ShellPoint) -> ShellPoint {
    let b = max(barycentric(point), vec3(0.0));
    return ShellPoint(b.yz / (b.x + b.y + b.z), clamp(point.t, 0.0, 1.0));
}

struct Jacobian {
    at_m: vec3<f32>,
    up_m: vec3<f32>,
    determinant: f32,
    // Rows of the inverse: gradients of b₁, b₂ and t, 1/m.
    gradient_b: vec3<f32>,
    gradient_c: vec3<f32>,
    gradient_t: vec3<f32>,
}

fn barycentric(point: ShellPoint) -> vec3<f32> {
    return vec3(1.0 - point.b.x - point.b.y, point.b.x, point.b.y);
}

fn moved(point: ShellPoint, rates: vec3<f32>, by: f32) -> ShellPoint {
    return ShellPoint(point.b + rates.xy * by, point.t + rates.z * by);
}

fn jacobian(prism: Prism, point: ShellPoint) -> Jacobian {
    let origin = prism.foot_m[0] + prism.offset_m[0] * point.t;
    let side_b = prism.foot_m[1] + prism.offset_m[1] * point.t - origin;
    let side_c = prism.foot_m[2] + prism.offset_m[2] * point.t - origin;
    let b = barycentric(point);
    let up_m = prism.offset_m[0] * b.x + prism.offset_m[1] * b.y + prism.offset_m[2] * b.z;
    let across = cross(side_c, up_m);
    let determinant = dot(side_b, across);
    // A flat prism has no volume: rates of zero keep a march from leaving for infinity.
    let inverse = select(0.0, 1.0 / determinant, abs(determinant) > 1.1754944e-38);
    return Jacobian(
        origin + side_b * point.b.x + side_c * point.b.y,
        up_m,
        determinant,
        across * inverse,
        cross(up_m, side_b) * inverse,
        cross(side_b, side_c) * inverse,
    );
}

fn rates_along(j: Jacobian, along: vec3<f32>) -> vec3<f32> {
    return vec3(dot(j.gradient_b, along), dot(j.gradient_c, along), dot(j.gradient_t, along));
}

// How far along a unit direction from a point, whose point is about `guess`, the side opposite to `corner` lies, m; nothing where
// it is farther than half as far as the prism is high.
fn to_side_m(prism: Prism, corner: u32, point_m: vec3<f32>, direction: vec3<f32>, guess: ShellPoint) -> f32 {
    var point = guess;
    var along_m = 0.0;
    var up_m = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let j = jacobian(prism, point);
        point = moved(point, rates_along(j, point_m + direction * along_m - j.at_m), 1.0);
        let rates = rates_along(j, direction);
        let by_m = -barycentric(point)[corner] / vec3(-rates.x - rates.y, rates.xy)[corner];
        point = moved(point, rates, by_m);
        along_m += by_m;
        up_m = length(j.up_m);
    }
    return select(0.0, along_m, abs(along_m) < 0.5 * up_m);
}

// Sub-element of a layer split d times that holds b (Andersen et al. 2016, eq. (1) and (2)).
fn subelement(b: vec3<f32>, d: u32) -> u32 {
    let n = f32(1u << d);
    let u = clamp((1.0 - b.xy) * n, vec2(0.0), vec2(n));
    let rest = clamp(2.0 * n - u.x - u.y, 0.0, n);
    let last = i32(1u << d) - 1;
    let row = min(i32(u.x), last);
    let across = min(i32(u.y), last) - min(i32(rest), last);
    return u32(row * (row + 1) + clamp(across, -row, row));
}

// Barycentric coordinates of a sub-element's centre.
fn subelement_centre(index: u32, d: u32) -> vec3<f32> {
    let n = i32(1u << d);
    let i = i32(index);
    var row = i32(sqrt(f32(index)));
    // The root may be rounded to either side.
    row = select(row, row - 1, row * row > i);
    row = select(row, row + 1, (row + 1) * (row + 1) <= i);
    let across = i - row * (row + 1);
    // i₁ + i₂ is 2n - 1 - i₀ in sub-elements that point as the triangle does, one less in the others.
    let upright = ((across + 2 * n - 1 - row) & 1) == 0;
    let sum = 2 * n - 1 - row - select(1, 0, upright);
    let rest = select(2.0 / 3.0, 1.0 / 3.0, upright);
    let at = vec3(f32(row), f32((sum + across) / 2), f32((sum - across) / 2));
    return 1.0 - (at + rest) / f32(n);
}

// Corners of the sub-elements of a level split d times: src/volume/shell/lattice.rs.
fn corners_of(d: u32) -> u32 {
    let n = 1u << d;
    return (n + 1u) * (n + 2u) / 2u;
}

// Index of the corner `i` steps towards corner 1 and `j` towards corner 2.
fn corner_index(i: u32, j: u32, d: u32) -> u32 {
    return j * (2u * (1u << d) + 3u - j) / 2u + i;
}

// Corners of the sub-element around a point of a level, and their weights.
struct Around {
    corners: vec3<u32>,
    weights: vec3<f32>,
}

fn around_corners(b: vec3<f32>, d: u32) -> Around {
    let n = f32(1u << d);
    let uv = clamp(b.yz * n, vec2(0.0), vec2(n));
    let j = min(floor(uv.y), n - 1.0);
    let i = min(floor(uv.x), n - 1.0 - j);
    let f = uv - vec2(i, j);
    let rest = 1.0 - f.x - f.y;
    // The sub-element that points the other way; none beyond the edge opposite to corner 0, where rounding may lead.
    let turned = rest < 0.0 && i + j < n - 1.0;
    let at_i = u32(i);
    let at_j = u32(j);
    let shift = select(0u, 1u, turned);
    let corners = vec3(
        corner_index(at_i + shift, at_j + shift, d),
        corner_index(at_i + 1u, at_j, d),
        corner_index(at_i, at_j + 1u, d),
    );
    return Around(corners, select(vec3(rest, f), vec3(-rest, 1.0 - f.yx), turned));
}

// Barycentric coordinates of a corner.
fn corner_point(index: u32, d: u32) -> vec3<f32> {
    let n = 1u << d;
    let side = f32(2u * n + 3u);
    var j = u32(max(0.5 * (side - sqrt(max(side * side - 8.0 * f32(index), 0.0))), 0.0));
    // The root may be rounded to either side.
    j = min(j, n);
    while j > 0u && corner_index(0u, j, d) > index {
        j--;
    }
    while j < n && corner_index(0u, j + 1u, d) <= index {
        j++;
    }
    let i = index - corner_index(0u, j, d);
    return vec3(f32(n - i - j), f32(i), f32(j)) / f32(n);
}
