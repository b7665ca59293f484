//! Sheets and pairs from and to arrays.

use nalgebra::{Point2, Vector2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use slcal_core::{ChannelOffset, CornerPair, EdgePoint, PanelPoint, RedBlue, SheetObservation};

use crate::convert::array::{Numbers, any_rows_of, column, rows, rows_of};
use crate::convert::columns::column_of;
use crate::errors;

/// Names of the sheet's sides, in the order of the core.
const SIDES: [&str; 4] = ["top", "right", "bottom", "left"];

fn by_side<'py>(
    py: Python<'py>,
    sheet: &SheetObservation,
    of: impl Fn(&[EdgePoint]) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (i, name) in SIDES.iter().enumerate() {
        let points: &[EdgePoint] = match sheet {
            SheetObservation::Edges(sides) => &sides[i],
            SheetObservation::Corners { .. } => &[],
        };
        dict.set_item(name, of(points)?)?;
    }
    Ok(dict)
}

/// (N, 2) for each side; none where corners are known instead.
pub(crate) fn edges<'py>(py: Python<'py>, sheet: &SheetObservation) -> PyResult<Bound<'py, PyDict>> {
    by_side(py, sheet, |points| rows(py, points.iter().map(|p| [p.position.x, p.position.y])))
}

/// (N,), NaN where it is not stated.
pub(crate) fn pair_sigma<'py>(py: Python<'py>, pairs: &[CornerPair]) -> PyResult<Bound<'py, PyAny>> {
    column(py, pairs.iter().map(|p| p.sigma_px.unwrap_or(f64::NAN)))
}

/// (N,) for each side, NaN where it is not stated.
pub(crate) fn edge_sigma<'py>(py: Python<'py>, sheet: &SheetObservation) -> PyResult<Bound<'py, PyDict>> {
    by_side(py, sheet, |points| column(py, points.iter().map(|p| p.sigma_px.unwrap_or(f64::NAN))))
}

/// Rows of `N` coordinates, or of one number more that is their σ.
fn with_sigma<const N: usize, const WITH: usize>(
    values: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<(Vec<[f64; N]>, Option<Vec<f64>>)> {
    let py = values.py();
    let last = Numbers::of(values, what)?.view().shape().last().copied();
    let (points, sigma) = if last == Some(WITH) {
        let full = rows_of::<WITH>(values, what)?;
        let points: Vec<[f64; N]> = full.iter().map(|row| std::array::from_fn(|k| row[k])).collect();
        (points, Some(full.iter().map(|row| row[WITH - 1]).collect::<Vec<f64>>()))
    } else {
        (rows_of::<N>(values, what)?, None)
    };
    let limit = slcal_core::ViewObservation::MAX_COORDINATE_PX;
    for (i, row) in points.iter().enumerate() {
        if let Some(far) = row.iter().find(|x| x.abs() > limit) {
            return Err(errors::invalid(py, what, "pixels up to 1e9", &format!("{far} in row {i}")));
        }
    }
    if let Some(sigma) = &sigma {
        check_sigma(py, sigma, &format!("{what}, last column"))?;
    }
    Ok((points, sigma))
}

fn check_sigma(py: Python<'_>, sigma: &[f64], what: &str) -> PyResult<()> {
    match sigma.iter().position(|s| !slcal_core::ViewObservation::SIGMA_RANGE_PX.contains(s)) {
        None => Ok(()),
        Some(i) => {
            let found = format!("{} in row {i}", sigma[i]);
            Err(errors::invalid(py, what, "1σ in pixels, a number above zero", &found))
        }
    }
}

fn stated(sigma: &Bound<'_, PyAny>, n: usize, what: &str) -> PyResult<Vec<f64>> {
    let sigma = (sigma.py(), column_of(sigma, n, what, true)?);
    check_sigma(sigma.0, &sigma.1, what)?;
    Ok(sigma.1)
}

/// Exactly four corners.
pub(crate) fn four_corners(values: &Bound<'_, PyAny>, what: &str) -> PyResult<[Point2<f64>; 4]> {
    let rows = rows_of::<2>(values, what)?;
    let found = format!("{} corners", rows.len());
    let limit = slcal_core::ViewObservation::MAX_COORDINATE_PX;
    if let Some(i) = rows.iter().position(|r| r.iter().any(|x| x.abs() > limit)) {
        let found = format!("{:?} in row {i}", rows[i]);
        return Err(errors::invalid(values.py(), what, "pixels up to 1e9", &found));
    }
    let four: [[f64; 2]; 4] = rows.try_into().map_err(|_| {
        errors::invalid(values.py(), what, "the four corners TL, TR, BR, BL, shape (4, 2)", &found)
    })?;
    Ok(four.map(Point2::from))
}

pub(super) fn by_corners(
    corners: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<SheetObservation> {
    let corners = four_corners(corners, "sheet_corners")?;
    let sigma = sigma.map(|s| {
        if s.cast::<PyMapping>().is_ok() {
            let found = "a mapping, which belongs to sheet_edges";
            return Err(errors::invalid(s.py(), "sheet_sigma_px", "one number for the corners", found));
        }
        Ok(stated(s, 1, "sheet_sigma_px")?.first().copied())
    });
    Ok(SheetObservation::Corners { corners, sigma_px: sigma.transpose()?.flatten() })
}

/// The entry of each side.
fn four_sides<'py>(values: &Bound<'py, PyAny>, what: &str) -> PyResult<[Bound<'py, PyAny>; 4]> {
    let py = values.py();
    let Ok(mapping) = values.cast::<PyMapping>() else {
        let wanted = "a mapping with \"top\", \"right\", \"bottom\" and \"left\"";
        return Err(errors::wrong_type(what, wanted, &values.get_type().name()?.to_string()));
    };
    let wanted = "the sides \"top\", \"right\", \"bottom\" and \"left\"";
    for key in mapping.keys()?.iter() {
        if !key.extract::<String>().is_ok_and(|k| SIDES.contains(&k.as_str())) {
            return Err(errors::invalid(py, what, wanted, &key.repr()?.to_string()));
        }
    }
    let mut sides = Vec::with_capacity(4);
    for name in SIDES {
        if !mapping.contains(name)? {
            return Err(errors::invalid(py, what, wanted, &format!("no \"{name}\"")));
        }
        sides.push(mapping.get_item(name)?);
    }
    sides.try_into().map_err(|_| errors::invalid(py, what, wanted, "others"))
}

pub(super) fn by_edges(
    edges: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<SheetObservation> {
    const SIGMA: &str = "sheet_sigma_px";
    let py = edges.py();
    let by_side = match sigma {
        Some(s) if s.cast::<PyMapping>().is_ok() => Some(four_sides(s, SIGMA)?),
        Some(s) => Some(std::array::from_fn(|_| s.clone())),
        None => None,
    };
    let mut sides: [Vec<EdgePoint>; 4] = Default::default();
    let (mut with, mut without) = (None, None);
    for (i, values) in four_sides(edges, "sheet_edges")?.iter().enumerate() {
        let (points, own) = with_sigma::<2, 3>(values, &format!("sheet_edges[\"{}\"]", SIDES[i]))?;
        let of_side = by_side.as_ref().map(|s| {
            let of_mapping = sigma.is_some_and(|s| s.cast::<PyMapping>().is_ok());
            let what = if of_mapping { format!("{SIGMA}[\"{}\"]", SIDES[i]) } else { SIGMA.to_owned() };
            stated(&s[i], points.len(), &what)
        });
        // What a point says of itself counts first, as in files.
        let sigma = own.or(of_side.transpose()?);
        if !points.is_empty() {
            *(if sigma.is_some() { &mut with } else { &mut without }) = Some(SIDES[i]);
        }
        let point = |(k, xy): (usize, &[f64; 2])| EdgePoint {
            position: Point2::from(*xy),
            sigma_px: sigma.as_ref().map(|s| s[k]),
        };
        sides[i] = points.iter().enumerate().map(point).collect();
    }
    if let (Some(with), Some(without)) = (with, without) {
        let found = format!("it for \"{with}\" and not for \"{without}\"; give the rest as {SIGMA}");
        return Err(errors::invalid(
            py,
            "sheet_edges",
            "σ as a third column for every side or for none",
            &found,
        ));
    }
    Ok(SheetObservation::Edges(sides))
}

pub(super) fn pairs_of(
    values: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<CornerPair>> {
    let (points, own) = with_sigma::<4, 5>(values, "pairs")?;
    let given = sigma.map(|s| stated(s, points.len(), "pair_sigma_px")).transpose()?;
    let sigma = own.or(given);
    let pair = |(k, [cx, cy, px, py]): (usize, [f64; 4])| CornerPair {
        camera: Point2::new(cx, cy),
        projector: Point2::new(px, py),
        sigma_px: sigma.as_ref().map(|s| s[k]),
    };
    Ok(points.into_iter().enumerate().map(pair).collect())
}

/// Points of the panel: NaN stands for a coordinate along a border, and for a σ that is not stated.
pub(super) fn panel_points_of(values: &Bound<'_, PyAny>) -> PyResult<Vec<PanelPoint>> {
    const NAME: &str = "panel_points";
    let stated = |x: f64| (!x.is_nan()).then_some(x);
    let point = |[cx, cy, x, y, sigma]: [f64; 5]| PanelPoint {
        camera: Point2::new(cx, cy),
        expected: [stated(x), stated(y)],
        sigma_px: stated(sigma),
    };
    let points: Vec<PanelPoint> = any_rows_of::<5>(values, NAME)?.into_iter().map(point).collect();
    match points.iter().position(|p| !p.is_valid()) {
        None => Ok(points),
        Some(i) => {
            let expected = "finite camera px, panel x or y or both, and a positive σ or NaN";
            Err(errors::invalid(values.py(), NAME, expected, &format!("others in row {i}")))
        }
    }
}

/// Offsets of the channels, as rows of ten numbers.
pub(super) fn channel_offsets_of(values: &Bound<'_, PyAny>) -> PyResult<Vec<ChannelOffset>> {
    const NAME: &str = "channel_offsets";
    let offset = |[cx, cy, px, py, rx, ry, bx, by, red, blue]: [f64; 10]| ChannelOffset {
        camera: Point2::new(cx, cy),
        projector: Point2::new(px, py),
        offset_px: RedBlue { red: Vector2::new(rx, ry), blue: Vector2::new(bx, by) },
        sigma_px: RedBlue { red, blue },
    };
    let offsets: Vec<ChannelOffset> = any_rows_of::<10>(values, NAME)?.into_iter().map(offset).collect();
    match offsets.iter().position(|o| !o.is_valid()) {
        None => Ok(offsets),
        Some(i) => {
            let expected = "finite px and positive σ";
            Err(errors::invalid(values.py(), NAME, expected, &format!("others in row {i}")))
        }
    }
}
