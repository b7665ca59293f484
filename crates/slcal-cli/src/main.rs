//! The `slcal` command; everything it does is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(slcal_cli::run(std::env::args_os()))
}
