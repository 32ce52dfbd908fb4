//! The flags that say what a run may take.

use crate::batch::estimate;
use crate::batch::run::Limits;
use crate::cli::cache_flags::CacheFlags;
use clap::Args;

/// Threads and memory of a run.
#[derive(Clone, Debug, Args)]
pub struct LimitArgs {
    /// Threads of all bakes together, 1 to 1024; the results do not depend on it. Default: all
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Memory that all bakes together are expected to keep within, as in 8GB or 500MB: fewer run at once then. Default: three
    /// quarters of what is free
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    memory: Option<u64>,
    #[command(flatten)]
    cache: CacheFlags,
}

impl LimitArgs {
    /// As the flags say.
    pub fn limits(self, fail_fast: bool) -> Limits {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        Limits {
            threads: self.threads.map_or_else(all, usize::from),
            memory_bytes: self.memory.or_else(estimate::memory_bytes),
            fail_fast,
            cache: self.cache.store(),
        }
    }
}

/// A number with a unit of bytes.
fn bytes(text: &str) -> std::result::Result<u64, String> {
    let text = text.trim();
    let at = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let unit = match text[at..].trim().to_ascii_uppercase().as_str() {
        "" | "B" => 1.0,
        "KB" | "K" => 1e3,
        "MB" | "M" => 1e6,
        "GB" | "G" => 1e9,
        "KIB" => 1024.0,
        "MIB" => 1024.0 * 1024.0,
        "GIB" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err("expected a number and B, KB, MB, GB, KiB, MiB or GiB".to_owned()),
    };
    match text[..at].parse::<f64>() {
        Ok(number) if number > 0.0 => Ok((number * unit) as u64),
        _ => Err("expected a number above 0, as in 8GB".to_owned()),
    }
}
