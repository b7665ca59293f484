//! What kills, full disks and strangers' files leave behind: nothing.

use std::fs;
use std::io::Write as _;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;
use slcal_tests::{Bench, process, repository};

use crate::bench;

const SCAN: &str = "reconstruct --rig truth.json --pattern stripes.json";

/// A bench with the demonstration's photographs and its true rig.
fn with_demo() -> Bench {
    let bench = bench();
    for name in ["sheet.jpg", "board.jpg"] {
        bench.put(name, fs::read(repository().join("crates/slcal-cli/demo").join(name)).unwrap());
    }
    bench.put("truth.json", fs::read(repository().join("crates/slcal-cli/demo/truth_rig.json")).unwrap());
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench
}

fn started(bench: &Bench, line: &str) -> Child {
    let mut command = bench.command();
    command.args(line.split_whitespace()).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().unwrap()
}

#[cfg(unix)]
#[test]
fn what_killed_runs_leave_is_removed_by_the_next_one() {
    let bench = with_demo();
    let line = format!("{SCAN} board.jpg --mesh -o cloud.ply --overlay seen.png --report cloud.html --force");
    let _ = bench.run(&line).ok();
    let whole = bench.names();
    let cloud = fs::read(bench.path("cloud.ply")).unwrap();
    let begun = Instant::now();
    let _ = bench.run(&line).ok();
    let usual = begun.elapsed();
    let mut left = 0;
    for i in 0..12_u32 {
        let mut child = started(&bench, &line);
        // Most of the writing is at the end.
        thread::sleep(usual * (60 + 4 * i) / 100);
        let _ = child.kill();
        process::wait(&mut child);
        left += bench.names().iter().filter(|n| n.starts_with(".slcal-")).count();
        assert_eq!(
            fs::read(bench.path("cloud.ply")).unwrap(),
            cloud,
            "whole, from this run or the one before"
        );
    }
    // A remainder of each kind in any case: the machine may be too fast for the kills.
    bench.put(".slcal-aaaaaa.part", "half a cloud");
    let _ = bench.run(&line).ok();
    assert_eq!(bench.names(), whole, "{left} remainders");
}

#[cfg(unix)]
#[test]
fn a_run_that_still_works_keeps_its_own() {
    let bench = bench();
    let mine = fs::File::create(bench.path(".slcal-working.part")).unwrap();
    mine.lock().unwrap();
    let line = "pattern checker --projector 1024x768 -o checker.png --force";
    let _ = bench.run(line).ok();
    assert!(bench.names().contains(&".slcal-working.part".to_owned()));
    drop(mine);
    let _ = bench.run(line).ok();
    assert_eq!(bench.names(), ["checker.json", "checker.png"]);
}

// Elsewhere than on Linux, signals but SIGTERM are left alone where stderr is no terminal.
#[cfg(target_os = "linux")]
#[test]
fn signals_end_a_run_with_their_codes_and_what_is_ignored_stays_so() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let bench = with_demo();
        let mut child = started(&bench, &format!("{SCAN} --raw 1280x960:rgb24 --out-dir clouds"));
        wait_for_folder(&bench);
        process::signal(&child, signal);
        assert_eq!(process::wait(&mut child).code(), Some(code), "SIG{signal}");
        assert!(fs::read_dir(bench.path("clouds")).unwrap().next().is_none());
    }
    // As `nohup slcal ... &` in a script does.
    let bench = with_demo();
    let mut command = process::command("sh");
    let line = format!("trap '' INT HUP; exec \"$0\" {SCAN} --raw 1280x960:rgb24 --out-dir clouds");
    command.args(["-c", &line, env!("CARGO_BIN_EXE_slcal-under-test")]).current_dir(bench.path(""));
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for_folder(&bench);
    process::signal(&child, "INT");
    process::signal(&child, "HUP");
    thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "it ignores what it was told to ignore");
    process::signal(&child, "TERM");
    assert_eq!(process::wait(&mut child).code(), Some(143));
}

#[cfg(unix)]
#[test]
fn a_signal_between_two_photographs_of_a_sequence_leaves_nothing() {
    let bench = bench();
    let _ = bench.run("pattern gray --projector 1024x768 --axis both --no-frames --out-dir shown").ok();
    let mut child = started(&bench, "simulate scene --pattern shown/sequence.json --out clouds");
    wait_for_folder(&bench);
    let files = || fs::read_dir(bench.path("clouds")).unwrap().count();
    let begun = Instant::now();
    while files() < 3 {
        assert!(child.try_wait().unwrap().is_none() && begun.elapsed() < process::PATIENCE, "no photographs");
        thread::sleep(Duration::from_millis(2));
    }
    process::signal(&child, "TERM");
    assert_eq!(process::wait(&mut child).code(), Some(143));
    assert_eq!(files(), 0);
}

/// The run has begun, with its handlers.
fn wait_for_folder(bench: &Bench) {
    let begun = Instant::now();
    while !bench.path("clouds").is_dir() {
        assert!(begun.elapsed() < process::PATIENCE, "no folder");
        thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(unix)]
#[test]
fn on_a_full_disk_all_results_appear_or_none() {
    let bench = with_demo();
    let before = bench.names();
    // No file may be larger than this. A shell counts in blocks of 512 or of 1024 bytes.
    for blocks in [1, 16, 64, 256] {
        for trap in ["trap '' XFSZ; ", ""] {
            let line = format!(
                "{trap}ulimit -f {blocks}; exec \"$0\" calibrate sheet.jpg --size A2-landscape --pattern checker.json -o rig.json \
                 --overlay seen.png --report report.html --save-observations seen.json"
            );
            let mut command = process::command("sh");
            command.args(["-c", &line, env!("CARGO_BIN_EXE_slcal-under-test")]).current_dir(bench.path(""));
            let child =
                command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
            let run = process::output(child);
            assert!(!run.status.success(), "{blocks}");
            let names: Vec<String> =
                bench.names().into_iter().filter(|n| !n.starts_with(".slcal-")).collect();
            assert_eq!(names, before, "{blocks} {trap}");
        }
    }
    let line = "calibrate sheet.jpg --size A2-landscape --pattern checker.json -o rig.json";
    let _ = bench.run(line).ok();
    assert!(!bench.names().iter().any(|n| n.starts_with(".slcal-")), "{:?}", bench.names());
}

#[test]
fn json_that_nobody_reads_is_no_success() {
    let bench = with_demo();
    let line = "calibrate sheet.jpg --size A2-landscape --pattern checker.json --json";
    let mut command = bench.command();
    let mut child =
        command.args(line.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = process::output(child);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("stdout") && said.contains("JSON"), "{said}");
}

#[test]
fn a_stream_that_stalls_ends_when_its_time_is_up() {
    let bench = with_demo();
    let line = format!("{SCAN} --raw 1280x960:rgb24 --out-dir clouds --timeout 2");
    let mut command = bench.command();
    command.args(line.split(' ')).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let frame = image::open(bench.path("board.jpg")).unwrap().to_rgb8().into_raw();
    pipe.write_all(&frame).unwrap();
    pipe.write_all(&frame[..1000]).unwrap();
    let output = process::output(child);
    drop(pipe);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("frame 1") && said.contains("within 2 s"), "{said}");
    assert!(bench.path("clouds/frame_000000.ply").is_file());
    for (more, words) in [("--timeout 2 board.jpg", "--raw"), ("--raw 8x8:rgb24 --timeout -1", "seconds")] {
        bench.run(&format!("{SCAN} {more} --out-dir other")).fails(2, &[words]);
    }
}

#[test]
fn names_cannot_write_on_the_terminal() {
    let bench = bench();
    for name in ["a\u{202e}gpj.exe", "b\nslcal: all is well", "c\u{2066}\u{1b}[2Jd"] {
        let run = bench.run_args(&["advise", "--rig", name], &[]);
        assert_eq!(run.code, 3);
        assert!(
            !run.stderr.trim_end().contains(['\u{202e}', '\n', '\u{2066}', '\u{1b}']),
            "{:?}",
            run.stderr
        );
    }
}

#[test]
fn a_report_carries_no_photograph_from_elsewhere() {
    let bench = with_demo();
    let line = "calibrate sheet.jpg --size A2-landscape --pattern checker.json -o rig.json";
    let _ = bench.run(line).ok();
    fs::create_dir_all(bench.path("theirs/below")).unwrap();
    fs::copy(bench.path("sheet.jpg"), bench.path("theirs/below/mine.jpg")).unwrap();
    let mut rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
    let private = bench.path("sheet.jpg");
    let mut report = |name: &str, more: &str| {
        rig["views"][0]["photo"] = name.into();
        bench.put("theirs/rig.json", rig.to_string());
        let run = bench.run(&format!("report --rig theirs/rig.json -o report.html --force {more}")).ok();
        (run.stderr.clone(), bench.text("report.html").contains("data:image/jpeg"))
    };
    for name in [private.to_str().unwrap(), "../sheet.jpg", "below/../../sheet.jpg", "sheet.jpg"] {
        let (said, shown) = report(name, "");
        assert!(!shown && said.contains("--allow-paths"), "{name}: {said}");
        assert!(report(name, "--allow-paths").1, "{name}");
        assert!(report(name, "--photo sheet.jpg").1, "{name}");
    }
    for name in ["below/mine.jpg", "./below/mine.jpg"] {
        assert!(report(name, "").1, "{name}");
    }
    let (said, shown) = report("../nowhere.jpg", "");
    assert!(!shown && said.contains("not found"), "{said}");
    // A link in their folder leads out of it, too.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&private, bench.path("theirs/link.jpg")).unwrap();
        let (said, shown) = report("link.jpg", "");
        assert!(!shown && said.contains("--allow-paths"), "{said}");
    }
}
