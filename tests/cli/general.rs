//! What holds for every verb.

use std::process::Stdio;

use slcal_tests::process;

use crate::bench;

#[test]
fn a_wrong_command_line_has_code_2() {
    for line in
        ["", "frobnicate", "pattern checker", "evaluate cube cloud.ply", "calibrate --size A4 -o rig.json"]
    {
        let run = bench().run(line);
        assert_eq!(run.code, 2, "{line}: {}", run.stderr);
    }
}

#[test]
fn version_goes_to_stdout() {
    assert!(bench().run("--version").ok().text().starts_with("slcal "));
}

#[test]
fn a_closed_stdout_is_no_panic() {
    // Drawing takes longer than closing the pipe.
    let mut child = bench()
        .command()
        .args(["pattern", "stripes", "--projector", "1024x768", "-o", "-"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = process::output(child);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(output.status.code(), Some(0), "{said}");
}
