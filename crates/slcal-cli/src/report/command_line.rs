//! Command lines as text.

use std::ffi::OsString;

/// The command line of this run.
#[derive(Debug, Clone, Default)]
pub(crate) struct CommandLine(Vec<String>);

impl CommandLine {
    /// Of the arguments as the program got them, its own name first.
    pub(crate) fn new(args: &[OsString]) -> Self {
        Self(args.iter().skip(1).map(|a| a.to_string_lossy().into_owned()).collect())
    }

    /// As it would be typed into a shell.
    pub(crate) fn typed(&self) -> String {
        let words = self.0.iter().map(|w| quoted(w));
        std::iter::once("slcal".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
    }
}

/// A word for a POSIX shell: unchanged where no character in it is special, else in single quotes.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("Übung/rig-1.json"), "Übung/rig-1.json");
        assert_eq!(quoted("it's here.jpg"), "'it'\\''s here.jpg'");
        assert_eq!([quoted(""), quoted("$(rm)"), quoted("a;b")], ["''", "'$(rm)'", "'a;b'"]);
        let args = ["/usr/bin/slcal", "report", "--rig", "my rig.json"].map(OsString::from);
        assert_eq!(CommandLine::new(&args).typed(), "slcal report --rig 'my rig.json'");
    }
}
