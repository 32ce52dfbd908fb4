//! Rectangles into a square, none on another.

/// Where rectangles lie and how large the whole became.
pub(super) struct Packing {
    /// Lower left corner of each rectangle.
    pub at: Vec<[u32; 2]>,
    /// Width and height that hold all of them.
    pub size: [u32; 2],
}

/// Packs rectangles of the given sizes by the lowest skyline, tallest first, into a strip about as wide as high.
pub(super) fn pack(sizes: &[[u32; 2]]) -> Packing {
    let area: f64 = sizes.iter().map(|s| f64::from(s[0]) * f64::from(s[1])).sum();
    let widest = sizes.iter().map(|s| s[0]).max().unwrap_or(0);
    // Skylines fill about nine tenths of the strip; the rest keeps the result near a square.
    let width = widest.max((area / 0.9).sqrt().ceil() as u32);
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(sizes[i][1]), std::cmp::Reverse(sizes[i][0]), i));
    // Steps of the skyline from left to right: (x where it begins, height).
    let mut skyline: Vec<(u32, u32)> = vec![(0, 0)];
    let mut packing = Packing { at: vec![[0, 0]; sizes.len()], size: [0, 0] };
    for i in order {
        let [w, h] = sizes[i];
        let (mut best, mut best_y) = (0, u32::MAX);
        for (s, &(x, _)) in skyline.iter().enumerate() {
            if x + w > width {
                break;
            }
            let y = skyline[s..].iter().take_while(|step| step.0 < x + w).map(|step| step.1).max().unwrap_or(0);
            if y < best_y {
                (best, best_y) = (s, y);
            }
        }
        let x = skyline[best].0;
        packing.at[i] = [x, best_y];
        packing.size = [packing.size[0].max(x + w), packing.size[1].max(best_y + h)];
        if w == 0 {
            continue;
        }
        let end = skyline[best..].iter().take_while(|step| step.0 <= x + w).count() + best;
        let after = skyline[end - 1].1;
        let exact = skyline.get(end - 1).is_some_and(|step| step.0 == x + w);
        let tail = (!exact && x + w < width).then_some((x + w, after));
        let keep = if exact { end - 1 } else { end };
        skyline.splice(best..keep, std::iter::once((x, best_y + h)).chain(tail));
    }
    packing
}
