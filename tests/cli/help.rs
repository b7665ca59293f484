//! Help, completions, manual pages, and what is said about typing errors.

use std::fs;

use slcal_tests::{Bench, repository};

use crate::bench;

/// The commands among the examples of a help text, without their line breaks.
fn examples(help: &str) -> Vec<String> {
    let text = help.split("\nExample").nth(1).unwrap_or_default().replace("\\\n", " ");
    let lines = text.lines().map(str::trim);
    lines
        .filter(|l| l.starts_with("slcal "))
        .map(|l| l.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect()
}

/// The verbs that a help text lists.
fn verbs(help: &str) -> Vec<String> {
    let list =
        help.split("\nCommands:\n").nth(1).unwrap_or_default().split("\n\n").next().unwrap_or_default();
    let names = list.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    names.filter_map(|l| Some(l.split_whitespace().next()?.to_owned())).filter(|v| v != "help").collect()
}

/// A folder with the photographs of the demonstration.
fn with_photographs() -> Bench {
    let bench = bench();
    for name in ["sheet.jpg", "board.jpg", "head.jpg"] {
        bench.put(name, fs::read(repository().join("crates/slcal-cli/demo").join(name)).unwrap());
    }
    bench
}

#[test]
fn examples_run_one_after_the_other() {
    let bench = with_photographs();
    let mut run = Vec::new();
    let top = bench.run("--help").ok().text();
    for verb in verbs(&top) {
        let help = bench.run(&format!("{verb} --help")).ok().text();
        let mut helps = vec![help.clone()];
        helps.extend(verbs(&help).iter().map(|v| bench.run(&format!("{verb} {v} --help")).ok().text()));
        for line in helps.iter().flat_map(|h| examples(h)) {
            // Pipes, photographs that nobody has, and a server that serves until it is ended.
            let unfit = ["a.jpg", " photo.jpg", "slcal studio"].iter().any(|part| line.contains(part));
            if unfit || line.contains(['|', '>', '*']) {
                continue;
            }
            // Two verbs may show the same step.
            if run.contains(&line) {
                continue;
            }
            let done = bench.run(line.strip_prefix("slcal ").unwrap());
            assert_eq!(done.code, 0, "{line}: {}", done.stderr);
            run.push(line);
        }
    }
    assert!(run.len() > 20, "{run:#?}");
}

#[test]
fn completions_and_manual_pages_are_whole() {
    let bench = bench();
    for (shell, word) in [
        ("bash", "complete -F _slcal"),
        ("zsh", "#compdef slcal"),
        ("fish", "complete -c slcal"),
        ("powershell", "slcal"),
        ("elvish", "slcal"),
    ] {
        let script = bench.run(&format!("completions {shell}")).ok();
        assert!(script.stderr.is_empty() && script.text().contains(word), "{shell}");
        assert!(script.text().contains("save-observations"), "{shell}");
        bench.put(&format!("script.{shell}"), &script.stdout);
    }
    let checked = std::process::Command::new("bash").arg("-n").arg(bench.path("script.bash")).status();
    assert!(checked.is_ok_and(|s| s.success()));
    bench.run("completions csh").fails(2, &["bash"]);

    assert!(bench.run("man").ok().text().contains(".TH slcal 1"));
    let _ = bench.run("man --out pages").ok();
    let page = bench.text("pages/slcal-simulate-noise.1");
    assert!(page.contains(".SH EXAMPLES") && page.contains("Cramér") && !page.contains('\u{1b}'), "{page}");
    bench.run("man --out pages").fails(1, &["--force"]);
}

#[test]
fn a_file_that_is_not_there_is_answered_with_the_one_that_was_meant() {
    let bench = bench();
    let _ = bench.run("pattern stripes --projector 640x480 -o stripes.png").ok();
    bench.put("rig.json", "{}");
    bench
        .run("decode --pattern stripe.json a.png -o m.csv")
        .fails(3, &["stripe.json", "no such file; did you mean stripes.json?"]);
    bench.run("advise --rig nothing.json").fails(3, &["no such file; check the name"]);
    bench.run("advise --rig nowhere/rig.json").fails(3, &["no such folder"]);
}
