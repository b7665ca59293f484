//! How square a projected rectangle is on the sheet.

use nalgebra::{Point2, Vector2};

use super::posterior_fit::{Posterior, PosteriorFit};
use crate::estimate::Model;

/// A number with its 1σ.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The projected rectangle as it lies on the sheet. Angles are positive clockwise as the camera sees the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Keystone {
    /// Its corners TL, TR, BR, BL on the sheet, mm from the sheet's top-left corner.
    pub corners_mm: [Point2<f64>; 4],
    /// The angles of its top, right, bottom and left side against the sheet's, rad.
    pub sides_rad: [Measured; 4],
    /// The largest of these in magnitude: the keystone that is left, rad.
    pub worst_rad: Measured,
    /// The mean of the four: how far the picture is turned on the sheet, rad.
    pub rotation_rad: Measured,
    /// Angle between bottom and top, rad.
    pub top_bottom_rad: Measured,
    /// Angle between right and left, rad.
    pub left_right_rad: Measured,
    /// Width over height on the sheet against the pattern's own, less one.
    pub aspect: Measured,
}

/// Number of figures that are propagated.
const FIGURES: usize = 8;

/// The corners on the sheet, mm.
fn on_sheet(model: &Model, outline_px: &[Point2<f64>; 4]) -> Option<[Point2<f64>; 4]> {
    let sheet = model.views.first()?;
    let mut corners = [Point2::origin(); 4];
    for (corner, &q) in corners.iter_mut().zip(outline_px) {
        *corner = sheet.pose.inverse().transform(&model.lit(sheet, q)?).xy();
    }
    Some(corners)
}

/// Angles of the four sides, rotation, both convergences, aspect.
fn figures(c: &[Point2<f64>; 4], aspect: f64) -> [f64; FIGURES] {
    let along_x = |d: Vector2<f64>| d.y.atan2(d.x);
    let along_y = |d: Vector2<f64>| (-d.x).atan2(d.y);
    let [top, right, bottom, left] =
        [along_x(c[1] - c[0]), along_y(c[2] - c[1]), along_x(c[2] - c[3]), along_y(c[3] - c[0])];
    let (w, h) = ((c[1] - c[0]).norm() + (c[2] - c[3]).norm(), (c[2] - c[1]).norm() + (c[3] - c[0]).norm());
    let rotation = (top + right + bottom + left) / 4.0;
    [top, right, bottom, left, rotation, bottom - top, right - left, w / h / aspect - 1.0]
}

/// The keystone of the rectangle with these corners on the panel and this aspect on the pattern.
pub(super) fn keystone(
    posterior: &Posterior,
    fit: &PosteriorFit,
    outline_px: &[Point2<f64>; 4],
    aspect: f64,
) -> Option<Keystone> {
    let corners_mm = on_sheet(&fit.model, outline_px)?;
    let values = figures(&corners_mm, aspect);
    let sigmas = posterior.propagate(fit, |m| Some(figures(&on_sheet(m, outline_px)?, aspect)))?;
    let all: [Measured; FIGURES] = std::array::from_fn(|i| Measured { value: values[i], sigma: sigmas[i] });
    let sides_rad = [all[0], all[1], all[2], all[3]];
    let worst_rad = sides_rad.into_iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    values.iter().all(|v| v.is_finite()).then_some(Keystone {
        corners_mm,
        sides_rad,
        worst_rad,
        rotation_rad: all[4],
        top_bottom_rad: all[5],
        left_right_rad: all[6],
        aspect: all[7],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_positive_clockwise_as_seen() {
        let square = |f: &dyn Fn(f64, f64) -> (f64, f64)| {
            [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| {
                let (x, y) = f(x, y);
                Point2::new(x, y)
            })
        };
        // Turned clockwise: with y downwards, x goes towards y.
        let (s, c) = 0.01f64.sin_cos();
        let turned = figures(&square(&|x, y| (c * x - s * y, s * x + c * y)), 2.0);
        for (i, expected) in [0.01, 0.01, 0.01, 0.01, 0.01, 0.0, 0.0, 0.0].into_iter().enumerate() {
            assert!((turned[i] - expected).abs() < 1e-12, "{i}: {turned:?}");
        }
        // A trapezoid, wider below: the left side leans out to the left at its foot (clockwise), the right one not.
        let keystone = figures(&square(&|x, y| (x + 0.1 * y * (x - 1.0), y)), 2.0);
        assert!(keystone[3] > 0.09 && keystone[1] < -0.09 && (keystone[6] + 0.2).abs() < 0.01);
        assert!(keystone[0] == 0.0 && keystone[4].abs() < 1e-12);
    }
}
