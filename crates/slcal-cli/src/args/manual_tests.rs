//! The tables of options in docs/cli.md are what the help says. The environment variable `SLCAL_UPDATE=1` lets the test
//! write them anew.

use std::path::Path;
use std::{env, fs};

use clap::builder::PossibleValue;
use clap::{Arg, Command};

use super::help::command;

/// Every verb with its path ("simulate noise"), without those that have verbs of their own.
pub(super) fn all_verbs() -> Vec<(String, Command)> {
    let mut all = Vec::new();
    collect(&command(), "", &mut all);
    all
}

fn collect(command: &Command, path: &str, all: &mut Vec<(String, Command)>) {
    for verb in command.get_subcommands() {
        let path = format!("{path} {}", verb.get_name());
        if verb.has_subcommands() {
            collect(verb, &path, all);
        } else {
            all.push((path.trim_start().to_owned(), verb.clone()));
        }
    }
}

/// The table of a command's arguments; global ones stand in that of `slcal` alone.
fn table(command: &Command, root: bool) -> String {
    let shown = |arg: &&Arg| !arg.is_hide_set() && (root || !is_general(arg));
    let rows = command.get_arguments().filter(shown).map(|arg| {
        let text = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
        let mut text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        // clap takes the full stop of a single sentence away.
        if !text.ends_with(['.', ']']) {
            text.push('.');
        }
        format!("| `{}` | {}{} |\n", escaped(&name(arg)), escaped(&text), escaped(&default(arg)))
    });
    std::iter::once("| option | |\n|---|---|\n".to_owned()).chain(rows).collect()
}

fn is_general(arg: &Arg) -> bool {
    arg.is_global_set() || ["help", "version"].contains(&arg.get_id().as_str())
}

/// As it is typed: `-o, --output RIG.json`, `--frame camera|plane`.
fn name(arg: &Arg) -> String {
    let takes = arg.get_action().takes_values();
    let choices = arg.get_possible_values();
    let value = if !takes {
        String::new()
    } else if choices.is_empty() {
        arg.get_value_names().unwrap_or_default().join(" ")
    } else {
        choices.iter().map(PossibleValue::get_name).collect::<Vec<_>>().join("|")
    };
    let short = arg.get_short().map(|s| format!("-{s}"));
    let options = short.into_iter().chain(arg.get_long().map(|l| format!("--{l}")));
    let options = options.collect::<Vec<_>>().join(", ");
    let many = arg.get_num_args().is_some_and(|n| n.max_values() > 1);
    format!("{options} {value}{}", if many { "..." } else { "" }).trim().to_owned()
}

fn default(arg: &Arg) -> String {
    let values: Vec<_> = arg.get_default_values().iter().map(|v| v.to_string_lossy()).collect();
    if values.is_empty() || !arg.get_action().takes_values() {
        return String::new();
    }
    format!(" Default: {}.", values.join(", "))
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;")
}

#[test]
fn the_tables_of_the_manual_are_those_of_the_help() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/cli.md");
    let page = fs::read_to_string(&file).unwrap();
    let mut expected = page.clone();
    let root = std::iter::once(("slcal".to_owned(), command()));
    for (path, verb) in
        root.chain(all_verbs().into_iter().map(|(path, verb)| (format!("slcal {path}"), verb)))
    {
        let (start, end) = (format!("<!-- options of {path} -->\n"), "<!-- end -->\n");
        let (before, rest) =
            expected.split_once(&start).unwrap_or_else(|| panic!("docs/cli.md: expected {start}"));
        let after = rest.split_once(end).unwrap_or_else(|| panic!("docs/cli.md: no end after {start}")).1;
        expected = format!("{before}{start}\n{}\n{end}{after}", table(&verb, path == "slcal"));
    }
    if env::var_os("SLCAL_UPDATE").is_some() {
        fs::write(&file, &expected).unwrap();
    }
    assert!(
        page == expected || env::var_os("SLCAL_UPDATE").is_some(),
        "the tables of docs/cli.md are not those of the help: run this test with SLCAL_UPDATE=1 to write them anew"
    );
}
