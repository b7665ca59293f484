//! Conversion of the file's fields to observations, with checks.

use nalgebra::{Point2, Vector2};
use serde_json::{Map, Value};

use super::schema::{SCHEMA, SIDES, malformed};
use crate::channel_registration::RedBlue;
use crate::error::Result;
use crate::geometry::RectangleSize;
use crate::observations::{
    ChannelOffset, CornerPair, EdgePoint, Observations, PanelPoint, SheetObservation, ViewObservation,
};

const MAX_COORDINATE_PX: f64 = ViewObservation::MAX_COORDINATE_PX;
const SIGMA_RANGE_PX: std::ops::RangeInclusive<f64> = ViewObservation::SIGMA_RANGE_PX;
const SIDE_RANGE_MM: std::ops::RangeInclusive<f64> = ViewObservation::SIDE_RANGE_MM;

/// A value in messages: its text, shortened.
fn shown(value: &Value) -> String {
    const LONGEST: usize = 60;
    match value {
        Value::Array(a) => format!("an array of {}", a.len()),
        Value::Object(_) => "an object".into(),
        other => {
            let text = other.to_string();
            if text.chars().count() <= LONGEST {
                return text;
            }
            text.chars().take(LONGEST).chain("…".chars()).collect()
        }
    }
}

fn wrong(place: &str, expected: &str, found: &Value) -> crate::Error {
    malformed(format!("{place}: expected {expected}, found {}", shown(found)))
}

fn object<'a>(value: &'a Value, place: &str, expected: &str) -> Result<&'a Map<String, Value>> {
    value.as_object().ok_or_else(|| wrong(place, expected, value))
}

fn required<'a>(from: &'a Map<String, Value>, field: &str, place: &str, expected: &str) -> Result<&'a Value> {
    from.get(field).ok_or_else(|| malformed(format!("{place}missing field `{field}`, expected {expected}")))
}

pub(super) fn observations(value: &Value) -> Result<Observations> {
    let top = object(value, "the file", &format!("an object with \"schema\": \"{SCHEMA}\""))?;
    let schema = required(top, "schema", "", &format!("\"{SCHEMA}\""))?;
    if schema.as_str() != Some(SCHEMA) {
        return Err(wrong("schema", &format!("\"{SCHEMA}\""), schema));
    }
    let camera = panel(required(top, "camera", "", "{\"width\", \"height\"}")?, "camera")?;
    let expected = "{\"width\", \"height\"}, or null to calibrate the camera alone";
    let given = required(top, "projector", "", expected)?;
    let projector = if given.is_null() { None } else { Some(panel(given, "projector")?) };
    let mirrored = match given.get("mirrored") {
        None | Some(Value::Null) => false,
        Some(Value::Bool(mirrored)) => *mirrored,
        Some(other) => return Err(wrong("projector.mirrored", "true or false", other)),
    };
    let list = required(top, "views", "", "a list with one entry per pose of the sheet")?;
    let list = list.as_array().ok_or_else(|| wrong("views", "a list", list))?;
    let mut views = Vec::with_capacity(list.len());
    for (i, value) in list.iter().enumerate() {
        let place = format!("views[{i}]");
        views.push(view(object(value, &place, "an object")?, &place, projector.is_some())?);
    }
    Ok(Observations { camera, projector, mirrored, views })
}

fn panel(value: &Value, place: &str) -> Result<[u32; 2]> {
    let fields = object(value, place, "{\"width\", \"height\"}")?;
    let side = |name: &str| {
        let expected = "a whole number of pixels above zero";
        let value = required(fields, name, &format!("{place}: "), expected)?;
        let number = value.as_u64().and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0);
        number.ok_or_else(|| wrong(&format!("{place}.{name}"), expected, value))
    };
    Ok([side("width")?, side("height")?])
}

fn view(fields: &Map<String, Value>, place: &str, with_pairs: bool) -> Result<ViewObservation> {
    let dot = format!("{place}: ");
    let photo = match fields.get("photo") {
        None | Some(Value::Null) => None,
        Some(Value::String(name)) => Some(name.clone()),
        Some(other) => return Err(wrong(&format!("{place}.photo"), "a name", other)),
    };
    let sides = numbers(
        required(fields, "size_mm", &dot, "[width, height]")?,
        &format!("{place}.size_mm"),
        "[width, height]",
    )?;
    let &[w, h] = sides.as_slice() else {
        return Err(wrong(&format!("{place}.size_mm"), "[width, height]", &fields["size_mm"]));
    };
    if ![w, h].iter().all(|s| SIDE_RANGE_MM.contains(s)) {
        return Err(malformed(format!(
            "{place}.size_mm: expected lengths from 1 mm to 100 m, in millimetres, found [{w}, {h}]"
        )));
    }
    let size = RectangleSize::new(w, h)?;
    let sheet_sigma = sigma_of(fields, "sheet_sigma_px", place)?;
    let sheet = match (fields.get("sheet_corners_px"), fields.get("sheet_edges_px")) {
        (Some(corners), None) => sheet_corners(corners, sheet_sigma, &format!("{place}.sheet_corners_px"))?,
        (None, Some(edges)) => sheet_edges(edges, sheet_sigma, &format!("{place}.sheet_edges_px"))?,
        (found, _) => {
            let found = if found.is_some() { "both" } else { "neither" };
            return Err(malformed(format!(
                "{place}: expected either `sheet_corners_px` or `sheet_edges_px`, found {found}"
            )));
        }
    };
    let pair_sigma = sigma_of(fields, "pair_sigma_px", place)?;
    let pairs = match fields.get("pairs") {
        Some(value) => pairs(value, pair_sigma, &format!("{place}.pairs"))?,
        None if with_pairs => {
            return Err(malformed(format!(
                "{place}: missing field `pairs`, expected [[camera_x, camera_y, projector_x, projector_y], …] as there is a projector"
            )));
        }
        None => Vec::new(),
    };
    let panel_points = fields
        .get("panel_points")
        .map_or(Ok(Vec::new()), |value| panel_points(value, &format!("{place}.panel_points")))?;
    let channel_offsets = fields
        .get("channel_offsets")
        .map_or(Ok(Vec::new()), |value| channel_offsets(value, &format!("{place}.channel_offsets")))?;
    Ok(ViewObservation { photo, size, sheet, pairs, panel_points, channel_offsets })
}

fn sigma_of(fields: &Map<String, Value>, name: &str, place: &str) -> Result<Option<f64>> {
    match fields.get(name) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => {
            let sigma = value.as_f64().filter(|s| SIGMA_RANGE_PX.contains(s));
            let expected = "a positive number of pixels (1σ)";
            Ok(Some(sigma.ok_or_else(|| wrong(&format!("{place}.{name}"), expected, value))?))
        }
    }
}

/// Numbers of a row, each finite and in the range of pixel coordinates.
fn numbers(value: &Value, place: &str, expected: &str) -> Result<Vec<f64>> {
    let row = value.as_array().ok_or_else(|| wrong(place, expected, value))?;
    let number = |(k, v): (usize, &Value)| {
        v.as_f64()
            .filter(|x| x.abs() <= MAX_COORDINATE_PX)
            .ok_or_else(|| wrong(&format!("{place}[{k}]"), "a finite number up to 1e9", v))
    };
    row.iter().enumerate().map(number).collect()
}

/// Rows of `N` coordinates, with σ as an additional number in every row or in none: the coordinates and the σ.
fn rows<const N: usize>(value: &Value, place: &str, expected: &str) -> Result<Vec<([f64; N], Option<f64>)>> {
    let list = value.as_array().ok_or_else(|| wrong(place, &format!("a list of {expected}"), value))?;
    let mut rows = Vec::with_capacity(list.len());
    for (i, value) in list.iter().enumerate() {
        let place = || format!("{place}[{i}]");
        let row = numbers(value, &place(), expected)?;
        let (coordinates, rest) =
            row.split_first_chunk::<N>().ok_or_else(|| wrong(&place(), expected, value))?;
        let sigma = match rest {
            [] => None,
            [sigma] if SIGMA_RANGE_PX.contains(sigma) => Some(*sigma),
            [sigma] => {
                return Err(malformed(format!(
                    "{}: expected a positive σ in pixels as its last number, found {sigma}",
                    place()
                )));
            }
            _ => return Err(wrong(&place(), expected, value)),
        };
        rows.push((*coordinates, sigma));
    }
    let without = rows.iter().position(|r| r.1.is_none());
    if let (Some(without), Some(with)) = (without, rows.iter().position(|r| r.1.is_some())) {
        return Err(malformed(format!(
            "{place}: expected σ as the last number of every row or of none, found it in [{with}] and not in [{without}]"
        )));
    }
    Ok(rows)
}

fn sheet_corners(value: &Value, of_view: Option<f64>, place: &str) -> Result<SheetObservation> {
    const EXPECTED: &str = "[x, y]";
    let rows = rows::<2>(value, place, EXPECTED)?;
    let &[a, b, c, d] = rows.as_slice() else {
        return Err(malformed(format!(
            "{place}: expected four corners TL, TR, BR, BL, found {}",
            rows.len()
        )));
    };
    if a.1.is_some() {
        return Err(malformed(format!(
            "{place}: expected {EXPECTED} for each corner, found σ as a third number; state one for all four as `sheet_sigma_px`"
        )));
    }
    let corners = [a, b, c, d].map(|(xy, _)| Point2::from(xy));
    Ok(SheetObservation::Corners { corners, sigma_px: of_view })
}

fn sheet_edges(value: &Value, of_view: Option<f64>, place: &str) -> Result<SheetObservation> {
    let fields = object(value, place, "an object with top, right, bottom and left")?;
    let mut sides: [Vec<EdgePoint>; 4] = Default::default();
    let mut own = [false; 4];
    for ((points, own), name) in sides.iter_mut().zip(&mut own).zip(SIDES) {
        let expected = "[x, y] or [x, y, σ]";
        let list = required(fields, name, &format!("{place}: "), &format!("a list of {expected}"))?;
        let rows = rows::<2>(list, &format!("{place}.{name}"), expected)?;
        *own = rows.first().is_some_and(|r| r.1.is_some());
        points.extend(
            rows.into_iter()
                .map(|(xy, sigma)| EdgePoint { position: Point2::from(xy), sigma_px: sigma.or(of_view) }),
        );
    }
    let filled = || own.iter().zip(&sides).filter(|(_, s)| !s.is_empty());
    if of_view.is_none() && filled().any(|(own, _)| *own) && !filled().all(|(own, _)| *own) {
        return Err(malformed(format!(
            "{place}: expected σ for the points of every side or of none, found it on some sides only; state one for the rest \
             as `sheet_sigma_px`"
        )));
    }
    Ok(SheetObservation::Edges(sides))
}

fn pairs(value: &Value, of_view: Option<f64>, place: &str) -> Result<Vec<CornerPair>> {
    let expected =
        "[camera_x, camera_y, projector_x, projector_y], or with σ of the camera's pixel behind them";
    let rows = rows::<4>(value, place, expected)?;
    let pair = |([cx, cy, px, py], sigma): ([f64; 4], Option<f64>)| CornerPair {
        camera: Point2::new(cx, cy),
        projector: Point2::new(px, py),
        sigma_px: sigma.or(of_view),
    };
    Ok(rows.into_iter().map(pair).collect())
}

/// Rows of camera x and y, panel x and y of which one may be null, and σ where it is known.
fn panel_points(value: &Value, place: &str) -> Result<Vec<PanelPoint>> {
    let expected = "[camera_x, camera_y, panel_x or null, panel_y or null], or with σ behind them";
    let list = value.as_array().ok_or_else(|| wrong(place, &format!("a list of {expected}"), value))?;
    let point = |(i, value): (usize, &Value)| {
        let place = format!("{place}[{i}]");
        let row = value.as_array().filter(|row| (4..=5).contains(&row.len()));
        let row = row.ok_or_else(|| wrong(&place, expected, value))?;
        let number = |k: usize| {
            let number = row[k].as_f64().filter(|x| x.abs() <= MAX_COORDINATE_PX);
            number.ok_or_else(|| wrong(&format!("{place}[{k}]"), "a finite number up to 1e9", &row[k]))
        };
        let optional = |k: usize| if row[k].is_null() { Ok(None) } else { number(k).map(Some) };
        let point = PanelPoint {
            camera: Point2::new(number(0)?, number(1)?),
            expected: [optional(2)?, optional(3)?],
            sigma_px: if row.len() == 5 { Some(number(4)?) } else { None },
        };
        if !point.is_valid() {
            return Err(wrong(
                &place,
                &format!("{expected}, a coordinate of the panel and a positive σ"),
                value,
            ));
        }
        Ok(point)
    };
    list.iter().enumerate().map(point).collect()
}

/// Rows of camera x and y, panel x and y, red x and y, blue x and y, σ of red and of blue.
fn channel_offsets(value: &Value, place: &str) -> Result<Vec<ChannelOffset>> {
    let expected =
        "[camera_x, camera_y, projector_x, projector_y, red_x, red_y, blue_x, blue_y, σ_red, σ_blue]";
    let list = value.as_array().ok_or_else(|| wrong(place, &format!("a list of {expected}"), value))?;
    let offset = |(i, value): (usize, &Value)| {
        let place = format!("{place}[{i}]");
        let numbers = numbers(value, &place, expected)?;
        let &[cx, cy, px, py, rx, ry, bx, by, red, blue] = numbers.as_slice() else {
            return Err(wrong(&place, expected, value));
        };
        let offset = ChannelOffset {
            camera: Point2::new(cx, cy),
            projector: Point2::new(px, py),
            offset_px: RedBlue { red: Vector2::new(rx, ry), blue: Vector2::new(bx, by) },
            sigma_px: RedBlue { red, blue },
        };
        let valid = offset.is_valid().then_some(offset);
        valid.ok_or_else(|| {
            malformed(format!("{place}: expected positive σ in pixels, found {red} and {blue}"))
        })
    };
    list.iter().enumerate().map(offset).collect()
}
