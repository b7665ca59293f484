//! One file per verb: load → one call of the core → print or write.

mod advise;
mod bug_report;
mod calibrate;
mod decode;
mod demo;
mod evaluate;
mod exchange;
mod pattern;
mod reconstruct;
mod rectify;
mod report;
mod scans;
mod sequence;
mod shell;
mod simulate;
mod triangulate;
mod verify;

use crate::args::Verb;
use crate::exit::Outcome;
use crate::io::photographs;
use crate::output::Printer;
use crate::report::CommandLine;

pub(crate) fn run(verb: Verb, typed: &CommandLine, printer: Printer) -> Outcome {
    match verb {
        Verb::Demo(args) => demo::run(&args, printer),
        #[cfg(feature = "studio")]
        Verb::Studio(args) => crate::studio::run(&args, printer),
        Verb::Pattern(verb) => pattern::run(verb, printer),
        Verb::Advise(args) => advise::run(&args),
        Verb::Calibrate(mut args) => {
            let sequence = args.pattern.as_deref().and_then(sequence::sequence_in);
            // A folder under a sequence is one pose.
            if sequence.is_none() {
                args.photos = photographs(&args.photos)?;
            }
            args.plain = photographs(&args.plain)?;
            calibrate::run(&args, sequence.as_ref(), typed, printer)
        }
        Verb::Rectify(args) => rectify::run(&args, printer),
        Verb::Verify(args) => verify::run(&args, printer),
        Verb::Decode(args) => match sequence::sequence_in(&args.input.pattern) {
            Some(pattern) => sequence::decode(&args, &pattern, printer),
            None => decode::run(&args, printer),
        },
        Verb::Triangulate(args) => triangulate::run(&args, printer),
        Verb::Reconstruct(mut args) => {
            if let Some(pattern) = sequence::sequence_in(&args.input.pattern) {
                return scans::run(args, &pattern, typed, printer);
            }
            args.images = photographs(&args.images)?;
            reconstruct::run(&args, typed, printer)
        }
        Verb::Evaluate(args) => evaluate::run(&args, printer),
        Verb::Report(mut args) => {
            args.photo = photographs(&args.photo)?;
            report::run(&args, typed, printer)
        }
        Verb::BugReport(args) => bug_report::run(&args, printer),
        Verb::Completions(args) => shell::completions(&args),
        Verb::Man(args) => shell::man(&args, printer),
        Verb::Export(args) => exchange::export(&args, printer),
        Verb::Import(args) => exchange::import(&args, printer),
        Verb::Simulate(verb) => simulate::run(&verb, printer),
    }
}
