//! `slcal calibrate` with a sequence: a folder of photographs per pose.

use serde_json::Value;

use crate::bench;

const DEVICES: &str = "--camera 400x300 --focal 470 --projector 256x192 --projector-focal 400";
const LINE: &str = "calibrate --size 594x420mm --pattern shown/sequence.json";

#[test]
fn folders_under_a_sequence_are_poses() {
    let bench = bench();
    let _ = bench.run("pattern gray --projector 256x192 --axis both --out-dir shown").ok();
    let scene = "simulate scene --surface sheet --pattern shown/sequence.json --ambient 0.1 --exposure 0.55";
    let _ = bench.run(&format!("{scene} {DEVICES} --out first")).ok();
    let _ = bench.run(&format!("{scene} --rig first/rig.json --tilt -25,-20 --out second")).ok();
    let run = bench
        .run(&format!(
            "{LINE} first second -o rig.json --overlay seen.png --save-observations seen.json --report r.html"
        ))
        .ok();
    assert!(run.words().contains("verdict"), "{}", run.text());
    let json = |name: &str| -> Value { serde_json::from_str(&bench.text(name)).unwrap() };
    let (rig, truth, seen) = (json("rig.json"), json("first/rig.json"), json("seen.json"));
    for (i, name) in ["first", "second"].iter().enumerate() {
        assert_eq!(rig["views"][i]["photo"], *name);
        assert_eq!(seen["views"][i]["photo"], *name);
        assert!(seen["views"][i]["pairs"].as_array().unwrap().len() > 100);
    }
    for device in ["camera", "projector"] {
        let [found, truth] = [&rig, &truth].map(|r| r[device]["K"][0][0].as_f64().unwrap());
        assert!((found / truth - 1.0).abs() < 0.01, "{device}: {found}, {truth}");
    }
    // Photographs of other names are taken in natural order; the measurements are the same.
    std::fs::create_dir(bench.path("renamed")).unwrap();
    let count = std::fs::read_dir(bench.path("shown")).unwrap().count() - 1;
    for i in 0..count {
        let from = bench.path("first").join(format!("frame_{i:03}.png"));
        std::fs::copy(from, bench.path("renamed").join(format!("IMG_{}.png", 9000 + 7 * i))).unwrap();
    }
    let _ = bench
        .run(&format!("{LINE} renamed -o renamed.json --save-observations other.json --allow-degenerate"))
        .ok();
    assert_eq!(json("other.json")["views"][0]["pairs"], seen["views"][0]["pairs"]);
    std::fs::remove_file(bench.path("renamed/IMG_9000.png")).unwrap();
    bench
        .run(&format!("{LINE} renamed -o no.json"))
        .fails(3, &["renamed", &count.to_string(), &(count - 1).to_string()]);
    bench.run(&format!("{LINE} first/frame_000.png -o no.json")).fails(3, &["folder", "one pose"]);
    bench.run(&format!("{LINE} absent -o no.json")).fails(3, &["absent", "folder"]);
    let _ = bench.run("pattern gray --projector 256x192 --no-frames --out-dir columns").ok();
    bench
        .run("calibrate --size 594x420mm --pattern columns/sequence.json first -o no.json")
        .fails(3, &["columns and rows", "found columns alone", "--axis both"]);
}
