// Rays through the shell, from prism to prism (Andersen et al. 2016 §3.2), as src/volume/march/.
#define_import_path furrier::march

#import furrier::constants::{NOTHING, ON_SIDE, PI}
#import furrier::scene::{scene, triangles, prism_of, density_at, length_at, table_at}
#import furrier::prism::{Prism, ShellPoint, Jacobian, jacobian, rates_along, moved, inside_of, barycentric, subelement, subelement_centre}
#import furrier::undercoat::{column_over, column_crowding, code_value, decode_value, mean_sine}

// Side numbers after those of the edges opposite to corners 0, 1 and 2.
const OUT: u32 = 3u;

// Bytes by layer, then sub-element; of all prisms one after the other.
@group(1) @binding(0) var<storage, read> density: array<u32>;

// Where a march stands.
struct Walk {
    at_m: f32,
    triangle: u32,
    point: ShellPoint,
    // Length per optical depth, by the last step, m.
    per_depth_m: f32,
    // How far the last change of prism took the march along, m.
    push_m: f32,
    // Sign of the determinant at the last step, which changes at folds; 0 before the first.
    sign: f32,
    alive: bool,
    prism: Prism,
}

// One step, as its middle found it. No optical depth: nothing to see.
struct Step {
    from_m: f32,
    length_m: f32,
    triangle: u32,
    point: ShellPoint,
    hair: vec3<f32>,
    depth: f32,
}

// How finely rays are followed: optical depth and length of a step, the latter in layers.
struct Stepping {
    depth: f32,
    layers: f32,
}

fn walk_from(at_m: f32, triangle: u32, point: ShellPoint) -> Walk {
    return Walk(at_m, triangle, point, 1e30, 0.0, 0.0, true, prism_of(triangle));
}

// Density over its mean in the sub-element that holds a point. Prisms that are not stored are asked directly: the same
// value, slower.
fn crowding(triangle: u32, b: vec3<f32>, t: f32) -> f32 {
    let d = triangles[triangle].density_splits;
    let column = triangles[triangle].density_at;
    let layer = min(u32(max(t, 0.0) * f32(scene.layers)), scene.layers - 1u);
    let element = subelement(b, d);
    if column == NOTHING {
        let middle = (f32(layer) + 0.5) / f32(scene.layers);
        return decode_value(code_value(column_crowding(column_over(triangle, subelement_centre(element, d)), middle)));
    }
    let byte = column * scene.layers + (layer << (2u * d)) + element;
    return decode_value((density[byte >> 2u] >> (8u * (byte & 3u))) & 255u);
}

// Share of hairs that reach a height, all of them ended at the top.
fn reach_at(t: f32) -> f32 {
    return select(table_at(0u, t), 0.0, t >= 1.0 - 1e-4);
}

// The step of `length_m` from where a march stands. Extinction is ρ⊥ D |sin∠|; ends of hairs add (π/4) D² |cos∠| each.
fn step_of(walk: Walk, j: Jacobian, rates: vec3<f32>, length_m: f32, direction: vec3<f32>) -> Step {
    let middle = inside_of(moved(walk.point, rates, 0.5 * length_m));
    let b = barycentric(middle);
    let up_m = length(j.up_m);
    let hair = j.up_m / up_m;
    let per_square_m = scene.density_per_square_m * density_at(walk.triangle, b) * crowding(walk.triangle, b, middle.t);
    let per_volume = 2.0 * per_square_m * triangles[walk.triangle].rest_area / abs(j.determinant);
    let sine = mean_sine(length(cross(hair, direction)));
    let length_per_volume = per_volume * up_m * scene.stretch * table_at(0u, middle.t);
    let ends = abs(reach_at(walk.point.t) - reach_at(walk.point.t + rates.z * length_m));
    var end_depth = 0.0;
    if rates.z != 0.0 && ends > 0.0 {
        end_depth = per_volume * ends / abs(rates.z) * 0.25 * PI * scene.diameter_m * scene.diameter_m
            * abs(dot(hair, direction));
    }
    let depth = length_per_volume * scene.diameter_m * sine * length_m + end_depth;
    return Step(walk.at_m, length_m, walk.triangle, middle, hair, select(0.0, depth, depth >= 0.0 && depth < 1e30));
}

// The edge that a straight line in coordinates passes first, or OUT; and after how far.
struct Side {
    which: u32,
    after_m: f32,
}

fn offer(side: Side, which: u32, left: f32, rate: f32) -> Side {
    let after_m = left / max(-rate, 1e-37);
    if rate < 0.0 && after_m < side.after_m {
        return Side(which, after_m);
    }
    return side;
}

fn next_side(point: ShellPoint, rates: vec3<f32>) -> Side {
    var side = Side(OUT, 1e30);
    side = offer(side, 0u, 1.0 - point.b.x - point.b.y, -rates.x - rates.y);
    side = offer(side, 1u, point.b.x, rates.x);
    side = offer(side, 2u, point.b.y, rates.y);
    side = offer(side, OUT, 1.0 - point.t, -rates.z);
    return offer(side, OUT, point.t, rates.z);
}

// A point on the edge opposite to `corner`, in the neighbour whose `opposite` corner lies beyond it.
fn across_edge(point: ShellPoint, corner: u32, opposite: u32) -> ShellPoint {
    let b = barycentric(point);
    var beyond = vec3(0.0);
    beyond[(opposite + 1u) % 3u] = b[(corner + 2u) % 3u];
    beyond[(opposite + 2u) % 3u] = b[(corner + 1u) % 3u];
    let sum = beyond.x + beyond.y + beyond.z;
    let scale = select(0.0, 1.0 / sum, sum > 0.0);
    return ShellPoint(beyond.yz * scale, point.t);
}

// One step on. Coordinates are carried along by their gradients and put right by one Newton step; a step ends on the side it
// would pass, and the march goes on in the neighbour there.
fn advance(walk: ptr<function, Walk>, origin_m: vec3<f32>, direction: vec3<f32>, far_m: f32, stepping: Stepping) -> Step {
    let j = jacobian((*walk).prism, (*walk).point);
    let rates = rates_along(j, direction);
    var taken = Step((*walk).at_m, 0.0, (*walk).triangle, (*walk).point, vec3(0.0), 0.0);
    let largest = max(max(abs(rates.x), abs(rates.y)), abs(rates.z));
    let sign = select(1.0, -1.0, j.determinant < 0.0);
    if !(largest > 0.0 && largest < 1e37) || (*walk).sign * sign < 0.0 {
        (*walk).alive = false;
        return taken;
    }
    (*walk).sign = sign;
    // Put right what the last step's straight line left over.
    (*walk).point = moved((*walk).point, rates_along(j, origin_m + direction * (*walk).at_m - j.at_m), 1.0);
    let thickness_m = length(j.up_m) / f32(scene.layers);
    let least_m = 1e-3 * thickness_m;
    let side = next_side((*walk).point, rates);
    let longest_m = max(min(stepping.layers * thickness_m, (*walk).per_depth_m * stepping.depth), least_m);
    var length_m = min(min(longest_m, max(side.after_m, 0.0)), far_m - (*walk).at_m);
    if length_m > 0.0 {
        taken = step_of(*walk, j, rates, length_m, direction);
        if taken.depth > 2.0 * stepping.depth && length_m > least_m {
            length_m = max(length_m * stepping.depth / taken.depth, least_m);
            taken = step_of(*walk, j, rates, length_m, direction);
        }
        (*walk).per_depth_m = length_m / max(taken.depth, 1e-9);
        (*walk).at_m += length_m;
        (*walk).point = moved((*walk).point, rates, length_m);
    }
    if (*walk).at_m >= far_m {
        (*walk).alive = false;
        return taken;
    }
    if length_m < side.after_m {
        return taken;
    }
    if side.which == OUT {
        (*walk).alive = false;
        return taken;
    }
    let beyond = triangles[(*walk).triangle].beyond[side.which];
    if beyond == NOTHING {
        (*walk).alive = false;
        return taken;
    }
    (*walk).point = across_edge((*walk).point, side.which, beyond & 3u);
    (*walk).triangle = beyond >> 2u;
    (*walk).prism = prism_of(beyond >> 2u);
    // The next prism is entered a hair's breadth inside, so that rounding does not send the march back; ever deeper where
    // folded prisms pass it to and fro.
    let last_m = select(0.0, (*walk).push_m, max(length_m, 0.0) < least_m);
    (*walk).push_m = max(2.0 * last_m, ON_SIDE * least_m);
    (*walk).at_m += (*walk).push_m;
    return taken;
}
