//! The window: its contents on egui's own harness, and the window itself on an X server that shows nothing to anybody.

mod changes;
mod compared;
mod contents;
#[cfg(target_os = "linux")]
mod opened;
mod scripts;
