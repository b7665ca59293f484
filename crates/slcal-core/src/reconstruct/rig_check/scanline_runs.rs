//! Matches → runs: the crossings of one slit on successive scanlines of one surface.

use crate::matches::Match;

/// A run continues over this many scanlines without a match, less one.
const GAP: f64 = 4.0;
/// Steepest course of a run, px across the scanlines per scanline. Where a slit crosses its scanlines at less than 34°, it
/// leaves no runs.
const STEEPEST: f64 = 1.5;
/// Shorter runs are left out: labels that are wrong by chance rarely agree on more scanlines.
const SHORTEST: usize = 8;
/// Runs of a slit that may be open at a time: surfaces that one scanline crosses in the light of one slit.
const OPEN: usize = 4;
/// Matches by which the direction of the scanlines is told.
const SAMPLE: usize = 64;
/// The match this many before the last, and after the first, tells how fast a run advances at its end.
const INNER: usize = 3;

/// A run; matches by their index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Run {
    pub(super) slit: u16,
    /// The first match, and an inner one close by.
    pub(super) first: [usize; 2],
    /// The same at the other end.
    pub(super) last: [usize; 2],
}

#[derive(Debug, Clone, Copy)]
struct OpenRun {
    count: usize,
    first: [usize; 2],
    /// The last matches, a ring.
    recent: [usize; INNER + 1],
    line: f64,
    at: f64,
}

impl OpenRun {
    fn begin(i: usize, line: f64, at: f64) -> Self {
        Self { count: 1, first: [i; 2], recent: [i; INNER + 1], line, at }
    }

    /// How far a match lies from the end of the run across the scanlines, if it can continue it.
    fn distance(&self, line: f64, at: f64) -> Option<f64> {
        let (step, aside) = (line - self.line, (at - self.at).abs());
        (self.count > 0 && step > 0.0 && step <= GAP && aside <= STEEPEST * step).then_some(aside)
    }

    fn push(&mut self, i: usize, line: f64, at: f64) {
        if self.count == INNER {
            self.first[1] = i;
        }
        self.recent[self.count % (INNER + 1)] = i;
        self.count += 1;
        (self.line, self.at) = (line, at);
    }

    fn run(&self, slit: u16) -> Option<Run> {
        let [last, inner] =
            [1, 1 + INNER].map(|back| self.recent[(self.count.max(back) - back) % (INNER + 1)]);
        (self.count >= SHORTEST).then_some(Run { slit, first: self.first, last: [last, inner] })
    }
}

const CLOSED: OpenRun =
    OpenRun { count: 0, first: [0; 2], recent: [0; INNER + 1], line: f64::NEG_INFINITY, at: 0.0 };

/// Finds runs; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct RunFinder {
    open: Vec<[OpenRun; OPEN]>,
    runs: Vec<Run>,
}

impl RunFinder {
    /// The runs of matches in the order of their scanlines, sorted by slit, and the image coordinate that was measured
    /// along the scanlines. `None` for matches that do not lie on scanlines in order.
    pub(super) fn find(&mut self, matches: &[Match]) -> Option<(&[Run], usize)> {
        let across = measured_coordinate(matches)?;
        self.runs.clear();
        self.open.iter_mut().for_each(|of_slit| *of_slit = [CLOSED; OPEN]);
        let mut line_before = f64::NEG_INFINITY;
        for (i, m) in matches.iter().enumerate() {
            let (line, at) = (m.camera[1 - across], m.camera[across]);
            if line < line_before {
                return None;
            }
            line_before = line;
            if let Some(slit) = m.slit {
                self.take(slit, i, line, at);
            }
        }
        for (slit, of_slit) in self.open.iter().enumerate() {
            self.runs.extend(of_slit.iter().filter_map(|open| open.run(u16::try_from(slit).ok()?)));
        }
        self.runs.sort_unstable_by_key(|run| (run.slit, run.first));
        Some((&self.runs, across))
    }

    fn take(&mut self, slit: u16, i: usize, line: f64, at: f64) {
        let place = usize::from(slit);
        if place >= self.open.len() {
            self.open.resize(place + 1, [CLOSED; OPEN]);
        }
        let of_slit = &mut self.open[place];
        let mut nearest: Option<(f64, &mut OpenRun)> = None;
        let mut oldest = 0;
        for k in 1..OPEN {
            if of_slit[k].line < of_slit[oldest].line {
                oldest = k;
            }
        }
        let closing = of_slit[oldest];
        for open in of_slit.iter_mut() {
            if let Some(aside) = open.distance(line, at)
                && nearest.as_ref().is_none_or(|(least, _)| aside < *least)
            {
                nearest = Some((aside, open));
            }
        }
        if let Some((_, open)) = nearest {
            open.push(i, line, at);
        } else {
            self.runs.extend(closing.run(slit));
            of_slit[oldest] = OpenRun::begin(i, line, at);
        }
    }
}

/// The image coordinate that was measured along scanlines: 0 where the other one is a whole number in all matches of a
/// sample. `None` where both are, or neither is.
fn measured_coordinate(matches: &[Match]) -> Option<usize> {
    let whole = |k: usize| {
        let step = matches.len().div_ceil(SAMPLE).max(1);
        matches.iter().step_by(step).all(|m| m.camera[k].fract() == 0.0)
    };
    match (whole(0), whole(1)) {
        (false, true) => Some(0),
        (true, false) => Some(1),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;

    fn crossing(u: f64, v: f64, slit: u16) -> Match {
        Match { slit: Some(slit), ..Match::at(Point2::new(u, v), Some(10.0), None) }
    }

    /// A slit on a wall, and before it on an object between lines 10 and 30; another one with gaps.
    fn scene() -> Vec<Match> {
        let mut all = Vec::new();
        for v in 0..40_u32 {
            let v = f64::from(v);
            if !(10.0..30.0).contains(&v) || v > 28.0 {
                all.push(crossing(100.25 + 0.5 * v, v, 3));
            }
            if (10.0..30.0).contains(&v) {
                all.push(crossing(150.25 - 0.25 * v, v, 3));
            }
            if (v as u32).is_multiple_of(3) {
                all.push(crossing(300.125, v, 5));
            }
        }
        all
    }

    #[test]
    fn a_slit_leaves_one_run_per_surface() {
        let matches = scene();
        let mut finder = RunFinder::default();
        for _ in 0..2 {
            let (runs, across) = finder.find(&matches).unwrap();
            assert_eq!(across, 0);
            let lines: Vec<_> = runs
                .iter()
                .map(|r| (r.slit, matches[r.first[0]].camera.y, matches[r.last[0]].camera.y))
                .collect();
            assert_eq!(lines, [(3, 0.0, 9.0), (3, 10.0, 29.0), (3, 29.0, 39.0), (5, 0.0, 39.0)]);
            let object = &runs[1];
            assert_eq!(matches[object.first[1]].camera.y, 13.0);
            assert_eq!(matches[object.last[1]].camera.y, 26.0);
        }
    }

    #[test]
    fn scanlines_may_be_columns_and_must_be_in_order() {
        let mut matches = scene();
        for m in &mut matches {
            m.camera = Point2::new(m.camera.y, m.camera.x);
        }
        let mut finder = RunFinder::default();
        let (runs, across) = finder.find(&matches).unwrap();
        assert_eq!((runs.len(), across), (4, 1));
        matches.swap(0, 20);
        assert!(finder.find(&matches).is_none());
        // Both coordinates of another decoder's matches are measured.
        for m in &mut matches {
            m.camera.x += 0.3;
        }
        assert!(finder.find(&matches).is_none());
    }
}
