//! What pages send: named events.

use serde::Deserialize;

use super::state::{CameraKind, DemoObject, DemoPose, Measured, Picture, ScanMethod, Step};

/// How to scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ScanMode {
    Once,
    Start,
    Stop,
}

/// An event of the operator's page.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub(super) enum OperatorEvent {
    /// Panel, sheet and size of the pattern; what is missing stays as it is.
    SetUp {
        #[serde(default)]
        projector: Option<[u32; 2]>,
        #[serde(default)]
        size: Option<String>,
        #[serde(default)]
        pattern_scale: Option<f64>,
    },
    Step {
        step: Step,
    },
    Camera {
        kind: CameraKind,
        #[serde(default)]
        size: Option<[u32; 2]>,
        #[serde(default)]
        held: Vec<String>,
    },
    CameraLost {
        message: String,
    },
    Take,
    AutoShot {
        on: bool,
    },
    Photograph {
        id: u32,
        used: bool,
    },
    Scan {
        mode: ScanMode,
    },
    ScanMethod {
        method: ScanMethod,
    },
    /// Makes a cloud again, with the rig of now.
    Reconstruct {
        id: u32,
    },
    Show {
        kind: Picture,
    },
    Turn {
        #[serde(flatten)]
        pose: DemoPose,
    },
    Export {
        format: String,
    },
    Object {
        object: DemoObject,
    },
    TakeOver,
    Dismiss,
}

/// A problem as the display's page states it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub(super) struct PageProblem {
    pub(super) message: String,
    pub(super) advice: String,
}

/// An event of the display's page.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub(super) enum DisplayEvent {
    Measured {
        #[serde(flatten)]
        measured: Measured,
        /// Why the page itself refuses to show a pattern.
        #[serde(default)]
        problem: Option<PageProblem>,
    },
    Painted {
        sequence: u64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_read_by_their_names() {
        let read = |text| serde_json::from_str::<OperatorEvent>(text).unwrap();
        assert_eq!(read(r#"{"event":"step","step":"set-up"}"#), OperatorEvent::Step { step: Step::SetUp });
        assert_eq!(
            read(r#"{"event":"set-up","size":"A4"}"#),
            OperatorEvent::SetUp { projector: None, size: Some("A4".into()), pattern_scale: None }
        );
        let turn = r#"{"event":"turn","tilt_deg":[12,-25],"roll_deg":0,"distance_mm":1100}"#;
        assert!(matches!(read(turn), OperatorEvent::Turn { pose } if pose.tilt_deg == [12.0, -25.0]));
        assert!(serde_json::from_str::<OperatorEvent>(r#"{"event":"format-disk"}"#).is_err());
        let measured = r#"{"event":"measured","device_pixel_ratio":1,"screen":[9,8],"viewport":[9,8],"fullscreen":true}"#;
        assert!(matches!(
            serde_json::from_str::<DisplayEvent>(measured),
            Ok(DisplayEvent::Measured { measured, problem: None }) if measured.screen == [9, 8]
        ));
    }
}
