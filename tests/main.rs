//! The one test binary; each module says what it holds.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a test measures and why it was left out is printed"
)]

mod accuracy;
mod architecture;
mod atlas;
mod axes;
mod bake;
mod batch;
mod cache;
mod channels;
mod circles;
mod cli;
mod coat_file;
mod coat_light;
mod coats;
mod combing;
mod common;
mod crossing;
mod defocus;
mod docs;
mod field;
mod files;
mod fins;
mod formulas;
mod fuzz;
mod gains;
mod hard_renders;
mod harness;
mod hostile;
mod hybrid;
mod hybrid_twins;
mod lanes;
mod laws;
mod levels;
mod lights;
mod likeness;
mod made;
mod meshes;
mod metrics;
mod motion;
mod older_files;
mod one_skin;
mod oracle;
mod order;
mod outputs;
mod painted;
mod partings;
mod patch;
mod posed;
mod poses;
mod presets;
mod recipes;
mod regions;
mod render_cli;
mod report_coat;
mod ribbons;
mod runtime;
mod scenes;
mod seams;
mod settings;
mod shaders;
mod shadow_map;
mod shadows;
mod silhouette;
mod sphere;
mod squares;
mod stage;
mod strand_files;
mod strip;
mod summary;
#[cfg(target_os = "linux")]
mod surface;
mod sweeps;
mod thinned;
mod twins;
mod undercoat;
mod units;
mod upright;
mod validator;
mod viewer;
mod walk;
mod wild_skins;
#[cfg(feature = "window")]
mod window;
mod witness;
mod xatlas;
