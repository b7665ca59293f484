//! `slcal completions` and `slcal man`: completion scripts and manual pages.

use std::io::Write as _;

use clap::Command;
use clap_mangen::Man;

use crate::args::{CompletionsArgs, ManArgs, command};
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{Destination, make_folder, write_all};
use crate::output::{Printer, to_stdout};

/// The name under which the command is installed.
const NAME: &str = "slcal";

pub(super) fn completions(args: &CompletionsArgs) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), NAME, &mut script);
    to_stdout(|out| out.write_all(&script))
}

pub(super) fn man(args: &ManArgs, printer: Printer) -> Outcome {
    let mut root = command().disable_help_subcommand(true);
    root.build();
    let Some(folder) = &args.out else {
        let (_, page) = page(&root)?;
        return to_stdout(|out| out.write_all(&page));
    };
    make_folder(folder)?;
    let mut pages = Vec::new();
    all_pages(&root, &mut pages)?;
    let files = pages
        .into_iter()
        .map(|(name, page)| Ok((Destination::prepare(&folder.join(name), args.force)?, page)))
        .collect::<Outcome<Vec<_>>>()?;
    write_all(&files)?;
    for (place, _) in &files {
        printer.detail(format!("wrote {}", place.name()));
    }
    Ok(())
}

/// The pages of a verb and its subverbs.
fn all_pages(command: &Command, pages: &mut Vec<(String, Vec<u8>)>) -> Outcome {
    pages.push(page(command)?);
    command.get_subcommands().filter(|c| !c.is_hide_set()).try_for_each(|verb| all_pages(verb, pages))
}

/// File name and content of a page.
fn page(command: &Command) -> Outcome<(String, Vec<u8>)> {
    let page = Man::new(command.clone())
        .source(format!("{NAME} {}", env!("CARGO_PKG_VERSION")))
        .manual("slcal manual");
    let mut bytes = Vec::new();
    page.render(&mut bytes)
        .map_err(|e| Failure::new(Exit::Other, format!("cannot write the manual page: {e}")))?;
    let name = page.get_filename();
    // The conventional section of examples.
    let page = String::from_utf8_lossy(&bytes).replace(".SH EXTRA\nExample", ".SH EXAMPLES\nExample");
    Ok((name, page.replace(".SH EXTRA\n", ".SH NOTES\n").into_bytes()))
}
