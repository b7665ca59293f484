//! The help common to all verbs, and hints after typing errors.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, ArgAction, Command, CommandFactory as _, ValueHint};

use super::cli::Cli;
use super::headings::GENERAL;
use crate::output::{HELP, MAX_WIDTH, display_width, unbroken, wrapped};

/// Width of "Usage: ".
const USAGE_INDENT: usize = 7;
/// Options that take a folder; other paths are files.
const FOLDERS: [&str; 2] = ["out", "out_dir"];

/// The command line with everything that the verbs share.
pub(crate) fn command() -> Command {
    let version = Arg::new("version")
        .short('V')
        .long("version")
        .action(ArgAction::Version)
        .help("Print the version")
        .help_heading(GENERAL);
    finished(Cli::command().disable_version_flag(true).arg(version))
}

/// Completes a verb and its subverbs.
fn finished(command: Command) -> Command {
    let help = Arg::new("help")
        .short('h')
        .long("help")
        .action(ArgAction::Help)
        .help("Print help: -h a summary, --help everything, with examples")
        .help_heading(GENERAL)
        .display_order(1003);
    let command = command.disable_help_flag(true).arg(help).styles(HELP).max_term_width(80);
    let command = narrow(command.mut_args(hinting));
    let path = command.get_bin_name().unwrap_or(command.get_name()).to_owned();
    let command = command.mut_subcommands(|verb| {
        let path = format!("{path} {}", verb.get_name());
        finished(verb.bin_name(path))
    });
    let Some(text) = command.get_after_help().map(ToString::to_string) else { return command };
    command.after_help("See --help for details and examples.").after_long_help(painted(&text))
}

/// Breaks a usage that is wider than [`MAX_WIDTH`], which clap does not do.
fn narrow(command: Command) -> Command {
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage:").trim();
    if usage.contains('\n') || display_width(usage) + USAGE_INDENT <= MAX_WIDTH {
        return command;
    }
    command.override_usage(wrapped(&options_whole(usage), MAX_WIDTH, USAGE_INDENT))
}

/// Keeps an option and its value on one line.
fn options_whole(usage: &str) -> String {
    let mut out = String::new();
    let mut previous = "";
    for word in usage.split(' ') {
        if !out.is_empty() {
            let value = word.starts_with('<') && previous.starts_with("--");
            out.push_str(&if value { unbroken(" ") } else { " ".to_owned() });
        }
        out.push_str(word);
        previous = word;
    }
    out
}

/// Tells shells which paths are folders.
fn hinting(arg: Arg) -> Arg {
    let hint = match arg.get_value_hint() {
        ValueHint::AnyPath if FOLDERS.contains(&arg.get_id().as_str()) => ValueHint::DirPath,
        ValueHint::AnyPath => ValueHint::FilePath,
        other => other,
    };
    arg.value_hint(hint)
}

/// Colours the headings and commands of an example text like the other help.
fn painted(text: &str) -> StyledStr {
    let (header, literal) = (HELP.get_header(), HELP.get_literal());
    let lines = text.lines().map(|line| match line.trim_start() {
        _ if line.starts_with("Example") => format!("{header}{line}{header:#}"),
        command if command.starts_with("slcal ") => {
            format!("{}{literal}{command}{literal:#}", &line[..line.len() - command.len()])
        }
        _ => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n").into()
}

/// Adds a hint to the message on a wrong command line.
pub(crate) fn hinted(mut error: Error) -> Error {
    let word = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => word.clone(),
        Some(ContextValue::Strings(words)) => words.join(" "),
        _ => String::new(),
    };
    let hint = match error.kind() {
        ErrorKind::InvalidSubcommand => nested(&word(ContextKind::InvalidSubcommand)),
        ErrorKind::MissingRequiredArgument => missing(&word(ContextKind::InvalidArg)),
        _ => None,
    };
    if let Some(hint) = hint {
        let mut all = match error.remove(ContextKind::Suggested) {
            Some(ContextValue::StyledStrs(others)) => others,
            _ => Vec::new(),
        };
        all.push(hint.into());
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(all));
    }
    error
}

/// The hint for a subverb without its verb, such as `checker`.
fn nested(word: &str) -> Option<String> {
    let literal = HELP.get_literal();
    let parent = match word {
        "plane" | "sphere" => Some("evaluate".to_owned()),
        _ => Cli::command()
            .get_subcommands()
            .find(|verb| verb.get_subcommands().any(|c| c.get_name() == word))
            .map(|verb| verb.get_name().to_owned()),
    }?;
    Some(format!("'{word}' is a kind of '{parent}': {literal}slcal {parent} {word}{literal:#}"))
}

/// The hint for a missing argument.
fn missing(words: &str) -> Option<String> {
    let hint = if words.contains("--size") {
        "the size of the sheet sets the scale: --size A4-landscape, or --size 594x420mm"
    } else if words.contains("--projector ") {
        "the native resolution of the projector, for example --projector 1920x1080"
    } else if words.contains("--pattern") {
        "the pattern is the JSON that `slcal pattern` writes beside the picture"
    } else if words.contains("--rig") {
        "the rig is the file that `slcal calibrate ... -o rig.json` writes"
    } else {
        return None;
    };
    Some(hint.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::headings::OUTPUT;
    use crate::args::manual_tests::all_verbs;

    #[test]
    fn help_fits_a_terminal() {
        for (path, verb) in all_verbs().iter_mut().chain([&mut ("slcal".to_owned(), command())]) {
            for help in [verb.render_help(), verb.render_long_help()] {
                let help = help.to_string();
                let wide = help.lines().find(|line| display_width(line) > MAX_WIDTH);
                assert_eq!(wide, None, "{path}");
            }
        }
    }

    #[test]
    fn options_stand_under_headings_and_verbs_end_with_examples() {
        for (path, verb) in all_verbs() {
            for arg in verb.get_arguments().filter(|a| !a.is_positional()) {
                let id = arg.get_id();
                assert!(arg.get_help_heading().is_some(), "{path} --{id} has no heading");
                assert!(arg.get_help().is_some(), "{path} --{id} has no help");
                if ["output", "json", "force"].contains(&id.as_str()) {
                    assert_eq!(arg.get_help_heading(), Some(OUTPUT), "{path} --{id}");
                }
            }
            let text = verb.get_after_long_help().map(ToString::to_string).unwrap_or_default();
            assert!(text.starts_with("Example"), "{path}: expected examples, found {text}");
            assert!(text.contains(&format!("slcal {path}")), "{path}: no example of its own in {text}");
        }
    }

    #[test]
    fn examples_are_right() {
        for (path, verb) in all_verbs() {
            let text = verb.get_after_long_help().map(ToString::to_string).unwrap_or_default();
            for line in
                text.replace("\\\n", " ").lines().filter_map(|l| Some(l.split_at(l.find("slcal ")?).1))
            {
                // Sentences have verbs in backquotes.
                if text.contains(&format!("`{}", line.split('`').next().unwrap_or_default())) {
                    continue;
                }
                let words = line.split(['|', '>']).next().unwrap_or_default().split_whitespace();
                let parsed = command().try_get_matches_from(words);
                assert!(parsed.is_ok(), "{path}: {line}: {}", parsed.unwrap_err());
            }
        }
    }

    #[test]
    fn typing_errors_are_answered() {
        for (line, words) in [
            ("slcal checker", "slcal pattern checker"),
            ("slcal sphere", "slcal evaluate sphere"),
            ("slcal calibrte", "'calibrate'"),
            ("slcal calibrate a.jpg", "--size A4-landscape"),
            ("slcal calibrate a.jpg --size A44 -o r.json", "did you mean A4?"),
            ("slcal calibrate a.jpg --size 300x200 -o r.json", "did you mean 300x200mm?"),
            ("slcal calibrate a.jpg --size A4 --camera-pp centr -o r.json", "did you mean centre?"),
            ("slcal calibrate a.jpg --size A4 --methd ml -o r.json", "'--method'"),
            ("slcal calibrate a.jpg --size A4 --method m -o r.json", "two-vp"),
            ("slcal reconstruct --rig r --pattern p a.jpg --out-dir d --format plyy", "'ply'"),
            ("slcal decode a.jpg -o m.csv", "slcal pattern"),
        ] {
            let error = hinted(command().try_get_matches_from(line.split(' ')).unwrap_err());
            assert!(error.to_string().contains(words), "{line}: {error}");
            assert_eq!(error.exit_code(), 2);
        }
    }
}
