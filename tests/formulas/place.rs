//! Where things lie: prisms, fields, tables, columns of undercoat, the camera.

use super::{COUNT, Worst, hold, on_device, on_sphere, open, random, reference};
use crate::scenes::{self, Grown};
use furrier::fur::undercoat::{Pattern, Undercoat};
use furrier::gpu::light::LightItem;
use furrier::gpu::{Binding, Source, Text};
use furrier::hybrid::Settings;
use furrier::hybrid::flat::Flat;
use furrier::hybrid::gpu::items::{LINEAR, StrandItem, TriangleItem, VertexItem};
use furrier::hybrid::gpu::kernels::SHARED;
use furrier::hybrid::gpu::layout::{SceneUniform, ViewUniform};
use furrier::math::hash::Stream;
use furrier::math::table::Table;
use furrier::math::{Vec2, Vec3};
use furrier::volume::march::content::TABLES as OF_SHELL;
use furrier::volume::mean;
use furrier::volume::scene::Above;
use furrier::volume::shell::prism::{Prism, ShellPoint};
use furrier::volume::shell::{lattice, sides};

/// Vectors per input.
const OUTPUTS: usize = 21;

/// Evaluates everything at inputs of eight numbers in [0, 1).
pub const MAIN: Source = Source {
    path: "formulas/place.wgsl",
    text: Text::Wgsl(
        "
#import furrier::scene::{scene, triangles, prism_of, position_at, normal_at, lean_at, tint_at, density_at, length_at, clump_at, table_at,
    point_of, unit_or}
#import furrier::prism::{ShellPoint, barycentric, moved, jacobian, rates_along, to_side_m, inside_of, around_corners, corner_point,
    corners_of}
#import furrier::scene::above_both
#import furrier::undercoat::{column_over, column_crowding}
#import furrier::mean_shadow::{mean_depths, tips_m}
#import furrier::march::{across_edge, next_side}
#import furrier::camera::{camera_from_world, direction_through, ray_through, pixel_count, pixel_of, pixel_at, flat_of, faces_eye,
    plane_depth, meet}

@group(3) @binding(0) var<storage, read> inputs: array<vec4<f32>>;
@group(3) @binding(1) var<storage, read_write> outputs: array<vec4<f32>>;

fn on_sphere(u: vec2<f32>) -> vec3<f32> {
    let z = 2.0 * u.x - 1.0;
    let r = sqrt(max(1.0 - z * z, 0.0));
    return vec3(r * cos(6.2831853 * u.y), r * sin(6.2831853 * u.y), z);
}

@compute @workgroup_size(64)
fn formulas(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    let a = inputs[2u * i];
    let c = inputs[2u * i + 1u];
    let triangle = u32(a.x * f32(scene.triangle_count));
    let r = sqrt(a.y);
    let place = ShellPoint(vec2(r * (1.0 - a.z), r * a.z), a.w);
    let b = barycentric(place);
    let along = on_sphere(c.xy);
    let prism = prism_of(triangle);
    let j = jacobian(prism, place);
    let rates = rates_along(j, along);
    let first = 21u * i;
    outputs[first] = vec4(j.at_m, j.determinant);
    outputs[first + 1u] = vec4(j.up_m, table_at(u32(c.z * 3.0), 1.2 * c.w - 0.1));
    outputs[first + 2u] = vec4(rates, tips_m());
    let beside = moved(place, vec3(c.zw - 0.5, 0.3), 0.5);
    let corner = u32(c.z * 3.0);
    outputs[first + 3u] = vec4(beside.b, beside.t, to_side_m(prism, corner, j.at_m, along, place));
    let inside = inside_of(ShellPoint(3.0 * c.xy - 1.0, 3.0 * c.z - 1.0));
    outputs[first + 4u] = vec4(inside.b, inside.t, density_at(triangle, b));
    let d = u32(c.w * 6.0);
    let around = around_corners(b, d);
    outputs[first + 5u] = vec4(vec3<f32>(around.corners), length_at(triangle, b));
    outputs[first + 6u] = vec4(around.weights, clump_at(triangle, b));
    outputs[first + 7u] = vec4(corner_point(u32(c.z * f32(corners_of(d))), d), f32(corners_of(d)));
    outputs[first + 8u] = vec4(normal_at(triangle, b), above_both(a.x, 0.5 + a.y, 0.03 * a.z));
    outputs[first + 9u] = vec4(lean_at(triangle, b, vec3(1.0)), 0.0);
    outputs[first + 10u] = vec4(tint_at(triangle, b), column_crowding(column_over(triangle, b), a.w));
    outputs[first + 11u] = vec4(point_of(u32(c.z * 100.0)), 0.0);
    outputs[first + 12u] = vec4(unit_or(select(vec3(0.0), along, c.z > 0.5), vec3(1.0, 2.0, 3.0)), 0.0);
    outputs[first + 13u] = vec4(mean_depths(triangle, b, 1.2 * c.w - 0.1), 0.0, 0.0);
    let beyond = across_edge(place, corner, u32(c.w * 3.0));
    outputs[first + 14u] = vec4(beyond.b, beyond.t, 0.0);
    let side = next_side(place, along);
    outputs[first + 15u] = vec4(f32(side.which), side.after_m, f32(pixel_count()), 0.0);
    let point_m = 0.1 * along;
    let pixel = c.zw * 100.0;
    let at = u32(c.z * 1000.0);
    outputs[first + 16u] = vec4(camera_from_world(point_m), f32(pixel_at(pixel_of(at))));
    outputs[first + 17u] = vec4(direction_through(pixel), f32(pixel_of(at).y));
    outputs[first + 18u] = vec4(ray_through(pixel), 0.0);
    let shape = flat_of(vec3(a.x, -a.y, 1.0 + a.z), vec3(-a.y, a.z, 1.0 + a.w), vec3(-a.w, -a.x, 1.0 + a.y));
    let ray = vec3(0.5 * (c.xy - 0.5), 1.0);
    let meeting = meet(shape, ray);
    outputs[first + 20u] = vec4(position_at(triangle, b), 0.0);
    outputs[first + 19u] = vec4(select(-1.0, meeting.z_m, meeting.met), select(0.0, 1.0, faces_eye(shape)),
        plane_depth(shape, ray), meeting.barycentric.y);
}
",
    ),
};

/// Tables before them: those of the undercoat's shell, and that of hair above.
const TABLES: usize = OF_SHELL + 1;

/// Columns of the mean shadow per triangle: those of a level split once.
const COLUMNS: u32 = 6;

#[test]
fn shaders_and_rust_agree_on_where_things_lie() {
    let (guard, undercoat) = scenes::mink();
    let mesh = scenes::grid(4, 4, |u, v| Vec3::new(u - 0.5, 0.2 * (3.0 * u).sin() * v, 0.5 - v) * 0.05);
    let mut grown = Grown::new(mesh, &guard, &undercoat, Vec3::X, 35.0, 3);
    let mut stream = Stream::new(12);
    for v in 0..grown.mesh.positions_m.len() {
        grown.fields.length[v] = 0.5 + stream.unit();
        grown.fields.density[v] = stream.unit();
        grown.fields.clump[v] = stream.unit();
        grown.fields.tint[v] = Vec3::new(stream.unit(), stream.unit(), stream.unit());
    }
    let scene = grown.scene();
    let (normals, fields) = (scene.skin.smooth_normals(), scene.fields);
    let mut volume = Undercoat::new(&grown.undercoat_fibre, Some(Pattern::default()));
    (volume.clump_spacing_m, volume.clump_strength) = (4e-3, 0.6);
    let offsets_m: Vec<Vec3> = (0..normals.len()).map(|v| fields.lean[v] * 0.012 * fields.length[v]).collect();
    let mut uniform = SceneUniform::new(
        &scene,
        &Above::new([Some(&grown.guard_fibre), Some(&grown.undercoat_fibre)]),
        &scenes::studio(),
        &Settings::default(),
    );
    (uniform.pattern_amplitude, uniform.pattern_jitter) = (volume.pattern.amplitude, volume.pattern.jitter);
    uniform.pattern_wavelength_m = volume.wavelength_m();
    (uniform.clump_spacing_m, uniform.clump_strength) = (volume.clump_spacing_m, volume.clump_strength);

    // Tables by chance, then depths of columns.
    let triangles = scene.skin.triangles.len() as u32;
    let levels = mean::LAYERS as u32 + 1;
    let depths_at = TABLES * Table::VALUES;
    let tables: Vec<f32> = (0..depths_at as u32 + 3 * levels * COLUMNS * triangles).map(|_| stream.unit()).collect();
    let columns: Vec<u32> = (0..COLUMNS * triangles).collect();
    let items: Vec<TriangleItem> = (0..triangles)
        .map(|t| {
            let mut item: TriangleItem = bytemuck::Zeroable::zeroed();
            item.corners = scene.skin.triangles[t as usize];
            item.traits = if t % 2 == 0 { LINEAR } else { 0 };
            (item.mean_at, item.mean_splits) = (COLUMNS * t, 1);
            item
        })
        .collect();
    let view = scenes::view(&scenes::camera(0.3), [100, 80]);
    let gpu = open();
    let list = |label: &str, bytes: &[u8]| gpu.buffer(label, bytes, wgpu::BufferUsages::STORAGE);
    let points: Vec<f32> = grown.guard.points_m.iter().flat_map(|p| p.to_array()).collect();
    let buffers = vec![
        gpu.buffer("scene", &[uniform], wgpu::BufferUsages::UNIFORM),
        list("triangles", bytemuck::cast_slice(&items)),
        list("vertices", bytemuck::cast_slice(&VertexItem::of(&scene, &normals, &offsets_m))),
        list("tables", bytemuck::cast_slice(&tables)),
        list("lights", bytemuck::cast_slice(&scenes::studio().all().map(LightItem::from).collect::<Vec<_>>())),
        list("strands", bytemuck::cast_slice(&StrandItem::of(&grown.guard))),
        list("points", bytemuck::cast_slice(&points)),
        list("columns", bytemuck::cast_slice(&columns)),
    ];
    let read = Binding::Read;
    let frame = gpu.buffer("view", &[ViewUniform::new(&view, [10, 40])], wgpu::BufferUsages::UNIFORM);
    let groups: [super::Group<'_>; 3] = [
        (&[Binding::Uniform, read, read, read, read, read, read, read], buffers),
        (&[], vec![]),
        (&[Binding::Uniform], vec![frame]),
    ];
    let inputs = random(2, 8);
    let outputs = on_device(&gpu, &SHARED, MAIN, &groups, &inputs, OUTPUTS);

    let mut worst = Worst::default();
    let mut at_walls = 0;
    for i in 0..COUNT {
        let (a, c, out) = (inputs[2 * i], inputs[2 * i + 1], &outputs[OUTPUTS * i..][..OUTPUTS]);
        let triangle = (a.x * triangles as f32) as usize;
        let r = a.y.sqrt();
        let place = ShellPoint { b: [r * (1.0 - a.z), r * a.z], t: a.w };
        let b = place.barycentric();
        let corners = scene.skin.triangles[triangle].map(|v| v as usize);
        let mix = |of: &dyn Fn(usize) -> Vec3| of(corners[0]) * b.x + of(corners[1]) * b.y + of(corners[2]) * b.z;
        let mix1 = |of: &[f32]| of[corners[0]] * b.x + of[corners[1]] * b.y + of[corners[2]] * b.z;
        let along = on_sphere(Vec2::new(c.x, c.y));
        let prism =
            Prism { foot_m: corners.map(|v| scene.skin.positions_m[v]), offset_m: corners.map(|v| offsets_m[v]) };
        let j = prism.jacobian(&place);
        let rates = j.rates(along);
        let on_skin_m = mix(&|v| scene.skin.positions_m[v]);
        worst.note_all(i, "position on the skin", out[20].truncate() * 100.0, on_skin_m * 100.0);
        worst.note_all(i, "position", out[0].truncate() * 100.0, j.at_m * 100.0);
        worst.note(i, "determinant", out[0].w * 1e6, j.determinant * 1e6);
        worst.note_all(i, "way up", out[1].truncate() * 100.0, j.up_m * 100.0);
        worst.note_all(i, "rates", out[2].truncate() / rates.length(), rates / rates.length());
        worst.note(
            i,
            "tips",
            out[2].w * 100.0,
            100.0 * grown.guard_fibre.height_m().max(grown.undercoat_fibre.height_m()),
        );
        let above = &tables[OF_SHELL * Table::VALUES..][..Table::VALUES];
        let share = 0.03 * a.z / (uniform.above_top_m * (0.5 + a.y));
        let expected = a.x * (0.5 + a.y) * Table::new(|x| above[(x * 256.0).round() as usize]).at(share);
        worst.note(i, "hair above", out[8].w, expected);
        let table = &tables[(c.z * 3.0) as usize * Table::VALUES..][..Table::VALUES];
        worst.note(i, "table", out[1].w, Table::new(|x| table[(x * 256.0).round() as usize]).at(1.2 * c.w - 0.1));
        let beside = place.moved(Vec3::new(c.z - 0.5, c.w - 0.5, 0.3), 0.5);
        worst.note_all(i, "moved", out[3].truncate(), Vec3::new(beside.b[0], beside.b[1], beside.t));
        let corner = (c.z * 3.0) as usize;
        let towards = [-rates.x - rates.y, rates.x, rates.y][corner].abs();
        let (side_m, up_m) = (prism.to_side_m(corner, j.at_m, along, place), j.up_m.length());
        // Along a side, or half the prism's height away from one, roundings decide.
        if towards > 0.2 * rates.abs().max_element() && side_m.abs() < 0.4 * up_m && side_m != 0.0 {
            worst.note(i, "way to a side", out[3].w * 100.0, side_m * 100.0);
        }
        let inside = reference::inside(Vec3::new(3.0 * c.x - 1.0, 3.0 * c.y - 1.0, 3.0 * c.z - 1.0));
        worst.note_all(i, "inside", out[4].truncate(), inside);
        for (what, got, field) in [
            ("density", out[4].w, &fields.density),
            ("length", out[5].w, &fields.length),
            ("clumps", out[6].w, &fields.clump),
        ] {
            worst.note(i, what, got, mix1(field));
        }
        let d = (c.w * 6.0) as u32;
        let (around, weights) = lattice::around(d, b);
        if weights.min_element() > 1e-4 {
            assert_eq!(out[5].truncate(), Vec3::from(around.map(|corner| corner as f32)), "corners around {b} of {d}");
            worst.note_all(i, "weights", out[6].truncate(), weights);
        }
        assert_eq!(out[7].w, lattice::corners(d) as f32, "corners of {d}");
        let at = lattice::points(d).nth((c.z * lattice::corners(d) as f32) as usize);
        worst.note_all(i, "corner", out[7].truncate(), at.unwrap());
        let normal = mix(&|v| normals[v]).normalize();
        worst.note_all(i, "normal", out[8].truncate(), normal);
        worst.note_all(i, "lean", out[9].truncate(), mix(&|v| fields.lean[v]).normalize());
        worst.note_all(i, "tint", out[10].truncate(), mix(&|v| fields.tint[v]));
        let crowding = volume.column(mix(&|v| scene.skin.positions_m[v]), normal, mix1(&fields.clump)).crowding(a.w);
        // At a clump's wall density falls to nothing.
        if (out[10].w == 0.0) == (crowding == 0.0) {
            worst.note(i, "crowding", out[10].w, crowding);
        } else {
            at_walls += 1;
        }
        worst.note_all(i, "point", out[11].truncate() * 100.0, grown.guard.points_m[(c.z * 100.0) as usize] * 100.0);
        let unit = if c.z > 0.5 { along } else { Vec3::new(1.0, 2.0, 3.0) };
        worst.note_all(i, "unit vector", out[12].truncate(), unit);
        let columns = |which: u32| (triangle as u32 * COLUMNS + which) as usize;
        let of_level = |which: u32, level: usize| {
            let first = depths_at + 3 * (columns(which) * levels as usize + level);
            Vec3::new(tables[first], tables[first + 1], tables[first + 2])
        };
        let shadow = reference::mean_depths(of_level, b, 1.2 * c.w - 0.1, triangle.is_multiple_of(2));
        worst.note(i, "mean shadow of undercoat", out[13].x, shadow[0]);
        worst.note(i, "mean shadow of other hair", out[13].y, shadow[1]);
        let beyond = sides::across(&place, corner, (c.w * 3.0) as usize);
        worst.note_all(i, "across an edge", out[14].truncate(), Vec3::new(beyond.b[0], beyond.b[1], beyond.t));
        let (which, after) = reference::next_side(&place, along);
        assert_eq!(out[15].x, which, "side of input {i}");
        worst.note(i, "way to the next side", out[15].y, after);
        assert_eq!(out[15].z, 30.0 * 100.0, "pixels of the band");
        let at = (c.z * 1000.0) as u32;
        assert_eq!((out[16].w, out[17].w), (at as f32, (10 + at / 100) as f32), "pixel {at}");
        worst.note_all(i, "camera", out[16].truncate(), view.camera_from_world(0.1 * along));
        let pixel = Vec2::new(c.z, c.w) * 100.0;
        worst.note_all(i, "direction", out[17].truncate(), view.direction(pixel));
        worst.note_all(i, "ray", out[18].truncate(), ((pixel - view.centre_px) / view.focal_px).extend(1.0));
        let corners =
            [Vec3::new(a.x, -a.y, 1.0 + a.z), Vec3::new(-a.y, a.z, 1.0 + a.w), Vec3::new(-a.w, -a.x, 1.0 + a.y)];
        let shape = Flat::new(corners);
        let ray = Vec3::new(0.5 * (c.x - 0.5), 0.5 * (c.y - 0.5), 1.0);
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        // Seen along itself a plane is nowhere.
        if area.dot(ray).abs() > 0.05 * area.length() {
            assert_eq!(out[19].y == 1.0, shape.faces_eye(), "side of triangle {i}");
            worst.note(i, "plane", out[19].z, shape.plane_depth(ray));
            match shape.meet(ray) {
                Some(meeting) if meeting.barycentric.min_element() > 1e-4 => {
                    worst.note(i, "triangle", out[19].x, meeting.z_m);
                    worst.note(i, "where on a triangle", out[19].w, meeting.barycentric.y);
                }
                Some(_) => {}
                None => assert!(out[19].x == -1.0 || out[19].w.abs() < 1e-4, "triangle {i} is met"),
            }
        }
    }
    println!("{at_walls} at clumps' walls");
    assert!(at_walls < COUNT / 100, "{at_walls} on the wrong side of a clump's wall");
    hold(worst.faults(1e-4));
}
