//! What tests share.

use furrier::bake::picture::Grown;
use furrier::data::camera::Camera;
use furrier::stage::camera::Orbit;
use furrier::stage::light;
use furrier::volume::scene::Lighting;
use std::path::{Path, PathBuf};

/// The camera at an angle that frames what has grown.
pub fn framing(grown: &Grown, azimuth_deg: f64, elevation_deg: f64, distance: f64, size: [usize; 2]) -> Camera {
    Orbit { azimuth_deg, elevation_deg, distance }.camera(&grown.subject, size[0] as f64 / size[1] as f64)
}

/// The lights of the studio.
pub fn studio(camera: &Camera) -> Lighting {
    Lighting::new(&light::studio(camera))
}

/// The folder of meshes too large for this repository, beside the checkout: `None`, with the reason printed, where it
/// is missing, so that a test which needs it can be left out. With `CI=true` missing is a failure.
pub fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{} is missing", folder.display());
    eprintln!("left out: {} is missing", folder.display());
    None
}

/// The binary under test.
pub fn furrier_path() -> &'static Path {
    assert_cmd::cargo::cargo_bin!("furrier")
}
