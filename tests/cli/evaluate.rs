//! `slcal evaluate` and its picture.

use std::fmt::Write as _;

use crate::bench;

#[test]
fn a_picture_shows_the_points_and_changes_nothing_that_is_printed() {
    let bench = bench();
    let mut cloud = String::from(
        "ply\nformat ascii 1.0\ncomment units mm\nelement vertex 900\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
    );
    for i in 0..900 {
        let (x, y) = (10.0 * f64::from(i % 30), 10.0 * f64::from(i / 30));
        // Writing into a string cannot fail.
        let _ = writeln!(cloud, "{x} {y} {}", 800.0 + 0.1 * x + 0.02 * (x * y).sin());
    }
    bench.put("flat.ply", cloud);
    let without = bench.run("evaluate plane flat.ply --json").ok();
    let with = bench.run("evaluate plane flat.ply --json --overlay seen.png").ok();
    assert_eq!(with.text(), without.text());
    let seen = image::open(bench.path("seen.png")).unwrap();
    assert_eq!(seen.width().max(seen.height()), 1600);
    bench.run("evaluate plane flat.ply --overlay seen.png").fails(1, &["seen.png", "--force"]);
    bench.run("evaluate plane flat.ply --force --overlay flat.ply").fails(2, &["flat.ply", "input"]);
    bench.run("evaluate plane flat.ply --overlay -").fails(2, &["--overlay", "a file"]);
}
