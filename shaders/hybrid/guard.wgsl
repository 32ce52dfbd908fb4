// Guard hair as camera-facing ribbons: one thread per segment of a strand, first to count the fragments of every pixel, then to
// fill the pixels' lists (docs/steps/strands.md).
#import furrier::constants::{LEAST_SHARE, OVERFLOW}
#import furrier::scene::{scene, triangles, vertices, strands, point_of}
#import furrier::camera::{view, totals, camera_from_world, pixel_at, faces_eye, flat_of, plane_depth, skin_z, skin_triangle, opaque_m, spans, cursors}
#import furrier::guard::radius_factor

override FILL: bool = false;

@group(3) @binding(0) var<storage, read_write> fragment_z: array<f32>;
// First point of the segment.
@group(3) @binding(1) var<storage, read_write> fragment_point: array<u32>;
// Two half floats: coverage, and where along the segment.
@group(3) @binding(2) var<storage, read_write> fragment_share: array<u32>;
@group(3) @binding(3) var<storage, read_write> fragment_pixel: array<u32>;

// Pixels that one thread looks at, at most: some drivers end loops that run longer.
const MOST_PIXELS: u32 = 60000u;

// A point on the picture; `across` is the axis that the ribbon runs less along.
struct Knot {
    minor: f32,
    major: f32,
    half: f32,
    z_m: f32,
}

// max(v, 0), averaged over a window of width `drift` around v.
fn ramp(v: f32, drift: f32) -> f32 {
    let half = 0.5 * drift;
    if v <= -half {
        return 0.0;
    }
    if v >= half {
        return v;
    }
    return 0.5 * (v + half) * (v + half) / drift;
}

// Whether a hair lies before the skin of a pixel's middle or, on the side that hair grows on, at its own place in the pixel; seen from
// its bare side, skin hides what lies behind either.
fn before_skin(at: u32, own_px: vec2<f32>, z_m: f32) -> bool {
    let before_middle = z_m < skin_z(at);
    let named = atomicLoad(&skin_triangle[at]);
    if named == 0u {
        return before_middle;
    }
    let c = triangles[~named].corners;
    let shape = flat_of(
        camera_from_world(vertices[c.x].position_m),
        camera_from_world(vertices[c.y].position_m),
        camera_from_world(vertices[c.z].position_m),
    );
    let before_own = z_m < plane_depth(shape, vec3((own_px - view.centre_px) / view.focal_px, 1.0));
    return select(before_middle && before_own, before_middle || before_own, faces_eye(shape));
}

// Point `i` of a strand in camera axes; where it lies behind the near plane, where its hair passes that.
fn end_of_segment(point: u32, i: u32) -> vec3<f32> {
    let p = camera_from_world(point_of(point));
    if p.z > view.near_m {
        return p;
    }
    let before = camera_from_world(point_of(point - min(i, 1u)));
    let after = camera_from_world(point_of(point + u32(i + 1u < scene.points_per_strand)));
    let other = select(after, before, before.z > view.near_m);
    if other.z <= view.near_m {
        return p;
    }
    return vec3(mix(p.xy, other.xy, (view.near_m - p.z) / (other.z - p.z)), view.near_m);
}

fn put(at: u32, z_m: f32, point: u32, coverage: f32, along: f32) {
    let slot = atomicAdd(&cursors[at], 1u);
    if FILL {
        if slot < spans[at].end {
            fragment_z[slot] = z_m;
            fragment_point[slot] = point;
            fragment_share[slot] = pack2x16float(vec2(coverage, along));
            fragment_pixel[slot] = at;
        } else {
            // Another compilation of the same formula counted fewer.
            atomicMax(&totals[OVERFLOW], 1u);
        }
    }
}

@compute @workgroup_size(64)
fn guard(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    let segments = scene.points_per_strand - 1u;
    if index >= scene.strand_count * segments {
        return;
    }
    let strand = index / segments;
    let segment = index % segments;
    let point = strand * scene.points_per_strand + segment;
    let start = end_of_segment(point, segment);
    let end = end_of_segment(point + 1u, segment + 1u);
    if min(start.z, end.z) < view.near_m || max(start.z, end.z) <= view.near_m {
        return;
    }
    let radius_m = strands[strand].root_radius_m;
    let start_px = start.xy * (view.focal_px / start.z) + view.centre_px;
    let end_px = end.xy * (view.focal_px / end.z) + view.centre_px;
    let start_half = radius_m * radius_factor(f32(segment) / f32(segments)) * view.focal_px / start.z;
    let end_half = radius_m * radius_factor(f32(segment + 1u) / f32(segments)) * view.focal_px / end.z;

    // The ribbon is cut across its major axis: segments that share an end and an axis neither overlap nor gap.
    let steep = abs(end_px.y - start_px.y) >= abs(end_px.x - start_px.x);
    let a = Knot(select(start_px.y, start_px.x, steep), select(start_px.x, start_px.y, steep), start_half, start.z);
    let b = Knot(select(end_px.y, end_px.x, steep), select(end_px.x, end_px.y, steep), end_half, end.z);
    let columns = vec2<i32>(0, i32(view.size.x));
    let rows = vec2<i32>(view.rows);
    let minor = select(rows, columns, steep);
    let major = select(columns, rows, steep);
    let run = b.major - a.major;
    if run == 0.0 {
        return;
    }
    let slope = (b.minor - a.minor) / run;
    // A ribbon of width 2·half, cut parallel to the minor axis, is this much wider along it.
    let widen = sqrt(1.0 + slope * slope);
    let low = min(a.major, b.major);
    let high = max(a.major, b.major);
    let first = i32(clamp(floor(low), f32(major.x), f32(major.y)));
    let last = i32(clamp(ceil(high), f32(major.x), f32(major.y)));
    let least = LEAST_SHARE * min(2.0 * max(start_half, end_half), 1.0);
    var seen = 0u;
    for (var row = first; row < last; row++) {
        let row_from = max(low, f32(row));
        let row_to = min(high, f32(row + 1));
        let share = row_to - row_from;
        if share <= 0.0 {
            continue;
        }
        let linear = (0.5 * (row_from + row_to) - a.major) / run;
        let centre = a.minor + linear * (b.minor - a.minor);
        let half = (a.half + linear * (b.half - a.half)) * widen;
        // Linear on the picture is not linear along the hair: undo the perspective.
        let along = linear * a.z_m / (b.z_m + linear * (a.z_m - b.z_m));
        let drift = abs(slope * share);
        let reach = half + 0.5 * drift;
        let begin = i32(clamp(floor(centre - reach), f32(minor.x), f32(minor.y)));
        let past = i32(clamp(ceil(centre + reach), f32(minor.x), f32(minor.y)));
        let z_m = a.z_m + along * (b.z_m - a.z_m);
        seen += 1u + u32(past - begin);
        if seen > MOST_PIXELS {
            atomicMax(&totals[OVERFLOW], 1u);
            return;
        }
        let own_px = mix(start_px, end_px, linear);
        var before = ramp(f32(begin) - (centre - half), drift) - ramp(f32(begin) - (centre + half), drift);
        for (var x = begin; x < past; x++) {
            let after = ramp(f32(x + 1) - (centre - half), drift) - ramp(f32(x + 1) - (centre + half), drift);
            let coverage = (after - before) * share;
            before = after;
            if coverage <= least {
                continue;
            }
            let pixel = select(vec2(row, x), vec2(x, row), steep);
            let at = pixel_at(vec2<u32>(pixel));
            if z_m > opaque_m[at] {
                continue;
            }
            let inside = clamp(own_px, vec2<f32>(pixel), vec2<f32>(pixel + 1));
            if before_skin(at, inside, z_m) {
                put(at, z_m, point, min(coverage, 1.0), along);
            }
        }
    }
}
