//! Statistics of a cloud: distances and noise of its points, and their deviation from a fitted surface.

use maud::{Markup, html};
use slcal_core::{PointCloud, Reconstruction};

use super::number::{derived, fixed, significant};
use super::page::Section;
use super::plot::{Axis, Bars, Colour, Plot, Strips};
use crate::picture::stripes::thousands;
use crate::quantile::Sorted;
use crate::summary;
use crate::surface::FittedSurface;

/// Bars of a histogram.
const BARS: usize = 60;

/// Distances and noise of the points, and what was left out.
pub(super) fn section(result: &Reconstruction) -> Section {
    let cloud = &result.cloud;
    let distances: Vec<f64> = cloud.distances_mm().collect();
    let noise: Vec<f64> = cloud.points.iter().map(|p| p.noise_mm).collect();
    let left_out = summary::left_out(result);
    let of = if result.sequence().is_some() { "the photographs" } else { "their stripes" };
    let content = html! {
        div.pair {
            figure {
                (histogram("distances", "Distances of the points from the camera.", &distances, ("distance from the camera, mm", "mm"), Colour::Cloud))
                figcaption { "Distances of the points from the camera." }
            }
            figure {
                (histogram("noise", "Noise of the points.", &noise, ("noise along the line of sight, mm", "mm"), Colour::Noise))
                figcaption { "Expected scatter of the points about the true surface, from the noise of " (of) " (1σ)." }
            }
        }
        h3 { "Matches left out" }
        ul.plain {
            @for (count, why) in &left_out { li { (thousands(*count)) " " (why) } }
            @if left_out.is_empty() { li { "none" } }
        }
    };
    Section { id: "points", title: "Points", content }
}

/// The fitted surface that was asked for.
pub(super) fn fit(surface: &Result<FittedSurface, String>, cloud: &PointCloud) -> Section {
    let content = match surface {
        Err(why) => html! { p.note { "No surface was fitted: " (why) } },
        Ok(surface) => fitted(surface, cloud),
    };
    Section { id: "fit", title: "Fitted surface", content }
}

fn fitted(surface: &FittedSurface, cloud: &PointCloud) -> Markup {
    let ((shape, _), report) = (surface.in_words(), surface.report());
    let mut from = surface.distances_mm(cloud);
    from.retain(|d| d.abs() <= report.inlier_limit_mm);
    let rows = [
        ("mean", report.mean_mm, report.mean_percent),
        ("standard deviation", report.std_mm, report.std_percent),
        ("root mean square", report.rms_mm, report.rms_percent),
    ];
    html! {
        p {
            "A " (shape) " was fitted to " (thousands(report.inliers)) " of " (thousands(report.points)) " points: the inliers, within "
            (significant(report.inlier_limit_mm, 2)) " mm of it. " (parameters(surface)) "."
        }
        div.pair {
            div {
                div.scroll { table.narrow {
                    thead { tr {
                        th scope="col" { "Distance of the inliers from it" } th.number scope="col" { "mm" }
                        th.number scope="col" { "% of the distance from the camera" }
                    } }
                    tbody { @for (name, mm, percent) in rows {
                        tr {
                            th scope="row" { (name) }
                            td.number { (derived(&format!("fit.{name}_mm"), mm, &significant(mm, 3))) }
                            td.number { (significant(percent, 2)) }
                        }
                    } }
                } }
            }
            figure {
                (histogram("fit-distances", "Distances of the points from the surface.", &from, ("distance from the surface, mm", "mm"), Colour::Cloud))
            }
        }
    }
}

fn parameters(surface: &FittedSurface) -> Markup {
    match surface {
        FittedSurface::Plane(found) => {
            let n = found.plane.normal;
            html! {
                "Normal " (fixed(n.x, 5)) ", " (fixed(n.y, 5)) ", " (fixed(n.z, 5)) ", offset " (fixed(found.plane.offset_mm, 2)) " mm"
            }
        }
        FittedSurface::Sphere(found) => {
            let c = found.centre;
            html! {
                "Radius " (derived("sphere_radius_mm", found.radius_mm, &fixed(found.radius_mm, 2))) " mm, centre " (fixed(c.x, 2)) ", "
                (fixed(c.y, 2)) ", " (fixed(c.z, 2)) " mm"
            }
        }
    }
}

/// A histogram of values; the last word is their unit.
pub(super) fn histogram(
    id: &str,
    alt: &str,
    values: &[f64],
    (title, unit): (&str, &str),
    colour: Colour,
) -> Markup {
    // Outliers would squeeze all other values into one bar.
    let [low, high] = Sorted::new(values.iter().copied()).range([0.001, 0.999]);
    let width = ((high - low) / BARS as f64).max(f64::MIN_POSITIVE);
    let mut counts = vec![0usize; BARS];
    for x in values.iter().filter(|x| (low..=high).contains(*x)) {
        counts[(((x - low) / width) as usize).min(BARS - 1)] += 1;
    }
    let highest = counts.iter().max().copied().unwrap_or_default() as f64;
    let bars: Vec<(f64, usize)> =
        counts.into_iter().enumerate().map(|(i, count)| (low + (i as f64 + 0.5) * width, count)).collect();
    let words = |(x, count): &(f64, usize)| {
        (*x, format!("{} points at {} {unit}", thousands(*count), significant(*x, 4)))
    };
    let strips = bars.iter().map(words).collect();
    Plot::new(Axis::even(title, [low, high]), Axis::from_zero("points", highest))
        .with(colour, Bars { width, bars })
        .with(Colour::Ink, Strips { width, strips })
        .markup(id, alt)
}
