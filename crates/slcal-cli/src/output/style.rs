//! Colours. Texts always carry their style. Printing strips it, for stdout and stderr separately, where the stream is no terminal or
//! where `--color`, `NO_COLOR`, `CLICOLOR`, `CLICOLOR_FORCE` or `TERM` ask for that. Colour never carries information by itself.

use std::ffi::OsString;

use anstream::ColorChoice;
use anstyle::{AnsiColor, Effects, Style};
use clap::ValueEnum;
use clap::builder::Styles;

/// A good result.
pub(crate) const GOOD: Style = AnsiColor::Green.on_default().effects(Effects::BOLD);
/// A warning. Bold, as yellow alone is hard to read on white.
pub(crate) const FAIR: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);
/// An error or a bad result.
pub(crate) const BAD: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
/// Labels and headings.
pub(crate) const BOLD: Style = Style::new().effects(Effects::BOLD);
/// Secondary text.
pub(crate) const DIM: Style = Style::new().effects(Effects::DIMMED);

/// Styles of `--help` and of command line errors.
pub(crate) const HELP: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().effects(Effects::BOLD))
    .usage(AnsiColor::Green.on_default().effects(Effects::BOLD))
    .literal(AnsiColor::Cyan.on_default().effects(Effects::BOLD))
    .placeholder(AnsiColor::Cyan.on_default())
    .error(BAD)
    .valid(GOOD)
    .invalid(FAIR);

/// When to use colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorArg {
    /// On a terminal, unless the environment says otherwise.
    Auto,
    /// Everywhere, into files and pipes as well.
    Always,
    /// Nowhere.
    Never,
}

impl ColorArg {
    /// The value on a command line that may be invalid otherwise.
    pub(crate) fn of(args: &[OsString]) -> Self {
        let words = args.iter().map(|a| a.to_str().unwrap_or_default()).take_while(|a| *a != "--");
        let words: Vec<&str> = words.collect();
        let value = words.iter().enumerate().rev().find_map(|(i, word)| match *word {
            "--color" | "--colour" => words.get(i + 1).copied(),
            word => word.strip_prefix("--color=").or_else(|| word.strip_prefix("--colour=")),
        });
        value.and_then(|v| Self::from_str(v, false).ok()).unwrap_or(Self::Auto)
    }

    /// The choice for clap's own messages.
    pub(crate) fn for_clap(self) -> clap::ColorChoice {
        match self {
            Self::Auto => clap::ColorChoice::Auto,
            Self::Always => clap::ColorChoice::Always,
            Self::Never => clap::ColorChoice::Never,
        }
    }
}

/// Sets the choice for everything that is printed afterwards.
pub(crate) fn set_color(color: ColorArg) {
    match color {
        ColorArg::Auto => ColorChoice::Auto,
        ColorArg::Always => ColorChoice::AlwaysAnsi,
        ColorArg::Never => ColorChoice::Never,
    }
    .write_global();
}

/// A text in a style.
pub(crate) fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_is_found_on_any_command_line() {
        let of = |line: &str| ColorArg::of(&line.split(' ').map(OsString::from).collect::<Vec<_>>());
        assert_eq!(of("slcal calibrate"), ColorArg::Auto);
        assert_eq!(of("slcal --color never nonsense"), ColorArg::Never);
        assert_eq!(of("slcal --color=never x --colour always"), ColorArg::Always);
        assert_eq!(of("slcal x --color"), ColorArg::Auto);
        assert_eq!(of("slcal x -- --color always"), ColorArg::Auto);
    }
}
