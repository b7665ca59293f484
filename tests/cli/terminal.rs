//! What is printed, where there is no terminal: 80 columns, and no colours unless they are asked for.

use unicode_width::UnicodeWidthStr as _;

use crate::bench;
use slcal_tests::{Bench, Scene, repository};

const ESCAPE: char = '\u{1b}';

/// Two photographs of a sheet, one with a name that is wide in every way, and one of stripes.
fn with_photographs() -> Bench {
    let bench = bench();
    let demo = repository().join("crates/slcal-cli/demo");
    std::fs::copy(demo.join("sheet.jpg"), bench.path(WIDE)).unwrap();
    std::fs::copy(demo.join("board.jpg"), bench.path("board.jpg")).unwrap();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench
}

/// 60 columns, but neither 60 bytes nor 60 letters.
const WIDE: &str = "写真_写真_写真_a_photograph_with_a_name_that_is_really_long.jpg";

#[test]
fn results_fit_80_columns() {
    let bench = with_photographs();
    assert!(WIDE.width() <= 69 && WIDE.len() != WIDE.width());
    for line in [
        "demo --out demo",
        &format!("calibrate {WIDE} --size 594x420mm --pattern checker.json -o rig.json"),
        &format!(
            "calibrate {WIDE} demo/sheet.jpg --size 594x420mm --pattern checker.json -o two.json --distortion full"
        ),
        &format!("verify --rig rig.json --pattern checker.json --as-drawn {WIDE}"),
        "rectify --rig rig.json --pattern checker.json -o straight.png",
        "advise --rig rig.json",
        "advise --image 4000x3000 --fov 60 --size A2-landscape --projector 1920x1080 --throw 1.5",
        "decode --pattern stripes.json board.jpg -o matches.csv",
        "triangulate --rig rig.json matches.csv -o cloud.ply",
        "reconstruct --rig rig.json --pattern stripes.json board.jpg -o mesh.ply --mesh",
        "evaluate plane cloud.ply",
        "bug-report demo --dry-run",
        "simulate noise --levels 0.1,2 --draws 3 --tilt 30,0",
        "simulate noise --levels 5 --draws 3 --lens-shift 0.5 --principal-points prior",
        "simulate views --poses 12 -o views.json",
        "simulate scene --surface sphere --camera 320x240 --focal 400 --projector 256x192 --projector-focal 420 --out scene",
        "evaluate sphere scene/truth_cloud.ply",
    ] {
        let run = bench.run(line).ok();
        let text = run.text();
        assert!(!text.contains(ESCAPE) && !run.stderr.contains(ESCAPE), "{line}: {text}");
        let wide = text.lines().find(|l| l.width() > 80);
        assert_eq!(wide, None, "{line}");
        assert!(!text.contains('\u{1f}'), "{line}");
    }
}

#[test]
fn colours_come_when_they_are_asked_for_and_say_nothing_alone() {
    let bench = bench();
    let scene = Scene::default();
    scene.photograph(None).save(bench.path("a.png")).unwrap();
    let run = |options: &str, variables: &[(&str, &str)]| {
        let output = bench
            .command()
            .args(options.split_whitespace())
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR_FORCE")
            .envs(variables.iter().copied())
            .output()
            .unwrap();
        let said = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        (said(output.stdout), said(output.stderr))
    };
    let words = "calibrate a.png --size A2-landscape -o rig.json --force";
    let (plain, _) = run(words, &[]);
    for (options, variables) in [
        (format!("{words} --color always"), &[][..]),
        (words.to_owned(), &[("CLICOLOR_FORCE", "1")][..]),
        (format!("--color always {words}"), &[("NO_COLOR", "1")][..]),
    ] {
        let (text, _) = run(&options, variables);
        assert!(text.contains("\u{1b}[1mverdict"), "{options} {variables:?}: {text}");
        assert_eq!(anstream::adapter::strip_str(&text).to_string(), plain);
    }
    for (options, variables) in [
        (format!("{words} --color never"), &[("CLICOLOR_FORCE", "1")][..]),
        (words.to_owned(), &[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")][..]),
    ] {
        assert_eq!(run(&options, variables).0, plain, "{options} {variables:?}");
    }
    // Errors, of our own and of the command line, and help.
    for options in ["--color always advise --rig none.json", "--color=always frobnicate"] {
        assert!(run(options, &[]).1.contains(ESCAPE), "{options}");
    }
    assert!(run("decode --help --color always", &[]).0.contains(ESCAPE));
    assert!(!run("decode --help", &[("TERM", "xterm-256color")]).0.contains(ESCAPE));
}

#[test]
fn a_name_cannot_move_the_cursor() {
    let bench = bench();
    let name = "a\u{1b}[2Jb.json";
    let run = bench.run_args(&["--color", "always", "advise", "--rig", name], &[]);
    assert_eq!(run.code, 3);
    assert!(!run.stderr.contains("\u{1b}[2J"), "{}", run.stderr);
}
