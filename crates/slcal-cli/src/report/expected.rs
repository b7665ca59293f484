//! How sure a point would be over the working volume: a slice seen from above, and along the depth.

use maud::{Markup, html};
use nalgebra::{Point2, Point3};
use serde_json::{Value, json};
use slcal_core::geometry::Camera;
use slcal_core::pattern::Axis;
use slcal_core::reconstruct::SigmaForecast;
use slcal_core::{Match, Rig};

use super::Subject;
use super::figure::{Choice, Figures, flat_layout};
use super::number::significant;
use super::page::Section;
use super::verdict::sheet_distance_mm;

/// The slice reaches from and to these shares of the sheet's distance.
const NEAREST: f64 = 0.4;
const FARTHEST: f64 = 2.2;
/// Points of the slice.
const COLUMNS: usize = 61;
const ROWS: usize = 46;
/// Points of the curve.
const DEPTHS: usize = 91;

pub(super) fn section(subject: &Subject, figures: &mut Figures) -> Option<Section> {
    let rig = subject.rig;
    rig.projector?;
    let content = match Volume::new(rig) {
        Some(mut volume) => html! {
            p {
                "How far a single point is expected to lie from its true place, along the camera’s line of sight (1σ), if the centre of \
                 a stripe is found to " (Match::DEFAULT_SIGMA_PX) " px. Most of the total is common to all points: it moves and scales \
                 them together. What differs from point to point, and makes a surface rough, is the noise."
            }
            @if !volume.knows_rig { p.note { "The rig has no covariance: what is not known of the rig itself is not in these numbers." } }
            div.pair { (volume.slice(rig, figures)) (volume.depths(figures)) }
        },
        None => {
            html! { p.note { "Not shown: camera and projector of this rig do not see a place together." } }
        }
    };
    Some(Section { id: "expected", title: "How sure a point will be", content })
}

/// Where σ is foretold.
struct Volume {
    forecast: SigmaForecast,
    /// Which row of the image the slice goes through, as a direction: y/z.
    slope: f64,
    /// The pixel of the curve.
    pixel: Point2<f64>,
    distance_mm: f64,
    /// Whether that is the sheet's.
    of_sheet: bool,
    knows_rig: bool,
}

impl Volume {
    /// `None` where nothing is lit at the working distance.
    fn new(rig: &Rig) -> Option<Self> {
        let mut forecast = SigmaForecast::new(rig, Axis::Columns, Match::DEFAULT_SIGMA_PX).ok()?;
        let model = &rig.camera.model;
        let middle = rig.views.first().map(|v| {
            v.camera_from_sheet.transform(&Point3::new(v.size.width_mm / 2.0, v.size.height_mm / 2.0, 0.0))
        });
        let centre = Camera::image_centre(model.width, model.height);
        let mut lit = |(pixel, depth): &(Point2<f64>, f64)| forecast.at(*pixel, *depth).is_some();
        let (pixel, depth) = if let Some(m) = middle {
            model.project(&m).into_iter().chain([centre]).map(|p| (p, m.z)).find(&mut lit)?
        } else {
            // Devices side by side overlap from some distance on.
            let baseline = rig.baseline_mm()?;
            [3.0, 6.0, 12.0, 24.0].map(|times| (centre, times * baseline)).into_iter().find(&mut lit)?
        };
        let bearing = model.bearing(pixel)?;
        let distance_mm = if middle.is_some() { sheet_distance_mm(rig) } else { depth };
        Some(Self {
            forecast,
            slope: bearing.y,
            pixel,
            distance_mm,
            of_sheet: middle.is_some(),
            knows_rig: rig.covariance.is_some(),
        })
    }

    /// σ in a plane through the camera, seen from above.
    fn slice(&mut self, rig: &Rig, figures: &mut Figures) -> Markup {
        let model = &rig.camera.model;
        let [w, h] = [model.width, model.height].map(f64::from);
        let half = FARTHEST * self.distance_mm * (w / 2.0) / model.intrinsics.fx;
        let at = |i: usize, n: usize, low: f64, high: f64| low + (high - low) * i as f64 / (n - 1) as f64;
        let xs: Vec<f64> = (0..COLUMNS).map(|i| at(i, COLUMNS, -half, half)).collect();
        let zs: Vec<f64> = (0..ROWS).map(|i| at(i, ROWS, NEAREST, FARTHEST) * self.distance_mm).collect();
        let (mut total, mut noise) = (Vec::new(), Vec::new());
        for z in &zs {
            let row: Vec<_> = xs
                .iter()
                .map(|x| {
                    let pixel = model.project(&Point3::new(*x, self.slope * z, *z))?;
                    let inside = (-0.5..=w - 0.5).contains(&pixel.x) && (-0.5..=h - 0.5).contains(&pixel.y);
                    if inside { self.forecast.at(pixel, *z) } else { None }
                })
                .collect();
            total.push(row.iter().map(|s| s.map(|s| shortened(s.sigma_mm))).collect::<Vec<_>>());
            noise.push(row.iter().map(|s| s.map(|s| shortened(s.noise_mm))).collect::<Vec<_>>());
        }
        let colours = |values: &[Vec<Option<f64>>]| contours(values);
        let choices = if self.knows_rig {
            vec![choice("total", &total, &colours(&total)), choice("noise alone", &noise, &colours(&noise))]
        } else {
            Vec::new()
        };
        let range = colours(&total);
        let mut traces = vec![json!({
            "type": "contour", "x": xs.iter().map(|x| x.round()).collect::<Vec<_>>(), "y": zs.iter().map(|z| z.round()).collect::<Vec<_>>(),
            "z": total, "colorscale": "Cividis", "reversescale": true, "connectgaps": false, "name": "σ",
            "autocontour": false, "ncontours": 12, "line": { "color": "rgba(0,0,0,0.55)", "width": 0.75 },
            "contours": { "showlabels": true, "labelfont": { "size": 11, "color": "#000000" },
                "start": range[0], "end": range[1], "size": range[2] },
            "zmin": range[0], "zmax": range[1],
            "colorbar": { "title": { "text": "σ, mm" }, "thickness": 12, "outlinewidth": 0, "tickcolor": "$line" },
            "hovertemplate": "%{x:.0f} mm right, %{y:.0f} mm deep: %{z:.3g} mm<extra></extra>",
        })];
        traces.extend(landmarks(rig));
        let depths = [-0.08 * FARTHEST * self.distance_mm, FARTHEST * self.distance_mm];
        let layout = flat_layout(
            json!({ "title": { "text": "to the right of the camera, mm" }, "zeroline": false, "constrain": "domain", "range": [-half, half] }),
            json!({ "title": { "text": "depth, mm" }, "zeroline": false, "constrain": "domain", "range": depths, "scaleanchor": "x" }),
        );
        let alt = "Expected σ of a point over a slice of the working volume, seen from above; it grows with the depth.";
        html! {
            figure {
                (figures.chosen("expected-slice", alt, traces, layout, "Which error", choices))
                figcaption {
                    "Seen from above: camera and projector at the bottom, in colour what both reach, the sheet as a black line. The lighter, \
                     the surer; lines join places of the same σ."
                }
            }
        }
    }

    /// σ along the line of sight through the sheet's middle.
    fn depths(&mut self, figures: &mut Figures) -> Markup {
        let depth =
            |i: usize| (NEAREST + (FARTHEST - NEAREST) * i as f64 / (DEPTHS - 1) as f64) * self.distance_mm;
        let zs: Vec<f64> = (0..DEPTHS).map(depth).collect();
        let all: Vec<_> = zs.iter().map(|z| self.forecast.at(self.pixel, *z)).collect();
        let curve = |name: &str,
                     colour: &str,
                     dash: &str,
                     of: fn(&slcal_core::reconstruct::ExpectedSigma) -> f64| {
            json!({
                "type": "scatter", "mode": "lines", "name": name, "x": zs.iter().map(|z| z.round()).collect::<Vec<_>>(),
                "y": all.iter().map(|s| s.as_ref().map(|s| shortened(of(s)))).collect::<Vec<_>>(),
                "line": { "color": colour, "width": 2.5, "dash": dash },
                "hovertemplate": "%{x:.0f} mm: %{y:.3g} mm<extra>%{fullData.name}</extra>",
            })
        };
        let mut traces = Vec::new();
        if self.knows_rig {
            traces.push(curve("total", "$camera", "solid", |s| s.sigma_mm));
        }
        traces.push(curve("noise alone", "$noise", "dash", |s| s.noise_mm));
        // Two digits per power of ten: plotly's own labels leave the power out.
        let values = || all.iter().flatten().flat_map(|s| [s.noise_mm, s.sigma_mm]).filter(|x| *x > 0.0);
        let (low, high) = values().fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        let powers =
            if low <= high { low.log10().floor() as i32..=high.log10().floor() as i32 } else { 0..=0 };
        let ticks: Vec<f64> =
            powers.take(12).flat_map(|p| [1.0, 2.0, 5.0].map(|d| d * 10f64.powi(p))).collect();
        let named: Vec<String> = ticks.iter().map(|t| significant(*t, 1)).collect();
        let mut layout = flat_layout(
            json!({ "title": { "text": "depth, mm" } }),
            json!({ "title": { "text": "σ, mm" }, "type": "log", "tickvals": ticks, "ticktext": named }),
        );
        if self.of_sheet {
            layout["shapes"] = json!([{
                "type": "line", "xref": "x", "yref": "paper", "x0": self.distance_mm, "x1": self.distance_mm, "y0": 0, "y1": 1,
                "line": { "color": "$sheet", "width": 1.5, "dash": "dot" },
            }]);
            layout["annotations"] = json!([{
                "x": self.distance_mm, "y": 1, "xref": "x", "yref": "paper", "text": "the sheet", "showarrow": false,
                "xanchor": "left", "yanchor": "top", "font": { "color": "$ink" }, "xshift": 4,
            }]);
        }
        let at = self.forecast.at(self.pixel, self.distance_mm);
        html! {
            figure {
                (figures.flat("expected-depth", "Expected σ of a point against its depth, total and noise alone.", traces, layout))
                figcaption {
                    "Along the line of sight through the middle of the sheet."
                    @if let Some(at) = at {
                        " At " (format!("{:.0}", self.distance_mm)) " mm: " (significant(at.sigma_mm, 2)) " mm, of which "
                        (significant(at.noise_mm, 2)) " mm are noise."
                    }
                }
            }
        }
    }
}

/// Three digits are enough to draw.
fn shortened(x: f64) -> f64 {
    significant(x, 3).parse().unwrap_or(x)
}

fn choice(label: &'static str, values: &[Vec<Option<f64>>], [start, end, size]: &[f64; 3]) -> Choice {
    let change = json!({
        "z": values, "zmin": start, "zmax": end, "contours.start": start, "contours.end": end, "contours.size": size,
    });
    Choice { label, traces: vec![0], change }
}

/// First, last and distance of the contours: round numbers over nearly all values.
fn contours(values: &[Vec<Option<f64>>]) -> [f64; 3] {
    let mut all: Vec<f64> = values.iter().flatten().flatten().copied().filter(|x| x.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (all.first(), all.get(all.len() * 97 / 100)) else {
        return [0.0, 1.0, 0.1];
    };
    let rough = ((high - low) / 9.0).max(high * 1e-3).max(1e-9);
    let power = 10f64.powf(rough.log10().floor());
    let size =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|d| d * power).find(|s| *s >= rough * 0.999).unwrap_or(rough);
    [(low / size).floor() * size, (high / size).ceil() * size, size]
}

/// Camera, projector and sheets from above.
fn landmarks(rig: &Rig) -> Vec<Value> {
    let projector = rig.stereo.as_ref().map(|s| s.projector_from_camera.centre());
    // Names stand apart from each other.
    let sides = if projector.is_some_and(|p| p.x < 0.0) { ["right", "left"] } else { ["left", "right"] };
    let marks = [
        Some(("camera", "$camera", "square", sides[0], Point3::origin())),
        projector.map(|p| ("projector", "$projector", "diamond", sides[1], p)),
    ];
    let mut traces: Vec<Value> = marks
        .into_iter()
        .flatten()
        .map(|(name, colour, symbol, side, p)| {
            json!({
                "type": "scatter", "mode": "markers+text", "x": [p.x], "y": [p.z], "text": [name],
                "textposition": format!("middle {side}"), "marker": { "color": colour, "size": 10, "symbol": symbol },
                "textfont": { "color": colour }, "showlegend": false, "hoverinfo": "text", "cliponaxis": false,
            })
        })
        .collect();
    for view in &rig.views {
        let corner = |x: f64, y: f64| view.camera_from_sheet.transform(&Point3::new(x, y, 0.0));
        let (w, h) = (view.size.width_mm, view.size.height_mm);
        // Its middle line: what the slice cuts, nearly.
        let ends = [corner(0.0, h / 2.0), corner(w, h / 2.0)];
        traces.push(json!({
            "type": "scatter", "mode": "lines", "x": ends.map(|p| p.x.round()), "y": ends.map(|p| p.z.round()), "name": "sheet",
            "line": { "color": "#ffffff", "width": 5 }, "showlegend": false, "hoverinfo": "skip",
        }));
        traces.push(json!({
            "type": "scatter", "mode": "lines", "x": ends.map(|p| p.x.round()), "y": ends.map(|p| p.z.round()), "name": "sheet",
            "line": { "color": "#000000", "width": 2.5 }, "showlegend": false, "hoverinfo": "name",
        }));
    }
    traces
}
