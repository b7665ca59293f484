//! The studio's server: who is let in, what is kept, how it ends.

use std::fs;

use slcal_tests::studio::{Studio, files};
use slcal_tests::{Bench, process};

use crate::bench;

const FILES: [&str; 4] = ["--projector", "1024x768", "--size", "594x420mm"];
const SHEET: &[u8] = include_bytes!("../../crates/slcal-cli/demo/sheet.jpg");
const REVERSED: &[u8] = include_bytes!("../../fixtures/sheet_reversed.jpg");

/// A studio that waits for photographs of the sheet: its settings as an earlier run left them.
fn calibrating(bench: &Bench) -> Studio {
    fs::create_dir(bench.path("work")).unwrap();
    bench.put(
        "work/studio.json",
        r#"{"schema":"slcal-studio-settings/1","projector":[1024,768],"size":"594x420mm","pattern_scale":1.0,"camera":"files","step":"calibrate"}"#,
    );
    Studio::start(bench, "work", &[])
}

#[test]
fn nothing_is_told_without_a_session() {
    let bench = bench();
    let studio = Studio::start(&bench, "work", &FILES);
    let host = format!("Host: {}", studio.host());
    let origin = format!("Origin: http://{}", studio.host());
    for path in [
        "/api/state",
        "/api/state?as=operator",
        "/api/shown.png",
        "/api/live.jpg",
        "/api/photographs/1.jpg",
        "/api/clouds/1",
        "/report",
    ] {
        let answer = studio.ask(&format!("GET {path}"), &[&host], b"");
        assert_eq!((answer.status, answer.refusal().as_str()), (403, "session-missing"), "{path}");
    }
    for token in ["", "0123456789abcdef0123456789abcdef"] {
        let sent = serde_json::json!({ "token": token }).to_string();
        let answer = studio.ask("POST /api/session", &[&host, &origin], sent.as_bytes());
        assert_eq!((answer.status, answer.refusal().as_str()), (403, "token-wrong"));
        assert!(answer.header("set-cookie").is_none());
    }
    // Pages are no secret, and may do nothing but talk to this server.
    let page = studio.ask("GET /", &[&host], b"");
    assert_eq!(page.status, 200);
    assert!(page.header("content-security-policy").unwrap().contains("default-src 'none'"));
    assert_eq!(page.header("referrer-policy"), Some("no-referrer"));
}

#[test]
fn other_hosts_and_other_pages_are_refused() {
    let bench = bench();
    let studio = Studio::start(&bench, "work", &FILES);
    let token = serde_json::json!({ "token": studio.token("operator") }).to_string();
    let ask = |headers: &[&str]| studio.ask("POST /api/session", headers, token.as_bytes());
    let host = format!("Host: {}", studio.host());
    assert_eq!(ask(&[&host, &format!("Origin: http://{}", studio.host())]).status, 200);
    assert_eq!(ask(&[&host]).refusal(), "origin-foreign");
    assert_eq!(ask(&[&host, "Origin: http://evil.example"]).refusal(), "origin-foreign");
    assert_eq!(ask(&[&host, "Origin: null"]).refusal(), "origin-foreign");
    assert_eq!(ask(&["Host: evil.example", "Origin: http://evil.example"]).refusal(), "host-unknown");
    let upgrade = [
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    ];
    for (origin, code) in [("Origin: http://evil.example", 403), ("X-None: 1", 403)] {
        let headers: Vec<&str> = upgrade.into_iter().chain([host.as_str(), origin]).collect();
        assert_eq!(studio.ask("GET /ws?as=operator", &headers, b"").status, code);
    }
    // A page of the studio without a session.
    let own = format!("Origin: http://{}", studio.host());
    let headers: Vec<&str> = upgrade.into_iter().chain([host.as_str(), &own]).collect();
    assert_eq!(studio.ask("GET /ws?as=operator", &headers, b"").status, 403);
}

#[test]
fn roles_do_what_they_are_for_and_no_more() {
    let bench = bench();
    let studio = calibrating(&bench);
    let picture = |role: &str| studio.ask_as(role, &format!("POST /api/photographs?as={role}"), SHEET);
    assert_eq!(picture("watcher").refusal(), "role-other");
    assert_eq!(picture("display").refusal(), "role-other");
    let state = |role: &str| studio.ask_as(role, &format!("GET /api/state?as={role}"), b"").json();
    let operator = state("operator");
    assert!(operator["links"]["display"].as_str().unwrap().contains('#') && operator["dir"].is_string());
    let watcher = state("watcher");
    assert!(watcher["links"].is_null() && watcher["dir"].is_null() && watcher["sentence"].is_string());
    // A page that looks on while another one operates.
    for path in ["photographs", "picture"] {
        let asked = studio.ask_as("operator", &format!("POST /api/{path}?as=operator&page=999"), SHEET);
        assert_eq!(asked.refusal(), "not-operating", "{path}");
    }
    // The session of one role under the name of another.
    assert_eq!(studio.ask_as("watcher", "GET /api/state?as=operator", b"").refusal(), "session-missing");
    // Nothing changes by GET.
    for path in ["/api/session", "/api/photographs", "/api/painted", "/api/picture"] {
        assert!(
            [404, 405].contains(&studio.ask_as("operator", &format!("GET {path}"), b"").status),
            "{path}"
        );
    }
}

#[test]
fn photographs_are_kept_as_they_come_and_calibrate() {
    let bench = bench();
    let studio = calibrating(&bench);
    let send = |name: &str, bytes: &[u8]| {
        studio.ask_as("operator", &format!("POST /api/photographs?as=operator&name={name}"), bytes)
    };
    assert_eq!(send("notes.txt", b"not a picture").status, 415);
    let cut = send("cut.jpg", &SHEET[..SHEET.len() / 2]);
    assert!(cut.status == 422 && cut.json()["error"]["message"].as_str().unwrap().contains("cut.jpg"));
    assert_eq!(send("..%2F..%2Fescape.jpg", SHEET).json()["id"], 1);
    let first = studio.state_when(|s| !s["calibration"].is_null() && s["busy"].is_null());
    assert_eq!(first["calibration"]["photographs"], 1);
    assert_eq!(send("b.jpg", REVERSED).json()["id"], 2);
    let second = studio.state_when(|s| s["calibration"]["photographs"] == 2 && s["busy"].is_null());
    assert_eq!(second["calibration"]["verdict"], "good");
    let focal = &second["calibration"]["figures"][0];
    assert!(focal["sigma"].as_f64() < focal["before"]["sigma"].as_f64());
    // The truth of the demonstration's rig.
    assert!((focal["value"].as_f64().unwrap() - 1536.0).abs() < 4.0 * focal["sigma"].as_f64().unwrap());
    assert_eq!(fs::read(bench.path("work/sheet-001.jpg")).unwrap(), SHEET);
    let kept = files(&bench.path("work"));
    for name in [
        "checker.json",
        "checker.png",
        "commands.txt",
        "observations.json",
        "rig.json",
        "sheet-002.jpg",
        "stripes.png",
    ] {
        assert!(kept.iter().any(|k| k == name), "{name}: {kept:?}");
    }
    assert!(!bench.path("escape.jpg").exists() && kept.iter().all(|k| !k.contains("escape")));
    // Others see it encoded anew.
    let shown = studio.ask_as("watcher", "GET /api/photographs/1.jpg?as=watcher", b"");
    assert!(shown.status == 200 && image::load_from_memory(&shown.body).unwrap().width() == 1280);
    for path in [
        "/api/photographs/9.jpg",
        "/api/photographs/..%2Fstudio.json",
        "/api/photographs/-1.jpg",
        "/api/clouds/1",
    ] {
        assert_eq!(studio.ask_as("operator", &format!("GET {path}?as=operator"), b"").status, 404, "{path}");
    }
    let report = studio.ask_as("operator", "GET /report?as=operator", b"");
    assert!(report.status == 200 && report.header("content-security-policy").unwrap().starts_with("sandbox"));
}

#[test]
fn uploads_above_the_limit_are_refused_before_they_are_read() {
    let bench = bench();
    let studio = calibrating(&bench);
    let large = vec![0xFF; 55 << 20];
    let answer = studio.ask_as("camera", "POST /api/photographs?as=camera", &large[..1 << 20]);
    // Without --lan there is no address for a phone.
    assert_eq!(answer.status, 403);
    let answer = studio.ask_as("operator", "POST /api/photographs?as=operator", &large);
    assert_eq!((answer.status, answer.refusal().as_str()), (413, "too-large"));
    assert!(!files(&bench.path("work")).iter().any(|f| f.starts_with("sheet-")));
}

#[test]
fn a_killed_studio_goes_on_where_it_was() {
    let bench = bench();
    let mut studio = calibrating(&bench);
    let photo = studio.ask_as("operator", "POST /api/photographs?as=operator", SHEET);
    assert_eq!(photo.status, 200);
    // In the middle of the work.
    studio.kill();
    let again = Studio::start(&bench, "work", &[]);
    let state = again.state_when(|s| !s["calibration"].is_null());
    assert_eq!((&state["step"], &state["calibration"]["photographs"]), (&"calibrate".into(), &1.into()));
    assert_eq!(state["photographs"][0]["name"], "sheet-001.jpg");
    // The folder belongs to one studio at a time.
    let refused = Studio::command(&bench, "work", &[]).stdout(std::process::Stdio::null()).status().unwrap();
    assert_eq!(refused.code(), Some(1));
    drop(again);
    // Photographs belong to the rig and the pattern under which they were taken.
    for other in
        [&["--projector", "1920x1080"][..], &["--demo"], &["--watch", bench.path("work").to_str().unwrap()]]
    {
        let refused =
            Studio::command(&bench, "work", other).stdout(std::process::Stdio::null()).status().unwrap();
        assert_eq!(refused.code(), Some(2), "{other:?}");
    }
    let again = Studio::start(&bench, "work", &[]);
    let port = again.host().rsplit(':').next().unwrap().to_owned();
    let taken =
        Studio::command(&bench, "other", &["--port", &port]).stdout(std::process::Stdio::null()).status();
    assert_eq!(taken.unwrap().code(), Some(1));
}

// Elsewhere than on Linux, signals but SIGTERM are left alone where stderr is no terminal.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_is_its_usual_end() {
    let bench = bench();
    let mut studio = Studio::start(&bench, "work", &FILES);
    process::signal(studio.child(), "INT");
    assert_eq!(studio.code(), Some(0));
}

#[cfg(unix)]
#[test]
fn a_watched_folder_gives_complete_photographs_alone() {
    let bench = bench();
    fs::create_dir(bench.path("camera")).unwrap();
    bench.put("camera/old.jpg", SHEET);
    fs::create_dir(bench.path("work")).unwrap();
    bench.put(
        "work/studio.json",
        r#"{"schema":"slcal-studio-settings/1","projector":[1024,768],"size":"594x420mm","camera":null,"step":"calibrate"}"#,
    );
    let watch = bench.path("camera");
    let studio = Studio::start(&bench, "work", &["--watch", watch.to_str().unwrap()]);
    assert_eq!(studio.state_when(|s| s["set_up"]["done"] == true)["camera"]["kind"], "folder");
    let half = SHEET.len() / 2;
    bench.put("camera/new.jpg", &SHEET[..half]);
    bench.put("elsewhere.jpg", REVERSED);
    std::os::unix::fs::symlink(bench.path("elsewhere.jpg"), bench.path("camera/link.jpg")).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(600));
    bench.put("camera/new.jpg", SHEET);
    let state = studio.state_when(|s| !s["calibration"].is_null());
    assert_eq!(state["photographs"].as_array().unwrap().len(), 1);
    assert_eq!(fs::read(bench.path("work/sheet-001.jpg")).unwrap(), SHEET);
}
