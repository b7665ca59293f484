//! What a check found, and the warnings that follow.

use serde::{Deserialize, Serialize};

use crate::rig::Warning;

/// Fewer contradicting slits may be wrong labels.
const FEWEST: usize = 6;
/// So may a smaller share of them. On photographs with strong noise and compression up to a twentieth of the slits contradict
/// a right rig.
const SHARE: f64 = 0.25;

/// How many slits contradict the rig in one way.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct SlitCount {
    /// Slits that could contradict it.
    pub tested: usize,
    /// Slits that do.
    pub contradicting: usize,
    /// By how much, px on the panel: the median of those that do.
    pub median_px: f64,
    /// What scanlines, noise and the uncertainty of the rig explain, px on the panel: the mean over the same.
    pub allowed_px: f64,
}

impl SlitCount {
    fn is_beyond_chance(&self) -> bool {
        self.contradicting >= FEWEST && self.contradicting as f64 >= SHARE * self.tested as f64
    }
}

/// How the matches of a photograph agree with the rig, by the positions along the slits from which their light comes.
/// Positions count from the panel's first row (its first column for slits that are rows).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct RigCheckReport {
    /// Slits that were seen on enough scanlines.
    pub slits: usize,
    /// Whether the slits are rows of the panel.
    pub slits_are_rows: bool,
    /// Slits with light from before the panel's first position.
    pub outside_start: SlitCount,
    /// Slits with light from beyond its last one.
    pub outside_end: SlitCount,
    /// Slits that end on a straight border of the light that lies inside the panel at its first position.
    pub inside_start: SlitCount,
    /// The same at its last position.
    pub inside_end: SlitCount,
    /// Slits of which some light would fall on two surfaces.
    pub lit_twice: SlitCount,
    /// The scale at which the stripes seem to be shown about the panel's middle, where that explains the ends of the light.
    pub shown_scale: Option<f64>,
}

impl RigCheckReport {
    /// `shown-1:1` where the stripes seem to be shown at another scale, else `rig-moved` where more slits contradict the
    /// rig than chance explains.
    pub(crate) fn warning(&self) -> Option<Warning> {
        self.shown_scale.map(|scale| self.shown(scale)).or_else(|| self.moved())
    }

    fn shown(&self, scale: f64) -> Warning {
        let percent = 100.0 * scale;
        let [_, first, last] = self.words();
        Warning::new(
            "shown-1:1",
            format!(
                "the light of the slits ends inside the projector's image at the {first} and at the {last}, as if the stripes were shown at {percent:.1} % of their size; sizes and distances are then wrong"
            ),
            "show the picture of the stripes pixel by pixel, on the whole screen, without scaling by a viewer, the desktop or the projector; if it was shown so, camera and projector have moved since the calibration: calibrate again",
        )
    }

    fn moved(&self) -> Option<Warning> {
        let [rows, first, last] = self.words();
        let outside = |border| format!("have light from outside the projector's image, beyond its {border}");
        let inside = |border| format!("end on a line inside the {border} of the projector's image");
        let twice = "would light two surfaces from the same place of the projector's image".to_owned();
        let certain = [
            (self.outside_start, outside(first)),
            (self.outside_end, outside(last)),
            (self.lit_twice, twice),
        ];
        let likely = [(self.inside_start, inside(first)), (self.inside_end, inside(last))];
        let (count, what) = strongest(certain).or_else(|| strongest(likely))?;
        let SlitCount { tested, contradicting, median_px, allowed_px } = count;
        Some(Warning::new(
            "rig-moved",
            format!(
                "{contradicting} of {tested} slits {what}: by {median_px:.1} {rows} (median), where noise and the uncertainty of the rig explain {allowed_px:.1}; camera and projector do not stand as the rig has them, and sizes and distances are wrong"
            ),
            "camera or projector has moved, turned, zoomed or been refocused since the calibration, or the stripes are not shown pixel by pixel: verify the rig with a photograph of the sheet, or calibrate again",
        ))
    }

    /// What positions along the slits are counted in, and the panel's borders at their start and end.
    fn words(&self) -> [&'static str; 3] {
        if self.slits_are_rows {
            ["columns", "left border", "right border"]
        } else {
            ["rows", "upper border", "lower border"]
        }
    }
}

/// The finding that most of its slits have, among those beyond chance.
fn strongest<const N: usize>(findings: [(SlitCount, String); N]) -> Option<(SlitCount, String)> {
    let share = |c: &SlitCount| c.contradicting as f64 / c.tested.max(1) as f64;
    let beyond_chance = findings.into_iter().filter(|(count, _)| count.is_beyond_chance());
    beyond_chance.max_by(|a, b| share(&a.0).total_cmp(&share(&b.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_needs_more_than_chance() {
        let count =
            |contradicting, tested| SlitCount { tested, contradicting, median_px: 14.25, allowed_px: 4.5 };
        let report = |outside_end| RigCheckReport { slits: 64, outside_end, ..RigCheckReport::default() };
        assert_eq!(RigCheckReport::default().warning(), None);
        assert_eq!(report(count(5, 8)).warning(), None);
        assert_eq!(report(count(15, 64)).warning(), None);
        let warning = report(count(16, 64)).warning().unwrap();
        assert_eq!(warning.code, "rig-moved");
        assert!(warning.message.starts_with("16 of 64 slits have light from outside the projector's image, beyond its lower border: by 14.2 rows (median), where noise and the uncertainty of the rig explain 4.5"));
        let both = RigCheckReport { lit_twice: count(30, 40), ..report(count(16, 64)) };
        assert!(both.warning().unwrap().message.contains("30 of 40 slits would light two surfaces"));
        let scaled = RigCheckReport { shown_scale: Some(0.95), slits_are_rows: true, ..both }.warning();
        let scaled = scaled.unwrap();
        assert_eq!(scaled.code, "shown-1:1");
        assert!(scaled.message.contains("95.0 %") && scaled.message.contains("left border"));
        assert!(!warning.advice.contains("--"));
    }
}
