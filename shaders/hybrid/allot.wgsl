// Counts to positions in a list: every pixel gets a span of its own. Which one does not matter, so groups of pixels take theirs
// as they come.
#import furrier::constants::{FRAGMENTS, OVERFLOW, STARTS}
#import furrier::camera::{view, totals, spans, cursors, pixel_count, Span}

// Whether these are fragments, else starts.
override OF_FRAGMENTS: bool = false;

// Items of one pixel: some drivers end loops that run longer.
const MOST_ITEMS: u32 = 60000u;

var<workgroup> sums: array<u32, 256>;
var<workgroup> first: u32;

@compute @workgroup_size(256)
fn allot(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let at = (group.y * groups.x + group.x) * 256u + local;
    let real = at < pixel_count();
    var own = 0u;
    if real {
        own = atomicLoad(&cursors[at]);
    }
    if own > MOST_ITEMS {
        atomicMax(&totals[OVERFLOW], 1u);
    }
    sums[local] = own;
    workgroupBarrier();
    // Inclusive sums by doubling steps (Hillis and Steele 1986).
    for (var step = 1u; step < 256u; step *= 2u) {
        var before = 0u;
        if local >= step {
            before = sums[local - step];
        }
        workgroupBarrier();
        sums[local] += before;
        workgroupBarrier();
    }
    if local == 255u {
        let all = sums[255];
        var most = view.most_starts;
        if OF_FRAGMENTS {
            first = atomicAdd(&totals[FRAGMENTS], all);
            most = view.most_fragments;
        } else {
            first = atomicAdd(&totals[STARTS], all);
        }
        // Past the list's end, or past what 32 bits count.
        if first + all > most || first + all < first {
            atomicMax(&totals[OVERFLOW], 1u);
        }
    }
    workgroupBarrier();
    if real {
        var most = view.most_starts;
        if OF_FRAGMENTS {
            most = view.most_fragments;
        }
        let begin = min(first + sums[local] - own, most);
        spans[at] = Span(begin, min(begin + own, most));
        atomicStore(&cursors[at], begin);
    }
}
