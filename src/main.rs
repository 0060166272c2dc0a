//! The `darkness` program: see `darkness --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    darkness::cli::run()
}
