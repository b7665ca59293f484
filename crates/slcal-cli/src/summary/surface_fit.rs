//! A plane or sphere fitted to a cloud.

use crate::output::{Table, TextLayout};
use crate::surface::FittedSurface;

/// The surface, and the distances of the points from it.
pub(crate) fn surface_fit(fit: &FittedSurface) -> String {
    let mut layout = TextLayout::new();
    layout.line(fit.in_words().0, equation(fit));
    let report = fit.report();
    let mut table = Table::new(["", ">mm", "% of the distance from the camera"]);
    for (name, mm, percent) in [
        ("mean", report.mean_mm, report.mean_percent),
        ("std", report.std_mm, report.std_percent),
        ("rms", report.rms_mm, report.rms_percent),
    ] {
        table.row([name.to_owned(), format!("{mm:.4}"), format!("{percent:.4}")]);
    }
    layout.table(&table);
    layout.line(
        "over",
        format!(
            "{} of {} points, the inliers within {:.3} mm ({:.1} % are outliers), {:.0} mm from the camera on average",
            report.inliers,
            report.points,
            report.inlier_limit_mm,
            100.0 * report.outlier_share,
            report.camera_distance_mm
        ),
    );
    layout.into_text()
}

fn equation(fit: &FittedSurface) -> String {
    match fit {
        FittedSurface::Plane(fit) => {
            let (n, offset) = (fit.plane.normal, fit.plane.offset_mm);
            let term = |x: f64, digits: usize, name: &str| {
                format!("{} {:.digits$} {name}", if x < 0.0 { '-' } else { '+' }, x.abs())
            };
            format!("{:.5} x {} {} {} = 0", n.x, term(n.y, 5, "y"), term(n.z, 5, "z"), term(offset, 2, "mm"))
        }
        FittedSurface::Sphere(fit) => {
            let [x, y, z]: [f64; 3] = fit.centre.into();
            format!("centre {x:.2}, {y:.2}, {z:.2} mm, radius {:.2} mm", fit.radius_mm)
        }
    }
}
