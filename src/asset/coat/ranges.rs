//! The buffer without the bytes of some of its views.

use crate::asset::document::Document;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::ops::Range;

/// What is cut out is a multiple of it, so that all that stays is aligned as before.
const ALIGNMENT: usize = 8;

/// Cuts the bytes of the views `gone` out of the buffer, but for those that other views show, and moves these views. The
/// views themselves stay.
pub fn cut(document: &mut Document, gone: &BTreeSet<usize>) {
    let length = document.binary.len();
    let all: Vec<Range<usize>> =
        document.json["bufferViews"].as_array().into_iter().flatten().map(|view| range(view, length)).collect();
    let some = |wanted: bool| (all.iter().enumerate()).filter(move |(i, _)| gone.contains(i) == wanted).map(|(_, r)| r);
    let (kept, free) = (joined(some(false)), joined(some(true)));
    let mut cuts: Vec<Range<usize>> = Vec::new();
    for piece in free {
        let mut start = piece.start;
        let first = kept.partition_point(|other| other.end <= piece.start);
        for other in kept[first..].iter().take_while(|other| other.start < piece.end) {
            cuts.extend(aligned(start..other.start, other.start, length));
            start = start.max(other.end);
        }
        let next = kept.get(kept.partition_point(|other| other.start < piece.end)).map_or(length, |other| other.start);
        cuts.extend(aligned(start..piece.end, next, length));
    }
    // Bytes cut before the end of each cut.
    let mut sums = vec![0];
    cuts.iter().for_each(|cut| sums.push(sums[sums.len() - 1] + cut.len()));
    let before = |offset: usize| sums[cuts.partition_point(|cut| cut.end <= offset)];
    if let Some(views) = document.json["bufferViews"].as_array_mut() {
        for (view, range) in views.iter_mut().zip(&all) {
            let offset = range.start - before(range.start);
            if view.get("byteOffset").is_some() || offset > 0 {
                view["byteOffset"] = json!(offset);
            }
        }
    }
    let mut binary = Vec::with_capacity(length);
    let mut at = 0;
    for cut in cuts {
        binary.extend_from_slice(&document.binary[at..cut.start]);
        at = cut.end;
    }
    binary.extend_from_slice(&document.binary[at..]);
    document.binary = binary;
    if document.count("buffers") > 0 {
        document.json["buffers"][0]["byteLength"] = json!(document.binary.len());
    }
}

/// `piece` shrunk to whole multiples of the alignment. The padding behind it goes too, where nothing is before `free_until`.
fn aligned(piece: Range<usize>, free_until: usize, length: usize) -> Option<Range<usize>> {
    let start = piece.start.next_multiple_of(ALIGNMENT);
    let padded = piece.end.next_multiple_of(ALIGNMENT);
    let end = match padded <= free_until {
        true => padded,
        // The end of the buffer may be anywhere.
        false if piece.end == length => length,
        false => piece.end / ALIGNMENT * ALIGNMENT,
    };
    (start < end && !piece.is_empty()).then_some(start..end)
}

/// Ranges in their order, those that touch joined.
fn joined<'a>(ranges: impl Iterator<Item = &'a Range<usize>>) -> Vec<Range<usize>> {
    let mut sorted: Vec<&Range<usize>> = ranges.filter(|range| !range.is_empty()).collect();
    sorted.sort_by_key(|range| range.start);
    let mut joined: Vec<Range<usize>> = Vec::new();
    for range in sorted {
        match joined.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => joined.push(range.clone()),
        }
    }
    joined
}

fn range(view: &Value, length: usize) -> Range<usize> {
    let size = |key: &str| view[key].as_u64().map_or(0, |n| (n as usize).min(length));
    let start = size("byteOffset");
    start..(start + size("byteLength")).min(length)
}
