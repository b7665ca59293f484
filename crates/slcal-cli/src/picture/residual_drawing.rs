//! The residuals of a calibration, enlarged, over the measured points.

use nalgebra::{Point2, Vector2};
use slcal_core::geometry::{Camera, ProjectivePoint};
use slcal_core::{View, ViewObservation, ViewResiduals};

use super::drawing::color::{GREEN, PINK, VERMILLION};
use super::drawing::legend::{Legend, Swatch};
use super::drawing::{Anchor, Drawing, Pen};
use super::vector_scale::two_digits;
use super::{sheet, vector_scale};
use crate::name::short;

/// Half the size of an outlier's cross, units.
const CROSS: f64 = 4.5;
/// A vanishing point is drawn within this many image sizes of the frame; the lines to a farther one look parallel.
const NEAR: f64 = 1.0;

/// A view with its observations and residuals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasuredView<'a> {
    pub(crate) observed: &'a ViewObservation,
    pub(crate) residuals: &'a ViewResiduals,
    pub(crate) view: &'a View,
    /// The rig's camera.
    pub(crate) camera: &'a Camera,
}

fn arrow_pen() -> Pen {
    Pen::new(GREEN).width(1.2)
}
fn outlier_pen() -> Pen {
    Pen::new(VERMILLION).width(1.6)
}
fn pencil_pen() -> Pen {
    Pen::new(PINK).width(0.9).dashed()
}

impl MeasuredView<'_> {
    /// Number of points.
    pub(crate) fn count(&self) -> usize {
        self.residuals.points().count()
    }

    /// Number of outliers, which the calibration left out.
    pub(crate) fn outliers(&self) -> usize {
        self.residuals.points().filter(|p| !p.kept).count()
    }

    /// The rms residuals in words; empty when the rig does not state them.
    pub(crate) fn in_words(&self) -> String {
        let Some(rms) = self.view.rms_px else { return String::new() };
        let corners = rms.corners.map_or(String::new(), |c| format!(", corners {} px", two_digits(c)));
        format!("rms residuals: edges {} px{corners}", two_digits(rms.edges))
    }

    /// How this view compares with the others, when it fits worse.
    pub(crate) fn odd_in_words(&self) -> Option<String> {
        let times = self.residuals.times_others.filter(|_| self.residuals.is_odd())?;
        Some(match times {
            t if t < 10.0 => format!("fits {t:.1} times worse than the others"),
            t if t < 100.0 => format!("fits {t:.0} times worse than the others"),
            _ => "fits more than 100 times worse than the others".to_owned(),
        })
    }
}

/// The common enlargement of the residuals of several views, so that they can be compared.
pub(crate) fn enlargement<'a>(fits: impl IntoIterator<Item = MeasuredView<'a>>, unit: f64) -> f64 {
    let mut lengths = Vec::new();
    for fit in fits {
        lengths.extend(fit.residuals.points().filter(|p| p.kept).map(|p| p.vector_px().norm()));
    }
    vector_scale::factor(lengths, vector_scale::SHOWN * unit)
}

/// A photograph called `name` with the residuals of the calibration, and a legend whose first line is `title`.
pub(crate) fn drawing(size: [u32; 2], name: &str, title: &str, fit: MeasuredView<'_>) -> Drawing {
    let mut drawing = Drawing::new(size, format!("{}: residuals of the calibration", short(name)));
    let factor = enlargement([fit], drawing.unit());
    draw(&mut drawing, fit, factor);
    drawing.legend = Some(legend(&drawing, title, [fit], factor));
    drawing
}

/// The measured points, their residuals enlarged by `factor`, outliers, and vanishing points near the frame.
pub(crate) fn draw(drawing: &mut Drawing, fit: MeasuredView<'_>, factor: f64) {
    draw_vanishing_points(drawing, fit.view);
    sheet::draw_expected(drawing, fit.view, fit.camera);
    let kept = fit.residuals.points().filter(|p| p.kept);
    let arrows: Vec<_> = kept.map(|p| (p.seen, p.seen + p.vector_px() * factor)).collect();
    drawing.arrows(arrows, arrow_pen());
    sheet::draw_marks(drawing, fit.observed);
    let arm = CROSS * drawing.unit();
    let crosses: Vec<_> = fit
        .residuals
        .points()
        .filter(|p| !p.kept)
        .flat_map(|p| [Vector2::new(arm, arm), Vector2::new(arm, -arm)].map(|d| [p.seen - d, p.seen + d]))
        .collect();
    drawing.lines(crosses.iter().map(<[_; 2]>::as_slice), outlier_pen());
}

/// What the marks of [`draw`] mean in one or more views.
pub(crate) fn legend<'a>(
    drawing: &Drawing,
    title: &str,
    fits: impl IntoIterator<Item = MeasuredView<'a>>,
    factor: f64,
) -> Legend {
    let fits: Vec<_> = fits.into_iter().collect();
    let mut legend = sheet::legend(title.to_owned(), fits.iter().map(|f| f.observed));
    if fits.is_empty() {
        return legend;
    }
    let what = "residual, to the predicted position";
    legend = vector_scale::explained(legend, drawing, factor, arrow_pen(), what);
    let outliers: usize = fits.iter().map(MeasuredView::outliers).sum();
    if outliers > 0 {
        let plural = if outliers == 1 { "" } else { "s" };
        let text = format!("{outliers} outlier{plural}, left out");
        legend = legend.entry(Swatch::Cross(outlier_pen()), text);
    }
    if fits.iter().any(|f| near_points(drawing, f.view).next().is_some()) {
        legend = legend.entry(Swatch::Line(pencil_pen()), "to the vanishing point of parallel sides");
    }
    legend
}

/// The vanishing points that are near, each with the two sides of the sheet that run to it.
fn near_points<'a>(
    drawing: &Drawing,
    view: &'a View,
) -> impl Iterator<Item = (Point2<f64>, [[Point2<f64>; 2]; 2], &'static str)> + 'a {
    let [tl, tr, br, bl] = view.corners_px;
    let [to_width, to_height] = view.camera_vanishing_points;
    let frame = drawing.frame();
    let size = frame.high - frame.low;
    let near = move |p: &Point2<f64>| {
        (0..2).all(|k| (frame.low[k] - NEAR * size[k]..=frame.high[k] + NEAR * size[k]).contains(&p[k]))
    };
    [(to_width, [[tl, tr], [bl, br]], "width"), (to_height, [[tl, bl], [tr, br]], "height")]
        .into_iter()
        .filter_map(move |(point, sides, name)| {
            Some((ProjectivePoint(point).pixel().filter(near)?, sides, name))
        })
}

fn draw_vanishing_points(drawing: &mut Drawing, view: &View) {
    let near: Vec<_> = near_points(drawing, view).collect();
    for (point, sides, name) in near {
        let from = sides.map(|[a, b]| if (a - point).norm() < (b - point).norm() { a } else { b });
        drawing.lines(from.map(|p| [p, point]).iter().map(<[_; 2]>::as_slice), pencil_pen());
        let text = format!("vanishing point of the {name}");
        let unit = drawing.unit();
        if drawing.frame().holds(point) {
            drawing.rings([point], 6.0, Pen::new(PINK).width(1.6));
            let right = point.x > 0.5 * (drawing.frame().low.x + drawing.frame().high.x);
            let (step, anchor) = if right { (-12.0, Anchor::End) } else { (12.0, Anchor::Start) };
            drawing.label(point + Vector2::new(step * unit, 0.0), text, 0.85, anchor, PINK);
            continue;
        }
        // An arrow where the middle of its pencil leaves the frame.
        let middle = nalgebra::center(&from[0], &from[1]);
        let Some([start, leaves]) = drawing.frame().grown(-2.0 * unit).segment(middle, point) else {
            continue;
        };
        let reach = (leaves - start).norm().min(40.0 * unit);
        let Some(direction) = (leaves - start).try_normalize(0.0) else { continue };
        drawing.arrows([(leaves - direction * reach, leaves)], Pen::new(PINK).width(1.6));
        // Its words begin where the arrow does.
        let anchor = match direction.x {
            x if x > 0.5 => Anchor::End,
            x if x < -0.5 => Anchor::Start,
            _ => Anchor::Middle,
        };
        let room = drawing.frame().grown(-14.0 * unit);
        drawing.label(room.nearest(leaves - direction * (reach + 10.0 * unit)), text, 0.85, anchor, PINK);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use slcal_core::geometry::{Pose, RectangleSize};
    use slcal_core::{CornerPair, PairResidual, PointResidual, SheetObservation, ViewRms};

    use super::*;
    use crate::picture::drawing::primitive::Primitive;

    const CORNERS: [[f64; 2]; 4] = [[200.0, 100.0], [700.0, 150.0], [650.0, 500.0], [250.0, 450.0]];

    fn view(vanishing: [Vector3<f64>; 2]) -> View {
        View {
            photo: None,
            size: RectangleSize::new(594.0, 420.0).unwrap(),
            camera_from_sheet: Pose { translation: Vector3::new(-260.0, -210.0, 1100.0), ..Pose::identity() },
            bend: None,
            projector_from_sheet: None,
            camera_vanishing_points: vanishing,
            projector_vanishing_points: None,
            corners_px: CORNERS.map(Point2::from),
            rms_px: Some(ViewRms { edges: 0.0512, corners: Some(0.5), projector: None }),
            clipped_percent: None,
        }
    }

    fn camera() -> Camera {
        Camera::pinhole([900, 600], 900.0).unwrap()
    }

    fn observed() -> ViewObservation {
        let pair = |x: f64| CornerPair {
            camera: Point2::new(x, 300.0),
            projector: Point2::new(x, 7.0),
            sigma_px: Some(0.1),
        };
        ViewObservation {
            photo: None,
            size: RectangleSize::new(594.0, 420.0).unwrap(),
            sheet: SheetObservation::Corners { corners: CORNERS.map(Point2::from), sigma_px: Some(0.1) },
            pairs: vec![pair(400.0), pair(450.0)],
            panel_points: Vec::new(),
            channel_offsets: Vec::new(),
        }
    }

    fn residuals() -> ViewResiduals {
        let point = |x: f64, dx: f64, kept: bool| PairResidual {
            camera: PointResidual {
                seen: Point2::new(x, 300.0),
                expected: Point2::new(x + dx, 300.0),
                sigma_px: 0.1,
                kept,
            },
            drawn: Point2::new(x, 7.0),
            on_panel: None,
        };
        ViewResiduals {
            sheet: Vec::new(),
            pairs: vec![point(400.0, 0.1, true), point(450.0, 33.0, false)],
            sheet_scatter: 1.0,
            pair_scatter: None,
            times_others: Some(4.21),
        }
    }

    const FAR: [Vector3<f64>; 2] = [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 1e-9)];

    #[test]
    fn residuals_are_enlarged_and_outliers_crossed() {
        let (observed, residuals, view, camera) = (observed(), residuals(), view(FAR), camera());
        let fit = MeasuredView { observed: &observed, residuals: &residuals, view: &view, camera: &camera };
        let drawing = drawing([900, 600], "a/b.jpg", "b.jpg", fit);
        // 0.1 px becomes 20 of the 24 units that the longer ones are to have.
        assert_eq!(enlargement([fit], 1.0), 200.0);
        let tip = |p: &Point2<f64>| (p - Point2::new(420.0, 300.0)).norm() < 1e-9;
        let heads = drawing.items.iter().filter_map(|i| match &i.primitive {
            Primitive::Areas(areas) => Some(areas),
            _ => None,
        });
        assert_eq!(heads.flatten().filter(|a| tip(&a[0])).count(), 1);
        let words: Vec<_> =
            drawing.legend.as_ref().unwrap().entries.iter().map(|e| e.text.as_str()).collect();
        assert!(words.iter().any(|w| w.contains("×200")), "{words:?}");
        assert!(words.contains(&"1 outlier, left out"), "{words:?}");
        assert!(!words.iter().any(|w| w.contains("vanishing")), "{words:?}");
        assert_eq!(fit.in_words(), "rms residuals: edges 0.051 px, corners 0.50 px");
        assert_eq!(fit.odd_in_words().as_deref(), Some("fits 4.2 times worse than the others"));
    }

    #[test]
    fn vanishing_points_that_are_near_are_pointed_at() {
        let (observed, residuals, camera) = (observed(), residuals(), camera());
        // One to the right of the frame, one in it; then one that is too far, and one at infinity.
        let near = view([Vector3::new(1500.0, 320.0, 1.0), Vector3::new(-800.0, -40.0, -2.0)]);
        let fit = MeasuredView { observed: &observed, residuals: &residuals, view: &near, camera: &camera };
        let drawing = drawing([900, 600], "b.jpg", "", fit);
        let labels: Vec<_> = drawing
            .items
            .iter()
            .filter_map(|i| match &i.primitive {
                Primitive::Text { at, text, .. } if text.contains("vanishing") => Some((*at, text.as_str())),
                _ => None,
            })
            .collect();
        assert_eq!(
            labels.iter().map(|l| l.1).collect::<Vec<_>>(),
            ["vanishing point of the width", "vanishing point of the height"]
        );
        assert!(labels.iter().all(|(at, _)| drawing.frame().holds(*at)), "{labels:?}");
        assert!((labels[1].0 - Point2::new(400.0, 20.0)).norm() < 20.0, "{labels:?}");
        let rings = drawing
            .items
            .iter()
            .any(|i| matches!(&i.primitive, Primitive::Rings(c, _) if c == &[Point2::new(400.0, 20.0)]));
        assert!(rings);
        let dashed = drawing.items.iter().filter(|i| i.pen.dashed).count();
        assert_eq!(dashed, 2);
        let far = view([Vector3::new(9000.0, 320.0, 1.0), FAR[0]]);
        let fit = MeasuredView { observed: &observed, residuals: &residuals, view: &far, camera: &camera };
        assert!(super::drawing([900, 600], "", "", fit).items.iter().all(|i| !i.pen.dashed));
    }
}
