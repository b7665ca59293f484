//! Conversion of observations to text, one line per point, so that it is easy to read and edit.

use std::fmt::Write as _;

use serde_json::Value;

use super::schema::{SCHEMA, SIDES};
use crate::channel_registration::RedBlue;
use crate::error::{Error, Result};
use crate::observations::{ChannelOffset, Observations, PanelPoint, SheetObservation, ViewObservation};

/// A list of numbers.
fn row(numbers: &[f64], sigma: Option<f64>) -> Result<String> {
    optional_row(numbers.iter().copied().chain(sigma).map(Some))
}

/// A list of numbers or null. JSON has no NaN, so NaN is refused here.
fn optional_row(numbers: impl Iterator<Item = Option<f64>>) -> Result<String> {
    let text = |x: Option<f64>| match x {
        Some(bad) if !bad.is_finite() => Err(Error::invalid("observations to write", "finite numbers", bad)),
        x => Ok(Value::from(x).to_string()),
    };
    Ok(format!("[{}]", numbers.map(text).collect::<Result<Vec<_>>>()?.join(", ")))
}

/// Rows below each other, indented by `indent` spaces.
fn list(rows: impl Iterator<Item = Result<String>>, indent: usize) -> Result<String> {
    let rows = rows.collect::<Result<Vec<String>>>()?;
    if rows.is_empty() {
        return Ok("[]".into());
    }
    let pad = " ".repeat(indent);
    Ok(format!("[\n{pad}  {}\n{pad}]", rows.join(&format!(",\n{pad}  "))))
}

fn panel(size: Option<[u32; 2]>, mirrored: bool) -> String {
    let mirrored = if mirrored { ", \"mirrored\": true" } else { "" };
    size.map_or("null".into(), |[w, h]| format!("{{\"width\": {w}, \"height\": {h}{mirrored}}}"))
}

pub(super) fn text(o: &Observations) -> Result<String> {
    let views = o.views.iter().map(view).collect::<Result<Vec<_>>>()?;
    Ok(format!(
        "{{\n  \"schema\": \"{SCHEMA}\",\n  \"camera\": {},\n  \"projector\": {},\n  \"views\": [{}]\n}}\n",
        panel(Some(o.camera), false),
        panel(o.projector, o.mirrored),
        views.join(", ")
    ))
}

fn view(view: &ViewObservation) -> Result<String> {
    let mut text = String::from("{\n");
    if let Some(photo) = &view.photo {
        let _ = writeln!(text, "    \"photo\": {},", Value::from(photo.as_str()));
    }
    let _ = writeln!(text, "    \"size_mm\": {},", row(&[view.size.width_mm, view.size.height_mm], None)?);
    match &view.sheet {
        SheetObservation::Corners { corners, sigma_px } => {
            let rows = list(corners.iter().map(|c| row(&[c.x, c.y], None)), 4)?;
            let _ = writeln!(text, "    \"sheet_corners_px\": {rows},");
            if let Some(sigma) = sigma_px {
                let _ = writeln!(text, "    \"sheet_sigma_px\": {},", Value::from(*sigma));
            }
        }
        SheetObservation::Edges(sides) => {
            let mut fields = Vec::new();
            for (name, points) in SIDES.iter().zip(sides) {
                let rows = points.iter().map(|p| row(&[p.position.x, p.position.y], p.sigma_px));
                fields.push(format!("      \"{name}\": {}", list(rows, 6)?));
            }
            let _ = writeln!(text, "    \"sheet_edges_px\": {{\n{}\n    }},", fields.join(",\n"));
        }
    }
    let rows =
        view.pairs.iter().map(|p| row(&[p.camera.x, p.camera.y, p.projector.x, p.projector.y], p.sigma_px));
    let _ = write!(text, "    \"pairs\": {}", list(rows, 4)?);
    if !view.panel_points.is_empty() {
        let rows = view.panel_points.iter().map(panel_point);
        let _ = write!(text, ",\n    \"panel_points\": {}", list(rows, 4)?);
    }
    if !view.channel_offsets.is_empty() {
        let rows = view.channel_offsets.iter().map(|o| row(&channel_offset(o), None));
        let _ = write!(text, ",\n    \"channel_offsets\": {}", list(rows, 4)?);
    }
    text.push_str("\n  }");
    Ok(text)
}

/// Camera x and y, panel x and y, red x and y, blue x and y, σ of red, σ of blue.
fn channel_offset(o: &ChannelOffset) -> [f64; 10] {
    let RedBlue { red, blue } = o.offset_px;
    let (c, p, s) = (o.camera, o.projector, o.sigma_px);
    [c.x, c.y, p.x, p.y, red.x, red.y, blue.x, blue.y, s.red, s.blue]
}

/// Camera x and y, panel x and y or null, and σ where it is known.
fn panel_point(point: &PanelPoint) -> Result<String> {
    let measured = [point.camera.x, point.camera.y].map(Some);
    let sigma = point.sigma_px.map(Some);
    optional_row(measured.into_iter().chain(point.expected).chain(sigma))
}
