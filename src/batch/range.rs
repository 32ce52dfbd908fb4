//! Which items of a plan, as text: `3`, `0-9`, `0-9:3` and several with commas between, as schedulers write them.

use crate::error::{Error, Result};

/// The numbers that a text names, below `count`, sorted, each once.
///
/// # Errors
/// Where it cannot be read, or names an item that is not there.
pub fn parse(text: &str, count: usize) -> Result<Vec<usize>> {
    let fault = |expected: String| {
        Error::usage("these are no items of the plan").with_parameter("items").with_found(text).with_expected(expected)
    };
    let mut numbers = Vec::new();
    for part in text.split(',').map(str::trim) {
        let (range, step) = part.split_once(':').unwrap_or((part, "1"));
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        let parsed = (first.trim().parse::<usize>(), last.trim().parse::<usize>(), step.trim().parse::<usize>());
        let (Ok(first), Ok(last), Ok(step @ 1..)) = parsed else {
            return Err(fault("A-B, A-B:STEP, or single numbers, with commas between".into()));
        };
        if first > last || last >= count {
            return Err(fault(format!("numbers from 0 to {}, the smaller first", count.saturating_sub(1))));
        }
        numbers.extend((first..=last).step_by(step));
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}
