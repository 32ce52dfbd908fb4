//! `furrier devices`.

use super::console::Console;
use crate::error::Result;
use crate::gpu;
use clap::Args;
use serde_json::json;

/// List what can compute and draw here
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier devices
  furrier devices --json")]
pub struct Devices {}

impl Devices {
    /// Prints the CPU and every graphics adapter, best first; where there is none, what to install.
    ///
    /// # Errors
    /// Only where the result cannot be printed: a machine without an adapter still bakes.
    pub fn run(self, console: &Console) -> Result<()> {
        let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let adapters = gpu::adapters();
        if adapters.is_empty() {
            console.warning(&format!("no graphics adapter: nothing can be viewed; {}", gpu::missing_adapter_hint()));
        }
        console.result(&json!({ "cpu": { "threads": threads }, "gpu": adapters }), |out| {
            writeln!(out, "cpu  {threads} threads")?;
            adapters.iter().try_for_each(|adapter| writeln!(out, "gpu  {adapter}"))
        })
    }
}
