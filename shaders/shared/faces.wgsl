// Outer faces of the shell: tops of all prisms, and walls at open borders.
#define_import_path furrier::faces

#import furrier::scene::prism_of
#import furrier::prism::{ShellPoint, jacobian, to_side_m}
#import furrier::camera::{Flat, flat_of, camera_from_world}

// Triangle · 16 + kind · 2 + whether the prism is inside out there. Kind: 0 for the top, 1 + 2·corner for one half of the wall
// over the edge opposite to that corner, the next for its other half.
@group(3) @binding(0) var<storage, read> faces: array<u32>;

fn on_corner(corner: u32, t: f32) -> ShellPoint {
    return ShellPoint(vec2(f32(corner == 1u), f32(corner == 2u)), t);
}

// Corner `number` of a face, in its prism.
fn face_point(face: u32, number: u32) -> ShellPoint {
    let turned = (faces[face] & 1u) == 1u;
    let which = select(number, (3u - number) % 3u, turned);
    let kind = (faces[face] >> 1u) & 7u;
    if kind == 0u {
        return on_corner(which, 1.0);
    }
    let corner = (kind - 1u) / 2u;
    let first = (corner + 1u) % 3u;
    let second = (corner + 2u) % 3u;
    // One half: foot of the first, foot and top of the second; the other: foot of the first, tops of second and first.
    if which == 0u {
        return on_corner(first, 0.0);
    }
    if (kind & 1u) == 1u {
        return on_corner(second, f32(which == 2u));
    }
    return on_corner(select(first, second, which == 1u), 1.0);
}

fn face_corner(face: u32, which: u32) -> vec3<f32> {
    return jacobian(prism_of(faces[face] >> 4u), face_point(face, which)).at_m;
}

fn face_shape(face: u32) -> Flat {
    return flat_of(
        camera_from_world(face_corner(face, 0u)),
        camera_from_world(face_corner(face, 1u)),
        camera_from_world(face_corner(face, 2u)),
    );
}

// Where in its prism a point of a face lies.
fn place_on(face: u32, barycentric: vec3<f32>) -> ShellPoint {
    let a = face_point(face, 0u);
    let b = face_point(face, 1u);
    let c = face_point(face, 2u);
    return ShellPoint(mat3x2(a.b, b.b, c.b) * barycentric, dot(vec3(a.t, b.t, c.t), barycentric));
}

// How far from the eye a march starts whose ray meets a face `at_m` from it: on the side of the prism that a wall's flat halves
// stand for.
fn start_m(face: u32, barycentric: vec3<f32>, at_m: f32, eye_m: vec3<f32>, direction: vec3<f32>) -> f32 {
    let kind = (faces[face] >> 1u) & 7u;
    if kind == 0u {
        return at_m;
    }
    let prism = prism_of(faces[face] >> 4u);
    let point = place_on(face, barycentric);
    return max(at_m + to_side_m(prism, (kind - 1u) / 2u, eye_m + direction * at_m, direction, point), 0.0);
}
