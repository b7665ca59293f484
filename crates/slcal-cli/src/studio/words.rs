//! The state in one sentence, the next thing to do in one sentence, and the command that does the same.

use super::checker::checker;
use super::scan_folder::DESCRIPTION;
use super::state::{CameraKind, Picture, ScanMethod, Shots, State, Step};
use crate::report::{quoted, sentence};

/// What the head of the page says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Words {
    pub(super) sentence: String,
    pub(super) next: String,
    pub(super) command: Option<String>,
}

pub(super) fn words(state: &State) -> Words {
    let (sentence, next) = match state.step {
        Step::SetUp => set_up(state),
        Step::Calibrate => calibrate(state),
        Step::Scan => scan(state),
        Step::Use => in_use(state),
    };
    Words { sentence, next, command: command(state) }
}

fn set_up(state: &State) -> (String, String) {
    let calibrated = state.calibration.is_some();
    match (state.set_up.missing, &state.display.problem) {
        (Some(missing), _) => ("Nothing is calibrated yet.".into(), missing.into()),
        (None, Some(problem)) => (sentence(&problem.message), sentence(&problem.advice)),
        (None, None) if calibrated => (
            format!("Calibrated from {}.", photographs(state.used().len())),
            "Go on where you were, or change what has changed.".into(),
        ),
        (None, None) => {
            ("Projector, sheet and camera are set.".into(), "Calibrate: photograph the sheet twice.".into())
        }
    }
}

fn calibrate(state: &State) -> (String, String) {
    if let Some(problem) = state.display.problem.as_ref().or(state.camera.problem.as_ref()) {
        return (sentence(&problem.message), sentence(&problem.advice));
    }
    let used = state.used().len();
    let said = match (&state.calibration, used) {
        (Some(c), n) => format!("The calibration from {} is {}.", photographs(n), c.verdict),
        (None, 0) => "No photograph of the sheet yet.".into(),
        (None, n) => format!("The sheet was found in {}.", photographs(n)),
    };
    let next = match &state.guide {
        Some(guide) if guide.needed => format!("{} {}", guide.words, how_to_take(state)),
        _ if state.calibration.is_some() => "Scan an object, or project a picture.".into(),
        _ => format!("Hold the sheet into the projected checkerboard, tilted. {}", how_to_take(state)),
    };
    (said, next)
}

fn how_to_take(state: &State) -> &'static str {
    match state.camera.kind {
        Some(CameraKind::Demo | CameraKind::Webcam) if state.auto_shot => {
            "The photograph is taken when it is still, or by the space key."
        }
        Some(CameraKind::Demo | CameraKind::Webcam) => "Press space to take the photograph.",
        Some(CameraKind::Phone) => "Take the photograph with the phone.",
        Some(CameraKind::Folder) => "Take the photograph with the camera.",
        Some(CameraKind::Files) => "Drop the photograph here.",
        None => "Choose a camera first.",
    }
}

fn scan(state: &State) -> (String, String) {
    if let Some(problem) = state.display.problem.as_ref().or(state.camera.problem.as_ref()) {
        return (sentence(&problem.message), sentence(&problem.advice));
    }
    if let Some(shots) = &state.scan.shots {
        return sequence(state, shots);
    }
    if state.scan.continuous {
        let points = state.scan.live.as_ref().map_or(0, |l| l.points);
        return (
            format!("Scanning: {} points, {:.1} clouds a second.", grouped(points), state.scan.fps),
            "Stop to keep the last cloud.".into(),
        );
    }
    match state.scan.clouds.last() {
        Some(cloud) => (
            format!("{} has {} points.", cloud.name, grouped(cloud.points)),
            "Turn the cloud, save it, or scan again.".into(),
        ),
        None if state.scan.method == ScanMethod::Stripes => {
            ("No cloud yet.".into(), "Put an object where the stripes fall, and scan.".into())
        }
        None => (
            "No cloud yet.".into(),
            "Put an object that does not move into the light, expose so that nothing of it is saturated, and scan.".into(),
        ),
    }
}

/// While a sequence is photographed.
fn sequence(state: &State, shots: &Shots) -> (String, String) {
    let Shots { frame, of, light, .. } = shots;
    if *frame == 0 {
        return (
            "Measuring how long the camera takes to show what the projector shows.".into(),
            "Wait: the display turns from black to white.".into(),
        );
    }
    let next = match (shots.by_hand, shots.shown) {
        (true, true) => format!("{} Nothing may move.", how_to_take(state)),
        (true, false) => "Wait until the display shows it.".into(),
        (false, _) => "Nothing may move until the last photograph.".into(),
    };
    (format!("Picture {frame} of {of}: {light}."), next)
}

fn in_use(state: &State) -> (String, String) {
    if let Some(problem) = &state.display.problem {
        return (sentence(&problem.message), sentence(&problem.advice));
    }
    let shown = state.display.connected && state.display.wanted.kind == Picture::Rectified;
    match &state.in_use.picture {
        Some(_) if shown && state.in_use.straight == Some(false) => (
            "The sheet has moved since its last photograph, for which the picture was drawn.".into(),
            "Photograph it again in the step Calibrate.".into(),
        ),
        Some(name) if shown => (
            format!("{name} is projected without keystone onto the sheet of the last photograph."),
            "Choose another picture, or export the rig.".into(),
        ),
        Some(name) => (
            format!("{name} is drawn for the sheet of the last photograph."),
            "Show it, choose another picture, or export the rig.".into(),
        ),
        None => ("The rig is calibrated.".into(), "Choose a picture to project, or export the rig.".into()),
    }
}

/// The command that does the same in the project's folder.
pub(super) fn command(state: &State) -> Option<String> {
    let [w, h] = state.set_up.projector?;
    let size = quoted(state.set_up.size.as_deref()?);
    match state.step {
        Step::SetUp => {
            let scale = state.set_up.pattern_scale;
            let checker = checker([w, h], scale).ok().filter(|_| scale != 1.0);
            let square = checker.map_or_else(String::new, |c| format!(" --square {:.0}", c.square_px));
            Some(format!("slcal pattern checker --projector {w}x{h}{square} --marks -o checker.png"))
        }
        Step::Calibrate => {
            let used = state.photographs.iter().filter(|p| p.used && p.problem.is_none());
            let names: Vec<&str> = used.map(|p| p.name.as_str()).collect();
            let photos = match (names.is_empty(), state.photographs.is_empty()) {
                (false, _) => names.join(" "),
                (true, true) => "sheet-001.jpg".to_owned(),
                // All are thrown out.
                (true, false) => return None,
            };
            Some(format!("slcal calibrate {photos} --size {size} --pattern checker.json -o rig.json"))
        }
        Step::Scan => {
            let last = state.scan.clouds.last();
            let is_sequence =
                last.map_or(state.scan.method != ScanMethod::Stripes, |cloud| cloud.frames.is_some());
            let usual = if is_sequence { "scan-001" } else { "scan-001.jpg" };
            let photo = last.map_or(usual, |c| c.photo_name.as_str());
            let cloud = last.map_or("scan-001.ply", |c| c.name.as_str());
            let pattern =
                if is_sequence { format!("{photo}/{DESCRIPTION}") } else { "stripes.json".to_owned() };
            Some(format!("slcal reconstruct --rig rig.json --pattern {pattern} {photo} --mesh -o {cloud}"))
        }
        Step::Use => {
            let picture = state.in_use.picture_file.as_deref().unwrap_or("picture.png");
            Some(format!("slcal rectify --rig rig.json --image {} -o projected.png", quoted(picture)))
        }
    }
}

fn photographs(n: usize) -> String {
    match n {
        1 => "one photograph".into(),
        2 => "two photographs".into(),
        n => format!("{n} photographs"),
    }
}

/// A number with its thousands apart.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            // A narrow space at which no line breaks.
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(
            [0, 999, 1000, 1_234_567].map(grouped),
            ["0", "999", "1\u{202f}000", "1\u{202f}234\u{202f}567"]
        );
    }
}
