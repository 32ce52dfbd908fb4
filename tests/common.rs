//! What tests share.

use furrier::bake::picture::Grown;
use furrier::data::camera::Camera;
use furrier::stage::camera::Orbit;
use furrier::stage::light;
use furrier::volume::scene::Lighting;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The camera at an angle that frames what has grown.
pub fn framing(grown: &Grown, azimuth_deg: f64, elevation_deg: f64, distance: f64, size: [usize; 2]) -> Camera {
    Orbit { azimuth_deg, elevation_deg, distance }.camera(&grown.subject, size[0] as f64 / size[1] as f64)
}

/// The lights of the studio.
pub fn studio(camera: &Camera) -> Lighting {
    Lighting::new(&light::studio(camera))
}

/// Says that the running test, or a part of it, is left out for this reason. The reason is printed even where the test
/// passes, and goes into the file that the environment variable FURRIER_TEST_SKIPS names, which `tests/run` lists at its
/// end. With `CI=true` it is a failure.
pub fn skipped(reason: &str) {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{reason}");
    let thread = std::thread::current();
    let line = format!("{}: {reason}\n", thread.name().unwrap_or("a test"));
    // Not eprintln: what a test prints that way is shown only if it fails.
    write!(std::io::stderr(), "left out: {line}").expect("it can be said");
    if let Some(list) = std::env::var_os("FURRIER_TEST_SKIPS") {
        let file = std::fs::OpenOptions::new().append(true).create(true).open(list);
        file.and_then(|mut file| file.write_all(line.as_bytes())).expect("the list of skips can be written");
    }
}

/// The folder of meshes too large for this repository, beside the checkout: `None`, with the reason said, where it is
/// missing, so that a test which needs it can be left out.
pub fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if !folder.is_dir() {
        skipped(&format!("{} is missing", folder.display()));
        return None;
    }
    Some(folder)
}

/// The binary under test. It keeps nothing in the cache of whoever runs the tests: `.cargo/config.toml` sees to that.
pub fn furrier_path() -> &'static Path {
    let cache = std::env::var_os("FURRIER_CACHE");
    assert!(cache.is_some_and(|folder| folder.is_empty()), "tests run with FURRIER_CACHE= , as `cargo test` sets it");
    assert_cmd::cargo::cargo_bin!("furrier")
}
