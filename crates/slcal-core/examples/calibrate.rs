//! Photographs of a sheet under a projected checkerboard → rig.json.
//!
//! ```sh
//! slcal demo --out demo
//! cargo run --release -p slcal-core --example calibrate -- 594x420mm demo/checker.json rig.json demo/sheet.jpg
//! ```
//!
//! One photograph per pose of the sheet; two with opposite tilts are far better than one.

use std::error::Error;
use std::fs;
use std::process::ExitCode;

use slcal_core::format::{read_pattern, write_rig};
use slcal_core::{Calibrator, Pattern, PhotoView, Rig, SheetPhoto};

fn run(size: &str, pattern: &str, output: &str, photographs: &[String]) -> Result<(), Box<dyn Error>> {
    let Pattern::Checker(checker) = read_pattern(&fs::read(pattern)?[..])? else {
        return Err("expected a checkerboard pattern".into());
    };
    let mut calibrator = Calibrator::new(size.parse()?).with_pattern(&checker);
    for path in photographs {
        // Memory holds one photograph at a time.
        let photo = image::open(path)?;
        let found = calibrator.add(SheetPhoto::new(PhotoView::try_from(&photo)?).name(path))?;
        println!("{path}: {} corners of the pattern", found.pattern_corners);
    }
    let rig = calibrator.calibrate()?.rig;
    print(&rig);
    let mut bytes = Vec::new();
    write_rig(&rig, &mut bytes)?;
    Ok(fs::write(output, bytes)?)
}

fn print(rig: &Rig) {
    for (name, device) in rig.devices() {
        let sigma = device.sigma.map_or(f64::NAN, |s| s.focal_px);
        println!("{name}: focal length {:.1} ± {sigma:.1} px (1σ)", device.model.intrinsics.fx);
    }
    if let Some(quality) = &rig.quality {
        println!("{}: {}\n{}", quality.verdict.name(), quality.cause, quality.advice);
        for warning in &quality.warnings {
            println!("warning: {}; {}", warning.message, warning.advice);
        }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [size, pattern, output, photographs @ ..] = arguments.as_slice() else {
        eprintln!("usage: calibrate SIZE CHECKER.json RIG.json PHOTO...");
        return ExitCode::from(2);
    };
    match run(size, pattern, output, photographs) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("calibrate: {error}");
            ExitCode::FAILURE
        }
    }
}
