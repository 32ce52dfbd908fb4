//! Slices cut up, so that each thread writes to a part of its own.

/// Takes the first `count` items off a slice, which must have as many.
pub fn cut<'a, T>(rest: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, others) = std::mem::take(rest).split_at_mut(count);
    *rest = others;
    first
}
