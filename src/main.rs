//! The `furrier` command: everything it does is in the library's `cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    furrier::cli::run(std::env::args_os())
}
