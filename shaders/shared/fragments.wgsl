// Fragments of guard hair in the order of (depth, id, point), one pixel after the other.
#define_import_path furrier::fragments

#import furrier::scene::{scene, strands}
#import furrier::camera::{spans, cursors}

@group(3) @binding(0) var<storage, read> fragment_z: array<f32>;
// First point of the segment.
@group(3) @binding(1) var<storage, read> fragment_point: array<u32>;
// Two half floats: coverage, and where along the segment.
@group(3) @binding(2) var<storage, read> fragment_share: array<u32>;
// Places in the lists above.
@group(3) @binding(3) var<storage, read> fragment_order: array<u32>;

// A fragment, segments of one hair that follow each other joined.
struct Fragment {
    // Whether there was one more.
    real: bool,
    z_m: f32,
    point: u32,
    coverage: f32,
    along: f32,
}

// What is left of a pixel's fragments.
struct Reader {
    next: u32,
    end: u32,
}

fn hair_of(point: u32) -> u32 {
    return strands[point / scene.points_per_strand].id;
}

fn read_from(at: u32) -> Reader {
    return Reader(spans[at].begin, min(atomicLoad(&cursors[at]), spans[at].end));
}

// The next fragment; neighbouring segments of one hair cover it once.
fn next_fragment(reader: ptr<function, Reader>) -> Fragment {
    if (*reader).next >= (*reader).end {
        return Fragment(false, 0.0, 0u, 0.0, 0.0);
    }
    let slot = fragment_order[(*reader).next];
    let share = unpack2x16float(fragment_share[slot]);
    var taken = Fragment(true, fragment_z[slot], fragment_point[slot], share.x, share.y);
    let id = hair_of(taken.point);
    (*reader).next++;
    while (*reader).next < (*reader).end {
        let following = fragment_order[(*reader).next];
        if hair_of(fragment_point[following]) != id {
            break;
        }
        taken.coverage = min(taken.coverage + unpack2x16float(fragment_share[following]).x, 1.0);
        (*reader).next++;
    }
    return taken;
}
