//! A plane or sphere fitted to a cloud.

use slcal_core::evaluate::{FitReport, PlaneFit, SphereFit};

use crate::output::{Table, TextLayout};

/// The plane, and the distances of the points from it.
pub(crate) fn plane_fit(fit: &PlaneFit) -> String {
    let (n, offset) = (fit.plane.normal, fit.plane.offset_mm);
    let term = |x: f64, digits: usize, name: &str| {
        format!("{} {:.digits$} {name}", if x < 0.0 { '-' } else { '+' }, x.abs())
    };
    let equation =
        format!("{:.5} x {} {} {} = 0", n.x, term(n.y, 5, "y"), term(n.z, 5, "z"), term(offset, 2, "mm"));
    surface_fit("plane", &equation, &fit.report)
}

/// The sphere, and the distances of the points from it.
pub(crate) fn sphere_fit(fit: &SphereFit) -> String {
    let [x, y, z]: [f64; 3] = fit.centre.into();
    let words = format!("centre {x:.2}, {y:.2}, {z:.2} mm, radius {:.2} mm", fit.radius_mm);
    surface_fit("sphere", &words, &fit.report)
}

fn surface_fit(shape: &str, surface: &str, report: &FitReport) -> String {
    let mut layout = TextLayout::new();
    layout.line(shape, surface);
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
