//! Residuals of observations against a rig, view by view.

use crate::calibrate::variance_components::{NoiseOf, SMALLEST, assumed, diagonal, filled};
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::robust::{kept, whitened};
use crate::estimate::validate::validate;
use crate::estimate::{BundleAdjustment, Kind, Measurement, Model, Priors, Target, Unknowns, measurements};
use crate::geometry::Camera;
use crate::observations::Observations;
use crate::rig::Rig;
use crate::solve::{median, rms, robust_scale};
use nalgebra::{Point2, Vector2};

/// From this many times the other photographs' residuals on, a photograph is the odd one: noise and sharpness differ by less
/// between photographs of one camera.
const ODD: f64 = 3.0;

/// A point that was measured and where the rig expects it, camera px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointResidual {
    /// Where it was seen.
    pub seen: Point2<f64>,
    /// Where the rig expects it; of a point on a side of the sheet, the nearest point of that side's image.
    pub expected: Point2<f64>,
    /// 1σ that the detector states, or that the residuals tell where it does not, px.
    pub sigma_px: f64,
    /// Whether the robust loss keeps it.
    pub kept: bool,
}

impl PointResidual {
    /// Expected minus seen, px.
    #[must_use]
    pub fn vector_px(&self) -> Vector2<f64> {
        self.expected - self.seen
    }
}

/// A projected corner against the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairResidual {
    /// In the camera's image.
    pub camera: PointResidual,
    /// Where it was drawn on the panel, projector px.
    pub drawn: Point2<f64>,
    /// Where the seen pixel, cast onto the sheet, lies on the panel, projector px; `None` where it does not meet it.
    pub on_panel: Option<Point2<f64>>,
}

/// The residuals of one view.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewResiduals {
    /// The points along the sheet's sides (top, right, bottom, left), or its corners TL, TR, BR, BL where they were given.
    pub sheet: Vec<PointResidual>,
    /// The projected corners.
    pub pairs: Vec<PairResidual>,
    /// Scatter of the sheet's residuals, in the σ that their detector states: 1 where the noise is as stated. It is the
    /// larger of two figures: the robust scale of all, which shows a view that fits nowhere, and the root mean square of those
    /// that are kept, which shows one that does not fit in some place.
    pub sheet_scatter: f64,
    /// The same of the projected corners; `None` where there are none.
    pub pair_scatter: Option<f64>,
    /// The larger of the two as a multiple of what the other views have (their median); `None` for a single view.
    pub times_others: Option<f64>,
}

impl ViewResiduals {
    /// All points in the photograph: those of the sheet, then the projected corners.
    pub fn points(&self) -> impl Iterator<Item = &PointResidual> {
        self.sheet.iter().chain(self.pairs.iter().map(|p| &p.camera))
    }

    /// Whether this view fits far worse than the others do: another sheet, a bump, a blurred photograph.
    #[must_use]
    pub fn is_odd(&self) -> bool {
        self.times_others.is_some_and(|t| t > ODD)
    }
}

/// The residuals of a rig's own observations, view by view. A σ that is not stated is how widely the residuals themselves
/// scatter, pooled over the views (their median).
///
/// # Errors
/// [`Error::Invalid`] when there are not as many views as the rig has, when image or panel have other sizes than the rig's
/// devices, when the observations themselves are inconsistent, or when a point cannot be seen by the rig at all.
///
/// # Examples
/// ```
/// # let checker = slcal_core::CheckerPattern::new([1024, 768], &Default::default())?;
/// # let sheet = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg"))?;
/// # let mut calibrator = slcal_core::Calibrator::new("594x420mm".parse()?).with_pattern(&checker);
/// # calibrator.add(slcal_core::PhotoView::try_from(&sheet)?)?;
/// # let calibration = calibrator.calibrate()?;
/// use slcal_core::residuals;
///
/// let views = residuals(&calibration.rig, &calibration.observations)?;
/// let worst = views[0].points().map(|p| p.vector_px().norm()).fold(0.0, f64::max);
/// assert!(worst < 1.0 && !views[0].is_odd());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn residuals(rig: &Rig, observations: &Observations) -> Result<Vec<ViewResiduals>> {
    /// Outliers are detected by σ: the first, which is assumed, may be far off.
    const ROUNDS: usize = 3;
    let mut noise = assumed(observations);
    if noise.is_empty() {
        return of_stated(rig, observations);
    }
    let smallest = SMALLEST * diagonal(observations);
    for _ in 0..ROUNDS {
        let views = of_stated(rig, &filled(observations, &noise))?;
        // The pose of a view takes up nearly all information of its four corners.
        for found in noise.iter_mut().filter(|n| n.of != NoiseOf::SheetCorners) {
            let scatter = |v: &ViewResiduals| {
                if found.of == NoiseOf::Pairs { v.pair_scatter } else { Some(v.sheet_scatter) }
            };
            let unstated = found.of.unstated(observations);
            let wanted = views.iter().zip(unstated).filter(|(_, unstated)| *unstated);
            let typical = median(&mut wanted.filter_map(|(v, _)| scatter(v)).collect::<Vec<_>>());
            found.sigma_px = typical.map_or(found.sigma_px, |s| (s * found.sigma_px).max(smallest));
        }
    }
    of_stated(rig, &filled(observations, &noise))
}

fn of_stated(rig: &Rig, observations: &Observations) -> Result<Vec<ViewResiduals>> {
    validate(observations)?;
    belong_together(rig, observations)?;
    let model = Model::of_rig(rig);
    let unknowns = Unknowns::all(observations.views.len(), false);
    let problem = BundleAdjustment::new(measurements(observations), unknowns, Priors::default());
    let misses = problem.misses_px(&model).ok_or_else(|| {
        Error::invalid(
            ErrorSubject::Observations,
            "those that the rig was calibrated from",
            "points that this rig cannot see: behind a device, or where its lens's model ends",
        )
    })?;
    let mut views = split(&problem.measurements, &model, &misses);
    compare(&mut views);
    Ok(views)
}

fn belong_together(rig: &Rig, observations: &Observations) -> Result<()> {
    let size = |d: &Camera| [d.width, d.height];
    let expected = (rig.views.len(), size(&rig.camera.model), rig.projector.map(|p| size(&p.device.model)));
    let found = (observations.views.len(), observations.camera, observations.projector);
    if expected == found {
        return Ok(());
    }
    let words = |(views, [w, h], panel): (usize, [u32; 2], Option<[u32; 2]>)| {
        let panel = panel.map_or("no projector".to_owned(), |[w, h]| format!("a projector of {w}x{h} px"));
        format!("{views} view(s) of {w}x{h} px with {panel}")
    };
    Err(Error::invalid(
        ErrorSubject::Observations,
        format!("those of the rig: {}", words(expected)),
        words(found),
    ))
}

fn split(measurements: &[Measurement], model: &Model, misses: &[Vector2<f64>]) -> Vec<ViewResiduals> {
    let norms: Vec<f64> = misses.iter().map(Vector2::norm).collect();
    let kept = kept(measurements, &norms);
    let empty = ViewResiduals {
        sheet: Vec::new(),
        pairs: Vec::new(),
        sheet_scatter: 0.0,
        pair_scatter: None,
        times_others: None,
    };
    let mut views = vec![empty; model.views.len()];
    for ((m, miss), kept) in measurements.iter().zip(misses).zip(&kept) {
        let point =
            PointResidual { seen: m.seen, expected: m.seen + miss, sigma_px: m.sigma_px, kept: *kept };
        match m.of {
            Target::Pair(drawn) => {
                let on_panel = model.on_panel(&model.views[m.view], m.seen);
                views[m.view].pairs.push(PairResidual { camera: point, drawn, on_panel });
            }
            _ => views[m.view].sheet.push(point),
        }
    }
    for (i, view) in views.iter_mut().enumerate() {
        view.sheet_scatter = scatter(measurements, &norms, &kept, |m| m.view == i && m.kind() != Kind::Pair);
        view.pair_scatter = (!view.pairs.is_empty())
            .then(|| scatter(measurements, &norms, &kept, |m| m.view == i && m.kind() == Kind::Pair));
    }
    views
}

fn scatter(
    measurements: &[Measurement],
    norms: &[f64],
    kept: &[bool],
    of: impl Fn(&Measurement) -> bool,
) -> f64 {
    let own = || measurements.iter().zip(norms).zip(kept).filter(|((m, _), _)| of(m));
    let robust = robust_scale(own().map(|((m, n), _)| whitened(m, *n)));
    let per_coordinate = |m: &Measurement, n: &f64| n / m.sigma_px / (m.rows() as f64).sqrt();
    let of_kept = own().filter(|(_, kept)| **kept).map(|((m, n), _)| per_coordinate(m, n));
    robust.max(rms(of_kept).unwrap_or(0.0))
}

/// Sets every view beside the others, sheets and projected corners by themselves: a view may be odd in one alone.
fn compare(views: &mut [ViewResiduals]) {
    let kinds: [fn(&ViewResiduals) -> Option<f64>; 2] = [|v| Some(v.sheet_scatter), |v| v.pair_scatter];
    let times = |i: usize| {
        let of_kind = |scatter: &fn(&ViewResiduals) -> Option<f64>| {
            let others = views.iter().enumerate().filter(|(j, _)| *j != i);
            let typical = median(&mut others.filter_map(|(_, v)| scatter(v)).collect::<Vec<_>>());
            Some(scatter(&views[i])? / typical.filter(|t| *t > 0.0)?)
        };
        kinds.iter().filter_map(of_kind).max_by(f64::total_cmp)
    };
    let times: Vec<_> = (0..views.len()).map(times).collect();
    for (view, times) in views.iter_mut().zip(times) {
        view.times_others = times;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::tests::scene::{ideal, observe, pose, rig, rng, with_edges};
    use crate::calibrate::{CalibrateConfig, calibrate_observations};
    use crate::observations::SheetObservation;

    /// Three views with noise of 0.1 px, and the rig that is calibrated from them.
    fn calibrated(spoil: impl Fn(&mut Observations)) -> (Rig, Observations) {
        calibrated_under(&ideal(), spoil)
    }

    fn calibrated_under(config: &CalibrateConfig, spoil: impl Fn(&mut Observations)) -> (Rig, Observations) {
        let truth = rig_of_views();
        let mut rng = rng(7);
        let seen = observe(&truth, 0.1, 0.1, &mut rng);
        let mut seen = with_edges(seen, &truth, 40, 0.1, &mut rng);
        spoil(&mut seen);
        (calibrate_observations(&seen, config).unwrap().rig, seen)
    }

    fn rms(values: impl Iterator<Item = f64>) -> f64 {
        super::rms(values).unwrap()
    }

    #[test]
    fn residuals_are_those_that_the_rig_states() {
        let (rig, seen) = calibrated_under(&CalibrateConfig::default(), |_| ());
        let views = residuals(&rig, &seen).unwrap();
        for (view, of_rig) in views.iter().zip(&rig.views) {
            let stated = of_rig.rms_px.unwrap();
            assert_eq!((view.sheet.len(), view.pairs.len()), (160, 54));
            let sheet = view.sheet.iter().filter(|p| p.kept).map(|p| p.vector_px().norm());
            assert!((rms(sheet) - stated.edges).abs() < 1e-9);
            let kept = || view.pairs.iter().filter(|p| p.camera.kept);
            assert!(
                (rms(kept().map(|p| p.camera.vector_px().norm())) - stated.corners.unwrap()).abs() < 1e-9
            );
            let panel = kept().map(|p| (p.on_panel.unwrap() - p.drawn).norm());
            assert!((rms(panel) - stated.projector.unwrap()).abs() < 1e-9);
            // The noise is as stated, less what the fit takes up; no view stands out.
            let scatter = [view.sheet_scatter, view.pair_scatter.unwrap()];
            assert!(scatter.iter().all(|s| (0.75..1.25).contains(s)), "{scatter:?}");
            assert!(!view.is_odd());
        }
    }

    #[test]
    fn what_is_expected_lies_on_the_model() {
        let (rig, seen) = calibrated_under(&CalibrateConfig::default(), |_| ());
        let views = residuals(&rig, &seen).unwrap();
        // The nearest point of a side has no residual of its own.
        let mut exact = seen.clone();
        for (view, found) in exact.views.iter_mut().zip(&views) {
            let SheetObservation::Edges(sides) = &mut view.sheet else { panic!("edges were given") };
            for (p, r) in sides.iter_mut().flatten().zip(&found.sheet) {
                p.position = r.expected;
            }
            for (p, r) in view.pairs.iter_mut().zip(&found.pairs) {
                p.camera = r.camera.expected;
            }
        }
        for view in residuals(&rig, &exact).unwrap() {
            assert!(view.sheet.iter().all(|p| p.vector_px().norm() < 1e-9));
            assert!(view.pairs.iter().all(|p| p.camera.vector_px().norm() < 1e-9));
        }
    }

    #[test]
    fn outliers_and_the_odd_view_are_reported() {
        let (rig, seen) = calibrated(|seen| {
            seen.views[0].pairs[5].camera.x += 20.0;
            let mut shake = rng(9);
            let truth = rig_of_views();
            seen.views[2].pairs.clone_from(&observe(&truth, 1.0, 1.0, &mut shake).views[2].pairs);
            for pair in &mut seen.views[2].pairs {
                pair.sigma_px = Some(0.1);
            }
        });
        let views = residuals(&rig, &seen).unwrap();
        assert!(!views[0].pairs[5].camera.kept && views[0].pairs[6].camera.kept);
        let odd: Vec<bool> = views.iter().map(ViewResiduals::is_odd).collect();
        assert_eq!(
            odd,
            [false, false, true],
            "{:?}",
            views.iter().map(|v| v.times_others).collect::<Vec<_>>()
        );
    }

    #[test]
    fn a_view_that_misfits_in_one_place_stands_out() {
        let (rig, seen) = calibrated(|seen| {
            // A bump under the board's upper left corner.
            for pair in
                seen.views[1].pairs.iter_mut().filter(|p| p.projector.x < 400.0 && p.projector.y < 360.0)
            {
                pair.camera.x += 0.5;
            }
        });
        let views = residuals(&rig, &seen).unwrap();
        let times: Vec<_> = views.iter().map(|v| v.times_others.unwrap()).collect();
        assert!(times[1] > 1.3 && times[0] < 1.1 && times[2] < 1.1, "{times:?}");
    }

    fn rig_of_views() -> Model {
        rig(700.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0), pose(30.0, -20.0)])
    }

    #[test]
    fn observations_of_another_rig_are_refused() {
        let (rig, mut seen) = calibrated(|_| ());
        seen.views.pop();
        let refused = residuals(&rig, &seen).unwrap_err().to_string();
        assert!(
            refused.contains("3 view(s) of 1280x960 px") && refused.contains("found 2 view(s)"),
            "{refused}"
        );
    }
}
