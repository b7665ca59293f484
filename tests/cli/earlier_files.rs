//! Files and records of version 0.1 before its release, in `fixtures/0.1`: they are read, and none of their keys goes.

use std::fs;

use serde_json::Value;
use slcal_tests::{Bench, IDEAL, repository};

use crate::bench;

const FILES: [&str; 6] =
    ["rig.json", "observations.json", "checker.json", "stripes.json", "matches.csv", "cloud.ply"];

fn with_files() -> Bench {
    let bench = bench();
    for name in FILES {
        bench.put(name, fs::read(repository().join("fixtures/0.1").join(name)).unwrap());
    }
    for name in ["sheet.jpg", "board.jpg"] {
        bench.put(name, fs::read(repository().join("crates/slcal-cli/demo").join(name)).unwrap());
    }
    bench
}

/// Paths to the values of a record, such as `views[].rms_px.edges`.
fn paths(value: &Value, before: &str) -> Vec<String> {
    match value {
        Value::Object(fields) => {
            let dot = if before.is_empty() { "" } else { "." };
            fields.iter().flat_map(|(name, inner)| paths(inner, &format!("{before}{dot}{name}"))).collect()
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            items.iter().flat_map(|item| paths(item, &format!("{before}[]"))).collect()
        }
        _ => vec![before.to_owned()],
    }
}

#[test]
fn files_are_read_and_give_the_same_points() {
    let bench = with_files();
    let _ = bench.run("triangulate --rig rig.json matches.csv -o again.ply").ok();
    assert_eq!(fs::read(bench.path("again.ply")).unwrap(), fs::read(bench.path("cloud.ply")).unwrap());
    let _ = bench.run(&format!("calibrate --observations observations.json -o new.json {IDEAL}")).ok();
    let focal = |name: &str| -> [f64; 2] {
        let rig: Value = serde_json::from_str(&bench.text(name)).unwrap();
        ["camera", "projector"].map(|device| rig[device]["K"][0][0].as_f64().unwrap())
    };
    let (new, old) = (focal("new.json"), focal("rig.json"));
    assert!(new.iter().zip(old).all(|(a, b)| (a / b - 1.0).abs() < 1e-6), "{new:?} {old:?}");
    let _ = bench.run("report --rig rig.json -o report.html").ok();
}

#[test]
fn records_keep_their_keys() {
    let bench = with_files();
    let keys = fs::read_to_string(repository().join("fixtures/0.1/keys.json")).unwrap();
    let keys: Value = serde_json::from_str(&keys).unwrap();
    for (record, line) in [
        ("rig", "calibrate --observations observations.json --json"),
        ("decode", "decode --pattern stripes.json board.jpg -o m.csv --json"),
        ("reconstruct", "reconstruct --rig rig.json --pattern stripes.json board.jpg -o c.ply --json"),
        ("evaluate_plane", "evaluate plane c.ply --json"),
        ("verify", "verify --rig rig.json --pattern checker.json sheet.jpg --json"),
        ("advise", "advise --rig rig.json --json"),
    ] {
        let found = paths(&serde_json::from_str(&bench.run(line).ok().text()).unwrap(), "");
        for key in keys[record].as_array().unwrap() {
            assert!(found.iter().any(|f| f == key.as_str().unwrap()), "{record}: {key} is gone");
        }
    }
}
