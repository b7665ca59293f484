//! The `slcal` command as a library: [`run`] takes the command line and returns the exit code, so that a thin binary and
//! the Python package's entry point are the same program.
//!
//! `args` is the command line as typed, `verbs` has one file per verb (load → one call of the core → print or write), `io`
//! has all files, `output` all printing and `exit` all exit codes. [`files`] is the part that the Python package uses.

mod args;
mod cloud_view;
mod exit;
pub mod files;
mod io;
mod name;
mod output;
mod picture;
mod quantile;
mod report;
mod similar;
#[cfg(feature = "studio")]
mod studio;
mod summary;
mod surface;
mod verbs;

use std::ffi::OsString;

use clap::FromArgMatches as _;

use crate::args::Cli;
use crate::exit::Failure;
use crate::output::{ColorArg, Printer, Verbosity, set_color};
use crate::report::CommandLine;

/// Runs a command line (the program's name first) and returns the exit code: 0 done, 2 wrong command line, 3 input
/// unreadable or malformed, 4 sheet, pattern or stripes not found, 5 geometry degenerate, 1 other errors.
pub fn run(args: impl IntoIterator<Item = OsString>) -> u8 {
    let args: Vec<OsString> = args.into_iter().collect();
    // Set before parsing, so that errors of the command line are coloured, too.
    let color = ColorArg::of(&args);
    set_color(color);
    let typed = CommandLine::new(&args);
    let cli = match parse(args, color) {
        Ok(cli) => cli,
        Err(message) => {
            // Help and version are results; a closed pipe while printing them is no failure.
            let _ = message.print();
            return u8::try_from(message.exit_code()).unwrap_or(2);
        }
    };
    set_color(cli.color);
    let printer = Printer::new(match (cli.quiet, cli.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Normal,
    });
    io::end_whole_on_signals();
    match verbs::run(cli.verb, &typed, printer) {
        Ok(()) => 0,
        Err(failure) => {
            if !matches!(failure, Failure::ClosedPipe | Failure::Reported(_)) {
                printer.error(&failure);
            }
            failure.code()
        }
    }
}

fn parse(args: Vec<OsString>, color: ColorArg) -> Result<Cli, clap::Error> {
    let mut command = args::command().color(color.for_clap());
    let matches = command.try_get_matches_from_mut(args).map_err(args::hinted)?;
    Cli::from_arg_matches(&matches).map_err(|e| e.format(&mut command))
}
