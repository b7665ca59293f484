//! The expected uncertainty of points over the working volume: a slice seen from above, and a curve over the depth.

use maud::{Markup, html};
use nalgebra::{Point2, Point3};
use serde_json::{Value, json};
use slcal_core::reconstruct::ExpectedSigma;
use slcal_core::{Match, Rig};

use super::figure::{Choice, Figures, flat_layout};
use super::number::significant;
use super::page::Section;
use super::rig_page::RigPage;
use crate::picture::vector_scale::round_up;
use crate::quantile::Sorted;
use crate::summary::working_volume::{WorkingVolume, slopes, stripes};

/// The slice reaches from and to these shares of the sheet's distance.
const NEAREST: f64 = 0.4;
const FARTHEST: f64 = 2.2;
/// Points of the slice.
const COLUMNS: usize = 61;
const ROWS: usize = 46;
/// Points of the curve.
const DEPTHS: usize = 91;

/// The section with both plots.
pub(super) fn section(
    page: &RigPage,
    working: slcal_core::Result<Option<WorkingVolume>>,
    figures: &mut Figures,
) -> Option<Section> {
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
            div.pair { (working.slice(rig, figures)) (working.depths(figures)) }
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

/// The plots.
impl WorkingVolume {
    /// σ seen from above.
    fn slice(&mut self, rig: &Rig, figures: &mut Figures) -> Markup {
        let model = &rig.camera.model;
        let deepest = FARTHEST * self.distance_mm;
        // To both edges of the image, which need not be alike.
        let [left, right] = [-0.5, f64::from(model.width) - 0.5].map(|x| {
            let level = model.bearing(Point2::new(x, (f64::from(model.height) - 1.0) / 2.0));
            deepest * level.map_or((x - model.intrinsics.cx) / model.intrinsics.fx, |b| b.x)
        });
        let at = |i: usize, n: usize, low: f64, high: f64| low + (high - low) * i as f64 / (n - 1) as f64;
        let xs: Vec<f64> = (0..COLUMNS).map(|i| at(i, COLUMNS, left, right)).collect();
        let zs: Vec<f64> = (0..ROWS).map(|i| at(i, ROWS, NEAREST, FARTHEST) * self.distance_mm).collect();
        let slopes = slopes(model);
        let (mut total, mut noise) = (Vec::new(), Vec::new());
        for z in &zs {
            let row: Vec<_> = xs.iter().map(|x| self.seen_from_above(model, &slopes, *x, *z)).collect();
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
            "type": "contour", "x": self.drawn(&xs), "y": self.drawn(&zs),
            "z": total, "colorscale": "Cividis", "reversescale": true, "connectgaps": false, "name": "σ",
            "autocontour": false, "ncontours": 12, "line": { "color": "rgba(0,0,0,0.55)", "width": 0.75 },
            "contours": { "showlabels": true, "labelfont": { "size": 11, "color": "#000000" },
                "start": range[0], "end": range[1], "size": range[2] },
            "zmin": range[0], "zmax": range[1],
            "colorbar": { "title": { "text": "σ, mm" }, "thickness": 12, "outlinewidth": 0, "tickcolor": "$line" },
            "hovertemplate": "%{x:.4~r} mm right, %{y:.4~r} mm deep: %{z:.3~r} mm<extra></extra>",
        })];
        traces.extend(self.landmarks(rig));
        let depths = [-0.08 * deepest, deepest];
        let layout = flat_layout(
            json!({ "title": { "text": "to the right of the camera, mm" }, "zeroline": false, "constrain": "domain", "range": [left, right] }),
            json!({ "title": { "text": "depth, mm" }, "zeroline": false, "constrain": "domain", "range": depths, "scaleanchor": "x" }),
        );
        let alt =
            "Expected σ of a point over a slice of the working volume, seen from above; it grows with depth.";
        html! {
            figure {
                (figures.chosen("expected-slice", alt, traces, layout, "Which error", choices))
                figcaption {
                    "Seen from above: camera and projector at the bottom, and in colour where their fields of view overlap at some height"
                    @if !rig.views.is_empty() { ", " @if rig.views.len() == 1 { "the sheet as a black line" } @else { "the sheets as black lines" } }
                    ". Each σ is for the lit image row nearest to the middle. Lighter is more certain; lines connect equal σ."
                }
            }
        }
    }

    /// σ along the line of sight through the middle of the sheet, or another place.
    fn depths(&mut self, figures: &mut Figures) -> Markup {
        let depth =
            |i: usize| (NEAREST + (FARTHEST - NEAREST) * i as f64 / (DEPTHS - 1) as f64) * self.distance_mm;
        let zs: Vec<f64> = (0..DEPTHS).map(depth).collect();
        let all: Vec<_> = zs.iter().map(|z| self.at_depth(*z)).collect();
        let curve = |name: &str, colour: &str, dash: &str, of: fn(&ExpectedSigma) -> f64| {
            json!({
                "type": "scatter", "mode": "lines", "name": name, "x": self.drawn(&zs),
                "y": all.iter().map(|s| s.as_ref().map(|s| shortened(of(s)))).collect::<Vec<_>>(),
                "line": { "color": colour, "width": 2.5, "dash": dash },
                "hovertemplate": "%{x:.4~r} mm: %{y:.3~r} mm<extra>%{fullData.name}</extra>",
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
        html! {
            figure {
                (figures.flat("expected-depth", "Expected σ of a point against its depth, total and noise alone.", traces, layout))
                figcaption {
                    "Along the line of sight through "
                    (self.place_in_words())
                    ". At a depth of " (significant(self.distance_mm, 4)) " mm: " (significant(self.sigma.sigma_mm, 2)) " mm"
                    @if self.knows_rig { ", of which " (significant(self.sigma.noise_mm, 2)) " mm are noise." } @else { " of noise." }
                }
            }
        }
    }

    /// Places as they are drawn: what counts at the scale of the working distance, however small that is.
    fn drawn(&self, places: &[f64]) -> Vec<f64> {
        places.iter().map(|x| rounded(*x, self.distance_mm)).collect()
    }

    /// Camera, projector and sheets from above.
    fn landmarks(&self, rig: &Rig) -> Vec<Value> {
        let projector = rig.projector.as_ref().map(|p| p.from_camera.pose.centre());
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
                "type": "scatter", "mode": "lines", "x": self.drawn(&ends.map(|p| p.x)), "y": self.drawn(&ends.map(|p| p.z)), "name": "sheet",
                "line": { "color": "#ffffff", "width": 5 }, "showlegend": false, "hoverinfo": "skip",
            }));
            traces.push(json!({
                "type": "scatter", "mode": "lines", "x": self.drawn(&ends.map(|p| p.x)), "y": self.drawn(&ends.map(|p| p.z)), "name": "sheet",
                "line": { "color": "#000000", "width": 2.5 }, "showlegend": false, "hoverinfo": "name",
            }));
        }
        traces
    }
}

/// To five digits of `scale`.
fn rounded(x: f64, scale: f64) -> f64 {
    let decimals = 4.0 - scale.abs().log10().floor();
    if !decimals.is_finite() {
        return x;
    }
    // A power below one would leave digits behind.
    let power = 10f64.powf(decimals.abs());
    if decimals >= 0.0 { (x * power).round() / power } else { (x / power).round() * power }
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
    let all = Sorted::new(values.iter().flatten().flatten().copied());
    let (Some(low), Some(high)) = (all.at(0.0), all.at(0.97)) else {
        return [0.0, 1.0, 0.1];
    };
    let size = round_up(0.999 * ((high - low) / 9.0).max(high * 1e-3).max(1e-9));
    [(low / size).floor() * size, (high / size).ceil() * size, size]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_keep_the_digits_that_count() {
        assert_eq!(rounded(1.234_567, 30.0), 1.235);
        assert_eq!(rounded(-1.234_567, 1100.0), -1.2);
        assert_eq!(rounded(123_456.0, 1e6), 123_500.0);
        assert_eq!(rounded(0.3, 0.0), 0.3);
    }
}
