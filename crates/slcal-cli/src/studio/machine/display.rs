//! What the display is to show, and whether it does.

use super::state_machine::{Effect, Machine};
use crate::studio::display_check;
use crate::studio::event::DisplayEvent;
use crate::studio::state::{Picture, Problem, ScanMethod, State, Step, Wanted};

impl Machine {
    /// What the display shows in a step.
    pub(super) fn show_for_step(&mut self) {
        let kind = match self.state.step {
            Step::SetUp => Picture::Marks,
            Step::Calibrate => Picture::Checker,
            Step::Scan if self.state.scan.method == ScanMethod::Stripes => Picture::Stripes,
            // White shows where the sequence will fall, and whether anything is overexposed.
            Step::Scan => Picture::White,
            Step::Use if self.state.in_use.picture.is_some() => Picture::Rectified,
            Step::Use => Picture::Black,
        };
        self.show(kind);
    }

    pub(super) fn show(&mut self, kind: Picture) {
        let sequence = self.state.display.wanted.sequence + 1;
        // Until the patterns are drawn there is nothing to show.
        let kind = if kind.is_fetched() && self.begun.is_none() { Picture::Black } else { kind };
        let url = kind.is_fetched().then(|| format!("/api/shown.png?sequence={sequence}"));
        self.state.display.wanted = Wanted { kind, sequence, url };
    }

    /// How many display pages are there.
    pub(in crate::studio) fn displays(&mut self, count: usize) -> Vec<Effect> {
        self.state.display.connected = count > 0;
        if count == 0 {
            self.state.display.measured = None;
            self.state.display.painted = 0;
            self.refused_by_page = None;
            // Another display has another delay.
            (self.delay, self.state.camera.latency_ms) = (None, None);
        }
        self.check_display();
        if count == 0 && self.sequence.is_some() {
            let why = "the display window was closed: the sequence is not complete";
            self.stop_sequence(Some(Problem::new("scan-interrupted", why, "open it, and scan again")));
        }
        // Without stripes there is nothing to scan.
        if count == 0 { self.end_scan() } else { Vec::new() }
    }

    pub(super) fn check_display(&mut self) {
        let of_page = self.refused_by_page.clone();
        let State { display, set_up, demo, .. } = &mut self.state;
        display.problem = match set_up.projector {
            // The simulated projector shows the page's canvas, however large its window is.
            Some(_) if *demo && display.connected => None,
            Some(_) if *demo => Some(Problem::new(
                "display-missing",
                "the display window, which is the simulated projector, is not open",
                "open the display window",
            )),
            Some(panel) => match display_check::check(panel, display.measured.as_ref()) {
                // The page sees what covers it.
                Some(found) if found.code == display_check::NOT_FULL_SCREEN => of_page.or(Some(found)),
                found => found.or(of_page),
            },
            None => None,
        };
    }

    /// An event of the display's page.
    pub(in crate::studio) fn display(&mut self, event: DisplayEvent) -> Vec<Effect> {
        match event {
            DisplayEvent::Measured { measured, problem } => {
                self.state.display.measured = Some(measured);
                let limited = |text: String| text.chars().take(400).collect::<String>();
                let of_page =
                    problem.map(|p| Problem::new("display-refuses", limited(p.message), limited(p.advice)));
                self.refused_by_page = of_page;
                self.check_display();
                self.check_sequence();
                Vec::new()
            }
            DisplayEvent::Painted { sequence } => {
                if sequence <= self.state.display.wanted.sequence {
                    self.state.display.painted = sequence;
                }
                match self.waiting {
                    Some(purpose) if self.state.display.shows_what_is_wanted() => self.shoot(purpose),
                    None if self.state.display.shows_what_is_wanted() => {
                        self.painted_in_sequence();
                        Vec::new()
                    }
                    _ => Vec::new(),
                }
            }
        }
    }
}
