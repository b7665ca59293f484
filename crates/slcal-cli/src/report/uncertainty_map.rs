//! The expected uncertainty of points over the working volume: a slice seen from above, and a curve over the depth.

use maud::{Markup, html};
use nalgebra::{Point2, Point3};
use slcal_core::reconstruct::ExpectedSigma;
use slcal_core::{Match, Rig};

use super::number::significant;
use super::page::Section;
use super::plot::{
    Axis, Cells, Colour, ColourBar, Contours, Curve, Key, Levels, NamedPlace, Plot, Segment, Strips, Symbol,
    UprightLine, chosen,
};
use super::rig_page::{RigPage, photo_name};
use crate::summary::working_volume::{WorkingVolume, slopes, stripes};

/// The slice reaches from and to these shares of the sheet's distance.
const NEAREST: f64 = 0.4;
const FARTHEST: f64 = 2.2;
/// Points of the slice.
const COLUMNS: usize = 61;
const ROWS: usize = 46;
/// Points of the curve.
const DEPTHS: usize = 91;
/// Columns and rows that share the words under the pointer.
const BLOCK: usize = 3;

/// The section with both plots.
pub(super) fn section(page: &RigPage, working: slcal_core::Result<Option<WorkingVolume>>) -> Option<Section> {
    let rig = page.rig;
    rig.projector?;
    let content = match working {
        Ok(Some(mut working)) => html! {
            p {
                "The expected error of a single point along the camera’s line of sight (1σ), if the centre of a stripe is located to "
                (Match::DEFAULT_SIGMA_PX) " px, with " (stripes(working.axis)) ". "
                @if !working.knows_rig {
                    "The rig has no covariance, so these numbers are the noise alone. It differs from point to point and makes a surface \
                     rough."
                } @else if working.rig_mm() > working.sigma.noise_mm {
                    "Most of the total is common to all points: it shifts and scales them together. The noise differs from point to point \
                     and makes a surface rough."
                } @else {
                    "Most of the total is noise: it differs from point to point and makes a surface rough."
                }
            }
            div.pair { (working.slice(rig)) (working.depths()) }
        },
        Ok(None) => html! {
            p.note {
                "Not shown: at the distance of "
                @if rig.views.is_empty() { "a few baselines" } @else { "the sheet" }
                " no place is visible to the camera and lit by the projector at an angle that determines its depth."
            }
        },
        Err(error) => html! { p.note { "Not shown: " (error) "." } },
    };
    Some(Section { id: "expected", title: "Expected uncertainty", content })
}

/// The errors of a place, mm.
type Grid = Vec<Vec<Option<ExpectedSigma>>>;

/// The plots.
impl WorkingVolume {
    /// σ seen from above.
    fn slice(&mut self, rig: &Rig) -> Markup {
        let model = &rig.camera.model;
        let deepest = FARTHEST * self.distance_mm;
        // To both edges of the image, which need not be alike.
        let [left, right] = [-0.5, f64::from(model.width) - 0.5].map(|x| {
            let level = model.bearing(Point2::new(x, (f64::from(model.height) - 1.0) / 2.0));
            deepest * level.map_or((x - model.intrinsics.cx) / model.intrinsics.fx, |b| b.x)
        });
        let xs = spread(COLUMNS, left, right);
        let zs = spread(ROWS, NEAREST * self.distance_mm, deepest);
        let slopes = slopes(model);
        let grid: Grid = zs
            .iter()
            .map(|z| xs.iter().map(|x| self.seen_from_above(model, &slopes, *x, *z)).collect())
            .collect();
        let area = Area { range: reach([left, right], deepest, rig), xs, zs };
        let mut plots =
            vec![("noise alone", area.plot(&grid, |s| s.noise_mm, rig).markup("expected-slice-noise", ALT))];
        if self.knows_rig {
            plots.insert(
                0,
                ("total", area.plot(&grid, |s| s.sigma_mm, rig).markup("expected-slice-total", ALT)),
            );
        }
        html! {
            figure id="expected-slice" {
                (chosen("expected-slice", "Which error", &plots))
                figcaption {
                    "Seen from above: camera and projector at the bottom, and in colour where their fields of view overlap at some height"
                    @if !rig.views.is_empty() { ", " @if rig.views.len() == 1 { "the sheet as a black line" } @else { "the sheets as black lines" } }
                    ". Each σ is for the lit image row nearest to the middle. Lighter is more certain; lines connect equal σ."
                }
            }
        }
    }

    /// σ along the line of sight through the middle of the sheet, or another place.
    fn depths(&mut self) -> Markup {
        let zs = spread(DEPTHS, NEAREST * self.distance_mm, FARTHEST * self.distance_mm);
        let all: Vec<_> = zs.iter().map(|z| self.at_depth(*z)).collect();
        let curve = |of: fn(&ExpectedSigma) -> f64, dashed: bool| Curve {
            points: zs.iter().zip(&all).map(|(z, s)| s.as_ref().map(|s| [*z, of(s)])).collect(),
            dashed,
        };
        let values = all.iter().flatten().flat_map(|s| [s.noise_mm, s.sigma_mm]);
        let depth = Axis::even("depth, mm", [zs[0], zs[DEPTHS - 1]]);
        let mut plot = Plot::new(depth, Axis::logarithmic("σ, mm", values));
        if self.knows_rig {
            plot = plot.named("total", Key::Line, Colour::Camera, curve(|s| s.sigma_mm, false));
        }
        plot = plot.named("noise alone", Key::Dashes, Colour::Noise, curve(|s| s.noise_mm, true));
        if self.of_sheet {
            plot = plot.with(Colour::Sheet, UprightLine { x: self.distance_mm, name: "the sheet" });
        }
        let said = |(z, s): (&f64, &Option<ExpectedSigma>)| Some((*z, self.said(*z, s.as_ref()?)));
        let strips = Strips { width: zs[1] - zs[0], strips: zs.iter().zip(&all).filter_map(said).collect() };
        let plot = plot.with(Colour::Ink, strips);
        html! {
            figure {
                (plot.markup("expected-depth", "Expected σ of a point against its depth, total and noise alone."))
                figcaption {
                    "Along the line of sight through "
                    (self.place_in_words())
                    ". At a depth of " (significant(self.distance_mm, 4)) " mm: " (significant(self.sigma.sigma_mm, 2)) " mm"
                    @if self.knows_rig { ", of which " (significant(self.sigma.noise_mm, 2)) " mm are noise." } @else { " of noise." }
                }
            }
        }
    }

    /// The errors at a depth.
    fn said(&self, z: f64, s: &ExpectedSigma) -> String {
        let noise = significant(s.noise_mm, 3);
        let total =
            if self.knows_rig { format!("total {} mm, ", significant(s.sigma_mm, 3)) } else { String::new() };
        format!("{} mm deep: {total}noise {noise} mm", significant(z, 4))
    }
}

const ALT: &str =
    "Expected σ of a point over a slice of the working volume, seen from above; it grows with depth.";

/// Where the slice is known and what is drawn of its surroundings.
struct Area {
    xs: Vec<f64>,
    zs: Vec<f64>,
    range: [[f64; 2]; 2],
}

impl Area {
    /// One of the errors seen from above, with devices and sheets.
    fn plot(&self, grid: &Grid, of: fn(&ExpectedSigma) -> f64, rig: &Rig) -> Plot {
        let values: Vec<Vec<Option<f64>>> =
            grid.iter().map(|row| row.iter().map(|s| s.as_ref().map(of)).collect()).collect();
        let levels = Levels::over(values.iter().flatten().flatten().copied());
        let cells = self.cells(&values);
        let [x, z] = self.range;
        let plot = Plot::new(Axis::even("to the right of the camera, mm", x), Axis::even("depth, mm", z))
            .with_equal_units()
            .colour_bar(ColourBar { levels, title: "σ, mm" })
            .with(Colour::Ink, Contours { xs: self.xs.clone(), ys: self.zs.clone(), values, levels })
            .with(Colour::Ink, cells);
        landmarks(plot, rig)
    }

    /// What the pointer says: a value for each block of the grid.
    fn cells(&self, values: &[Vec<Option<f64>>]) -> Cells {
        let middles = |n: usize| (BLOCK / 2..n).step_by(BLOCK);
        let mut cells = Vec::new();
        for (j, i) in middles(self.zs.len()).flat_map(|j| middles(self.xs.len()).map(move |i| (j, i))) {
            let Some(value) = values[j][i] else { continue };
            let (x, z) = (self.xs[i], self.zs[j]);
            let side = if x < 0.0 { "left" } else { "right" };
            let words = format!(
                "{} mm {side}, {} mm deep: {} mm",
                significant(x.abs(), 3),
                significant(z, 3),
                significant(value, 3)
            );
            cells.push(([x, z], words));
        }
        let step = |at: &[f64]| BLOCK as f64 * (at[1] - at[0]);
        Cells { size: [step(&self.xs), step(&self.zs)], cells }
    }
}

/// Numbers at equal distances.
fn spread(count: usize, low: f64, high: f64) -> Vec<f64> {
    (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()
}

/// Ranges of both axes that hold the slice and the devices.
fn reach([left, right]: [f64; 2], deepest: f64, rig: &Rig) -> [[f64; 2]; 2] {
    let room = 0.08 * deepest;
    let projector = rig.projector.as_ref().map_or(Point3::origin(), |p| p.from_camera.pose.centre());
    let x = [left.min(projector.x - room), right.max(projector.x + room)];
    [x, [(-room).min(projector.z - room), deepest.max(projector.z + room)]]
}

/// Camera, projector and sheets from above.
fn landmarks(mut plot: Plot, rig: &Rig) -> Plot {
    for (i, view) in rig.views.iter().enumerate() {
        let corner = |x: f64, y: f64| view.camera_from_sheet.transform(&Point3::new(x, y, 0.0));
        let (w, h) = (view.size.width_mm, view.size.height_mm);
        // Its middle line: what the slice cuts, nearly.
        let ends = [corner(0.0, h / 2.0), corner(w, h / 2.0)].map(|p| [p.x, p.z]);
        plot = plot.with(Colour::Ink, Segment { ends, name: photo_name(rig, i).to_owned() });
    }
    let projector = rig.projector.as_ref().map(|p| p.from_camera.pose.centre());
    // Names stand apart from each other.
    let name_at_left = projector.is_none_or(|p| p.x >= 0.0);
    let camera = NamedPlace { at: [0.0; 2], symbol: Symbol::Square, name: "camera", name_at_left };
    plot = plot.with(Colour::Camera, camera);
    let Some(p) = projector else { return plot };
    let place = NamedPlace {
        at: [p.x, p.z],
        symbol: Symbol::Diamond,
        name: "projector",
        name_at_left: !name_at_left,
    };
    plot.with(Colour::Projector, place)
}
