//! The epoch belongs to the bytes that bakes give.

use super::{single, triangles};
use furrier::batch::EPOCH;
use furrier::batch::content::Digest;

/// What a small bake gives in the current epoch.
const BYTES: (u32, &str) = (3, "2a3266cd164387074752efd9ce097156f1e476c0438b187840f5fa17578cb2a4");

#[test]
fn bytes_that_change_raise_the_epoch() {
    let folder = triangles(1);
    let output = single(folder.path(), &["t0.obj"]).into_values().next().unwrap();
    let now = Digest::of(&output).to_string();
    assert_eq!(
        (EPOCH, now.as_str()),
        BYTES,
        "a bake gives other bytes: raise EPOCH in src/batch/mod.rs, so that outputs of the earlier program are baked again, and enter the new pair here"
    );
}
