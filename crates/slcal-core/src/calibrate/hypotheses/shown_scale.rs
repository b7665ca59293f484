//! Whether the picture was shown pixel for pixel, full screen and not mirrored.
//!
//! Nothing in the geometry shows it: a picture at 95 % of its size is a projector with a focal length of 1/0.95. But the light ends
//! where the panel ends, whatever is shown. Where its border or a mark is seen on the sheet, the calibrated devices say which
//! pixel of the pattern would lie there. This does not find a picture that is shown smaller within a dark surround.

use nalgebra::Point2;

use crate::estimate::propagation::{STEP_SIGMAS, propagate};
use crate::estimate::{Model, Solution};
use crate::observations::{Observations, UNKNOWN_SIGMA_PX};
use crate::rig::Warning;

/// Distance of a border from its expected place that is reported: in its σ, and as a part of the panel's side. A smaller one does
/// less harm than the paper's bend.
const DOUBTFUL: f64 = 5.0;
const PRACTICAL: f64 = 0.003;
/// Places on one axis give a scale from this part of the panel's side between them on.
const APART: f64 = 0.5;
/// A mirrored mark is this near to the opposite place, as a part of the panel's side, in a picture that is scaled as well.
const NEAR_OPPOSITE: f64 = 0.1;
/// Points of a border for which σ is computed.
const SAMPLE: usize = 4;

/// One place of the panel in one photograph: a coordinate, and where it is seen.
struct Place {
    axis: usize,
    expected: f64,
    is_border: bool,
    view: usize,
    points: Vec<Point2<f64>>,
    sigma_px: f64,
}

impl Place {
    /// The mean coordinate, in the pattern's pixels, of what is seen at every `stride`-th point.
    fn coordinate(&self, model: &Model, stride: usize) -> Option<f64> {
        let sheet = model.views.get(self.view)?;
        let (mut sum, mut count) = (0.0, 0.0);
        for &p in self.points.iter().step_by(stride) {
            sum += model.on_panel(sheet, p)?[self.axis];
            count += 1.0;
        }
        Some(sum / count).filter(|c: &f64| c.is_finite())
    }

    /// 1σ of that coordinate by the noise of the points.
    fn noise(&self, model: &Model) -> Option<f64> {
        let (sheet, p) = (model.views.get(self.view)?, self.points[self.points.len() / 2]);
        let at = |dx: f64, dy: f64| Some(model.on_panel(sheet, Point2::new(p.x + dx, p.y + dy))?[self.axis]);
        let slope = (at(0.5, 0.0)? - at(-0.5, 0.0)?).hypot(at(0.0, 0.5)? - at(0.0, -0.5)?);
        Some(slope * self.sigma_px / (self.points.len() as f64).sqrt())
    }
}

/// The places that are seen in all photographs.
fn places(observations: &Observations) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for (view, seen) in observations.views.iter().enumerate() {
        for point in &seen.panel_points {
            let is_border = point.expected.iter().any(Option::is_none);
            for (axis, expected) in point.expected.iter().enumerate().filter_map(|(k, c)| Some((k, (*c)?))) {
                let same = |p: &&mut Place| {
                    (p.axis, p.is_border, p.view) == (axis, is_border, view) && p.expected == expected
                };
                if let Some(place) = places.iter_mut().find(same) {
                    place.points.push(point.camera);
                } else {
                    let sigma_px = point.sigma_px.unwrap_or(UNKNOWN_SIGMA_PX);
                    let points = vec![point.camera];
                    places.push(Place { axis, expected, is_border, view, points, sigma_px });
                }
            }
        }
    }
    places
}

/// A coordinate of the panel, where it is seen in the pattern's pixels, and 1σ of that.
#[derive(Debug, Clone, Copy)]
struct Seen {
    expected: f64,
    at: f64,
    sigma: f64,
}

impl Seen {
    fn is_off(&self, side: f64) -> bool {
        (self.at - self.expected).abs() > (DOUBTFUL * self.sigma).max(PRACTICAL * side)
    }
}

/// What is known along one axis of the panel: up to two places, far apart.
#[derive(Debug, Clone, Default)]
struct AlongAxis(Vec<Seen>);

impl AlongAxis {
    /// The scale at which the picture was shown and the panel's coordinate of its pixel 0.
    fn scale(&self) -> Option<[f64; 2]> {
        let [a, b] = self.0.as_slice() else { return None };
        let scale = (b.expected - a.expected) / (b.at - a.at);
        Some([scale, a.expected - scale * a.at]).filter(|s| s.iter().all(|s| s.is_finite()))
    }

    /// Whether a place far from the middle of the panel is seen about where its mirror image belongs.
    fn is_mirrored(&self, side: f64) -> bool {
        let opposite = |s: &Seen| (s.at + s.expected - (side - 1.0)).abs() < NEAR_OPPOSITE * side;
        self.0.iter().any(|s| opposite(s) && (s.at - s.expected).abs() > APART * side)
    }

    /// 1σ of the scale.
    fn sigma(&self) -> f64 {
        let [a, b] = self.0.as_slice() else { return f64::INFINITY };
        a.sigma.hypot(b.sigma) / (b.expected - a.expected).abs()
    }
}

/// How the picture was shown, as far as borders of the light or marks show it.
#[derive(Debug, Clone)]
pub(crate) struct ShownScale {
    axes: [AlongAxis; 2],
    panel: [f64; 2],
    /// Whether it was said to appear mirrored.
    mirrored: bool,
}

impl ShownScale {
    /// Scale along x and y: 1 where it was shown pixel for pixel; `None` where it is not seen. Negative where it is mirrored.
    pub(crate) fn scale(&self) -> [Option<f64>; 2] {
        [0, 1].map(|k: usize| self.axes[k].scale().map(|s| s[0]))
    }

    /// 1σ of the scale along x and y; infinite where it is not seen.
    pub(crate) fn sigma(&self) -> [f64; 2] {
        [0, 1].map(|k: usize| self.axes[k].sigma())
    }

    /// Whether anything is elsewhere than it should be, beyond its σ and beyond what matters.
    pub(crate) fn is_off(&self) -> bool {
        (0..2).any(|k| self.axes[k].0.iter().any(|seen| seen.is_off(self.panel[k])))
    }
}

/// Measures how the picture was shown; `None` where neither borders of the light nor marks are seen.
pub(crate) fn shown_scale(observations: &Observations, solution: &Solution) -> Option<ShownScale> {
    let panel = observations.projector?.map(f64::from);
    let places = places(observations);
    let mut axes = [AlongAxis::default(), AlongAxis::default()];
    for (axis, along) in axes.iter_mut().enumerate() {
        *along = along_axis(axis, &places, panel[axis], solution);
    }
    axes.iter().any(|a| !a.0.is_empty()).then_some(ShownScale {
        axes,
        panel,
        mirrored: observations.mirrored,
    })
}

/// The borders of an axis or else its marks, those furthest apart. Marks at the opposite places come first: the light of a mirrored
/// picture ends where it should.
fn along_axis(axis: usize, places: &[Place], side: f64, solution: &Solution) -> AlongAxis {
    let furthest = |border: bool| {
        let of_kind: Vec<&Place> =
            places.iter().filter(|p| p.axis == axis && p.is_border == border).collect();
        let first = of_kind.iter().map(|p| p.expected).fold(f64::INFINITY, f64::min);
        let last = of_kind.iter().map(|p| p.expected).fold(f64::NEG_INFINITY, f64::max);
        let ends = if last - first > APART * side { vec![first, last] } else { vec![first] };
        let at_end = |expected| {
            let of_end: Vec<&Place> = of_kind.iter().filter(|p| p.expected == expected).copied().collect();
            agreed(&of_end, side, solution)
        };
        AlongAxis(ends.into_iter().filter_map(at_end).collect())
    };
    let marks = furthest(false);
    if marks.is_mirrored(side) {
        return marks;
    }
    let borders = furthest(true);
    if borders.0.is_empty() { marks } else { borders }
}

/// One place in all photographs that show it, weighted; `None` where they contradict each other.
fn agreed(places: &[&Place], side: f64, solution: &Solution) -> Option<Seen> {
    let mut all = Vec::new();
    for place in places {
        let stride = place.points.len().div_ceil(SAMPLE);
        let values = |step: &nalgebra::DVector<f64>| {
            let model = solution.model().moved(&solution.problem.unknowns, step)?;
            Some([place.coordinate(&model, stride)?])
        };
        let [by_model] = propagate(&solution.covariance, STEP_SIGMAS, values)?;
        let at = place.coordinate(solution.model(), 1)?;
        let sigma = by_model.hypot(place.noise(solution.model())?);
        all.push(Seen { expected: place.expected, at, sigma });
    }
    let weight: f64 = all.iter().map(|s| s.sigma.powi(-2)).sum();
    let mean = all.iter().map(|s| s.at * s.sigma.powi(-2)).sum::<f64>() / weight;
    let apart = |s: &Seen| (s.at - mean).abs() > (DOUBTFUL * s.sigma).max(PRACTICAL * side);
    let expected = all.first()?.expected;
    // The photographs share the devices and with them most of σ: several do not make it smaller.
    let sigma = all.iter().map(|s| s.sigma).fold(f64::INFINITY, f64::min);
    (!all.iter().any(apart)).then_some(Seen { expected, at: mean, sigma })
}

/// What was found, and what to do about it.
impl ShownScale {
    /// A warning when the picture was shown in another way than it was drawn.
    pub(crate) fn hint(&self, observations: &Observations) -> Option<Warning> {
        self.is_off().then(|| {
            Warning::new(
                "shown-1:1",
                format!("the picture was not shown pixel for pixel: {}", self.found()),
                self.advice(observations),
            )
        })
    }

    /// 1σ of the scale where both axes show it, and it is right.
    pub(crate) fn tested(&self) -> Option<f64> {
        let both = self.scale().iter().all(Option::is_some);
        let [x, y] = self.sigma();
        (both && !self.is_off()).then_some(x.max(y))
    }

    /// Names of the ends of an axis.
    const ENDS: [[&str; 2]; 2] = [["left", "right"], ["upper", "lower"]];

    fn found(&self) -> String {
        if let Some(how) = self.exchanged() {
            let than = if self.mirrored { "the other way round than was said" } else { "mirrored" };
            return format!("it is {than}, {how} are exchanged: its marks are seen at the opposite places");
        }
        let percent = |k: usize, s: f64| {
            let sigma = 100.0 * self.sigma()[k];
            format!("{:.1} ± {:.1} %", 100.0 * s, sigma.max(0.05))
        };
        let size = match self.scale() {
            [Some(x), Some(y)] if self.is_uniform() => {
                let k = usize::from(self.sigma()[1] < self.sigma()[0]);
                format!("at {} of its size; ", percent(k, [x, y][k]))
            }
            [Some(x), Some(y)] => {
                format!("stretched to {} of its width and {} of its height; ", percent(0, x), percent(1, y))
            }
            [Some(x), None] => format!("at {} of its width; ", percent(0, x)),
            [None, Some(y)] => format!("at {} of its height; ", percent(1, y)),
            [None, None] => String::new(),
        };
        let places: Vec<String> = (0..2)
            .flat_map(|k| self.axes[k].0.iter().map(move |s| (k, s)))
            .map(|(k, s)| self.place(k, s))
            .collect();
        format!("{size}the light of the projector ends {}", places.join(", "))
    }

    /// Which sides of the picture are exchanged.
    fn exchanged(&self) -> Option<&'static str> {
        match [0, 1].map(|k: usize| self.axes[k].is_mirrored(self.panel[k])) {
            [true, _] => Some("left and right"),
            [false, true] => Some("top and bottom"),
            [false, false] => None,
        }
    }

    /// Where one border is seen, against where it is expected.
    fn place(&self, axis: usize, seen: &Seen) -> String {
        let far = seen.expected > self.panel[axis] / 2.0;
        let outwards = (seen.at - seen.expected) * if far { 1.0 } else { -1.0 };
        let name = Self::ENDS[axis][usize::from(far)];
        if !seen.is_off(self.panel[axis]) {
            return format!("at the {name} border of the picture as it should");
        }
        let side = if outwards > 0.0 { "outside" } else { "inside" };
        format!(
            "{:.0} ± {:.0} px {side} the {name} border of the picture",
            outwards.abs(),
            seen.sigma.max(1.0)
        )
    }

    /// Whether nothing contradicts one scale of both axes, beyond their σ and what matters.
    fn is_uniform(&self) -> bool {
        let [Some(x), Some(y)] = self.scale() else { return true };
        (x - y).abs() <= (DOUBTFUL * self.sigma()[0].hypot(self.sigma()[1])).max(PRACTICAL)
    }

    fn advice(&self, observations: &Observations) -> String {
        let show = "show the picture full screen and pixel for pixel, at the native resolution of the projector, with scaling, zoom, \
                    keystone correction, overscan and mirroring switched off, and take the photographs again";
        if self.exchanged().is_some() {
            let instead = if self.mirrored { "not mirrored" } else { "mirrored" };
            return format!(
                "calibrate and scan with the picture taken as {instead}, if that is how it is meant (rear projection, a mirror in the \
                 light); otherwise {show}"
            );
        }
        let scales: Vec<f64> = self.scale().into_iter().flatten().collect();
        let scale = scales.iter().sum::<f64>() / scales.len() as f64;
        // One scale and one border along each axis say where the picture was shown.
        let from = [0, 1].map(|k: usize| self.axes[k].0.first().map(|seen| seen.expected - scale * seen.at));
        let square = square_px(observations).filter(|_| scale > 0.0 && self.is_uniform());
        let ([Some(from_x), Some(from_y)], Some(square)) = (from, square) else { return show.to_owned() };
        format!(
            "{show}; or calibrate with a description of what was shown, in which square_px is {:.2} and origin_px is {scale:.4} times \
             what it was plus ({from_x:.1}, {from_y:.1}), and show every other picture in the same way",
            scale * square
        )
    }
}

/// The side of a square as the pattern has it: the smallest distance of its corners.
fn square_px(observations: &Observations) -> Option<f64> {
    let mut x: Vec<f64> = observations.views.iter().flat_map(|v| &v.pairs).map(|p| p.projector.x).collect();
    x.sort_by(f64::total_cmp);
    let steps = x.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 1e-3);
    steps.reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assumption::AssumptionStatus;
    use crate::calibrate::maximum_likelihood::solve_in_steps;
    use crate::calibrate::tests::scene::{observe, pose, rig, rng, with_edges};
    use crate::calibrate::{CalibrateConfig, calibrate_observations};
    use crate::geometry::Distortion;
    use crate::observations::PanelPoint;
    use crate::rig::Verdict;

    const PANEL: [f64; 2] = [1024.0, 768.0];

    /// The picture's pixel p is shown at the panel's pixel scale·p + offset.
    #[derive(Clone, Copy)]
    struct Shown {
        scale: [f64; 2],
        offset: [f64; 2],
    }

    impl Shown {
        fn centred(scale: [f64; 2]) -> Self {
            let offset = std::array::from_fn(|k| (1.0 - scale[k]) * (PANEL[k] - 1.0) / 2.0);
            Self { scale, offset }
        }
    }

    /// Two photographs or one of the picture, and where a place of the panel is seen in a view.
    fn photographs(views: usize, shown: Shown, seed: u64) -> (Observations, Model) {
        let mut truth = rig(600.0, [pose(25.0, 28.0), pose(-20.0, -25.0)][..views].to_vec());
        truth.projector.as_mut().unwrap().distortion = Distortion { k1: -0.01, ..Distortion::NONE };
        let mut rng = rng(seed);
        let mut seen = with_edges(observe(&truth, 0.05, 0.05, &mut rng), &truth, 40, 0.05, &mut rng);
        for pair in seen.views.iter_mut().flat_map(|v| &mut v.pairs) {
            for k in 0..2 {
                pair.projector[k] = (pair.projector[k] - shown.offset[k]) / shown.scale[k];
            }
        }
        (seen, truth)
    }

    fn camera_of(truth: &Model, view: usize, panel: Point2<f64>) -> Point2<f64> {
        truth.camera.project(&truth.lit(&truth.views[view], panel).unwrap()).unwrap()
    }

    /// Adds a border of the light, seen over the middle half of its length.
    fn add_border(seen: &mut Observations, truth: &Model, view: usize, axis: usize, far: bool) {
        let border = if far { PANEL[axis] - 0.5 } else { -0.5 };
        for k in 0..20 {
            let along = PANEL[1 - axis] * (0.25 + 0.025 * f64::from(k));
            let at = if axis == 0 { Point2::new(border, along) } else { Point2::new(along, border) };
            let mut expected = [None; 2];
            expected[axis] = Some(border);
            let camera = camera_of(truth, view, at);
            seen.views[view].panel_points.push(PanelPoint { camera, expected, sigma_px: Some(0.2) });
        }
    }

    const ALL: [(usize, bool); 4] = [(0, false), (0, true), (1, false), (1, true)];

    fn with_borders(views: usize, shown: Shown, borders: &[(usize, bool)], seed: u64) -> Observations {
        let (mut seen, truth) = photographs(views, shown, seed);
        for view in 0..views {
            for &(axis, far) in borders {
                add_border(&mut seen, &truth, view, axis, far);
            }
        }
        seen
    }

    fn told(seen: &Observations) -> Option<Warning> {
        let rig = calibrate_observations(seen, &CalibrateConfig::default()).unwrap().rig;
        let quality = rig.quality.unwrap();
        let found = quality.warnings.into_iter().find(|w| w.code == "shown-1:1");
        assert!(found.is_none() || quality.verdict >= Verdict::Weak);
        found
    }

    fn status(seen: &Observations) -> AssumptionStatus {
        let rig = calibrate_observations(seen, &CalibrateConfig::default()).unwrap().rig;
        let assumptions = rig.quality.unwrap().assumptions;
        assumptions.into_iter().find(|a| a.code == "shown-1:1").unwrap().status
    }

    #[test]
    fn a_picture_at_another_scale_is_named_with_what_would_be_right() {
        for scale in [0.95, 1.05, 0.9] {
            for views in [1, 2] {
                let shown = Shown::centred([scale; 2]);
                let Warning { message, advice, .. } = told(&with_borders(views, shown, &ALL, 1)).unwrap();
                let number = |text: &str, before: &str| {
                    let (_, rest) = text.split_once(before).unwrap();
                    rest.split([' ', ',']).next().unwrap().parse::<f64>().unwrap()
                };
                let percent = number(&message, "shown pixel for pixel: at ");
                assert!((percent - 100.0 * scale).abs() < 0.3, "{message}");
                // The squares on the panel are 60 px wide, whatever the description says.
                assert!((number(&advice, "square_px is ") - 60.0).abs() < 0.2, "{advice}");
                assert!((number(&advice, "plus (") - shown.offset[0]).abs() < 2.0, "{advice}");
                let side = if scale < 1.0 { "outside the left border" } else { "inside the left border" };
                assert!(message.contains(side), "{message}");
            }
        }
    }

    #[test]
    fn scale_and_offset_are_measured_within_their_sigma() {
        let shown = Shown { scale: [0.93, 0.97], offset: [12.0, 40.0] };
        let (observations, config) = (with_borders(2, shown, &ALL, 5), CalibrateConfig::default());
        let (_, solution) = solve_in_steps(&observations, &config).unwrap();
        let found = shown_scale(&observations, &solution).unwrap();
        for (k, side) in PANEL.into_iter().enumerate() {
            let (scale, sigma) = (found.scale()[k].unwrap(), found.sigma()[k]);
            assert!((scale - shown.scale[k]).abs() < 4.0 * sigma + 1e-4, "{scale} ± {sigma}");
            assert!(sigma < 0.01, "{sigma}");
            let offset = found.axes[k].scale().unwrap()[1];
            assert!((offset - shown.offset[k]).abs() < 4.0 * sigma * side, "{offset}");
        }
        assert!(told(&observations).unwrap().message.contains("stretched to"));
    }

    #[test]
    fn pictures_that_are_shown_as_drawn_are_not_warned_about_and_tested() {
        for seed in 0..20 {
            let observations = with_borders(1 + seed as usize % 2, Shown::centred([1.0; 2]), &ALL, seed);
            assert!(told(&observations).is_none(), "{seed}");
            assert_eq!(status(&observations), AssumptionStatus::Tested);
            let (_, solution) = solve_in_steps(&observations, &CalibrateConfig::default()).unwrap();
            let found = shown_scale(&observations, &solution).unwrap();
            assert!(!found.is_off() && found.sigma().iter().all(|s| *s < 0.01));
        }
        let (plain, _) = photographs(1, Shown::centred([0.95; 2]), 1);
        let (_, solution) = solve_in_steps(&plain, &CalibrateConfig::default()).unwrap();
        assert!(shown_scale(&plain, &solution).is_none() && told(&plain).is_none());
        assert_eq!(status(&plain), AssumptionStatus::Assumed);
    }

    #[test]
    fn one_border_says_how_far_it_is_off_and_nothing_of_the_scale() {
        let observations = with_borders(1, Shown::centred([0.92; 2]), &[(0, true)], 2);
        let Warning { message, advice, .. } = told(&observations).unwrap();
        assert!(message.contains("px outside the right border") && !message.contains("of its"), "{message}");
        assert!(!advice.contains("square_px"), "{advice}");
    }

    #[test]
    fn photographs_that_contradict_each_other_show_nothing() {
        let (mut seen, truth) = photographs(2, Shown::centred([1.0; 2]), 3);
        add_border(&mut seen, &truth, 0, 0, true);
        add_border(&mut seen, &truth, 1, 0, true);
        // In one of them a shadow ends 60 px further inside.
        for point in &mut seen.views[1].panel_points {
            point.expected[0] = Some(1023.5);
            let panel = truth.on_panel(&truth.views[1], point.camera).unwrap();
            point.camera = camera_of(&truth, 1, Point2::new(panel.x - 60.0, panel.y));
        }
        assert!(told(&seen).is_none());
    }

    #[test]
    fn marks_at_the_opposite_places_are_a_mirrored_picture() {
        let (mut seen, truth) = photographs(1, Shown::centred([1.0; 2]), 4);
        for x in [11.5, 511.5, 1011.5] {
            let camera = camera_of(&truth, 0, Point2::new(1023.0 - x, 11.5));
            let expected = [Some(x), Some(11.5)];
            seen.views[0].panel_points.push(PanelPoint { camera, expected, sigma_px: Some(0.2) });
        }
        let message = told(&seen).unwrap().message;
        assert!(message.contains("mirrored, left and right"), "{message}");
    }
}
