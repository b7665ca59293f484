//! Keyword arguments: names and numbers as the core's configurations.

use pyo3::prelude::*;
use pyo3::types::PyBool;
use slcal_core::geometry::RectangleSize;
use slcal_core::photo::Encoding;
use slcal_core::reconstruct::CullRule;
use slcal_core::{DistortionModel, Frame, Method, PrincipalPointRule, ViewObservation};

use crate::errors::{self, Raise as _, Stage};

/// How a value that is not accepted is shown.
pub(crate) fn shown(value: &Bound<'_, PyAny>) -> String {
    value.repr().map_or_else(|_| "another object".to_owned(), |r| r.to_string())
}

fn name(value: &Bound<'_, PyAny>) -> Option<String> {
    value.extract().ok()
}

/// One of several names.
pub(crate) fn one_of<T: Copy>(value: &Bound<'_, PyAny>, what: &str, names: &[(&str, T)]) -> PyResult<T> {
    let given = name(value);
    let found = names.iter().find(|(n, _)| given.as_deref() == Some(*n)).map(|(_, v)| *v);
    found.ok_or_else(|| refused(value, what, names, ""))
}

fn refused<T>(value: &Bound<'_, PyAny>, what: &str, names: &[(&str, T)], more: &str) -> PyErr {
    let names: Vec<String> = names.iter().map(|(n, _)| format!("\"{n}\"")).collect();
    errors::invalid(value.py(), what, &format!("{}{more}", names.join(", ")), &shown(value))
}

/// Width and height in whole pixels, or columns and rows.
pub(crate) fn whole_pair(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[u32; 2]> {
    let pair: Option<[i64; 2]> = value.extract::<(i64, i64)>().ok().map(|(w, h)| [w, h]).or_else(|| {
        // NumPy's integers and arrays.
        let items = value.try_iter().ok()?.collect::<PyResult<Vec<_>>>().ok()?;
        let items = items.iter().map(|i| i.extract::<i64>().ok()).collect::<Option<Vec<_>>>()?;
        items.try_into().ok()
    });
    let whole = pair.and_then(|p| Some([u32::try_from(p[0]).ok()?, u32::try_from(p[1]).ok()?]));
    whole.filter(|p| p[0] > 0 && p[1] > 0).ok_or_else(|| {
        errors::invalid(value.py(), what, "two whole numbers above zero, such as (1024, 768)", &shown(value))
    })
}

/// Width and height of a sheet, mm.
pub(crate) fn sheet_size(value: &Bound<'_, PyAny>) -> PyResult<RectangleSize> {
    let refused = || {
        let wanted =
            "width and height of the sheet, each from 1 mm to 100 m, in millimetres, such as (594, 420)";
        errors::invalid(value.py(), "size_mm", wanted, &shown(value))
    };
    let items =
        value.try_iter().and_then(|items| items.map(|i| i?.extract::<f64>()).collect::<PyResult<Vec<_>>>());
    let sides: [f64; 2] = items.ok().and_then(|sides| sides.try_into().ok()).ok_or_else(refused)?;
    if !sides.iter().all(|side| ViewObservation::SIDE_RANGE_MM.contains(side)) {
        return Err(refused());
    }
    RectangleSize::new(sides[0], sides[1]).raise(value.py(), Stage::Detect)
}

/// Photographs without the pattern: `plain`, or `screen`, its older name.
pub(crate) fn plain<'a, 'py>(
    plain: Option<&'a Bound<'py, PyAny>>,
    screen: Option<&'a Bound<'py, PyAny>>,
) -> PyResult<Option<&'a Bound<'py, PyAny>>> {
    match (plain, screen) {
        (Some(_), Some(screen)) => {
            Err(errors::invalid(screen.py(), "screen", "plain alone, of which it is the older name", "both"))
        }
        (given, None) | (None, given) => Ok(given),
    }
}

/// "srgb", "linear" or a number.
pub(crate) fn gamma(value: Option<&Bound<'_, PyAny>>) -> PyResult<Encoding> {
    let Some(value) = value else { return Ok(Encoding::Srgb) };
    // True is a number to Python, and no γ to anybody.
    let number = value.extract::<f64>().ok().filter(|_| !value.is_instance_of::<PyBool>());
    let encoding = match (name(value).as_deref(), number) {
        (Some("srgb"), _) => Encoding::Srgb,
        (Some("linear"), _) => Encoding::Linear,
        (None, Some(number)) => Encoding::Gamma(number),
        _ => {
            let wanted = "\"srgb\", \"linear\" or a number from 0.1 to 10";
            return Err(errors::invalid(value.py(), "gamma", wanted, &shown(value)));
        }
    };
    encoding.validate().raise(value.py(), Stage::Detect)?;
    Ok(encoding)
}

/// What is known of a principal point.
pub(crate) fn principal_point(
    value: Option<&Bound<'_, PyAny>>,
    what: &str,
    default: PrincipalPointRule,
) -> PyResult<PrincipalPointRule> {
    const NAMES: [(&str, PrincipalPointRule); 4] = [
        ("prior", PrincipalPointRule::Prior),
        ("shift", PrincipalPointRule::Shift),
        ("centre", PrincipalPointRule::Centre),
        ("free", PrincipalPointRule::Free),
    ];
    let Some(value) = value else { return Ok(default) };
    if name(value).is_none()
        && let Ok((x, y)) = value.extract::<(f64, f64)>()
    {
        return Ok(PrincipalPointRule::Exact(x, y));
    }
    one_of(value, what, &NAMES).map_err(|_| refused(value, what, &NAMES, " or two pixel coordinates"))
}

/// Which coefficients of a lens are estimated.
pub(crate) fn distortion(value: Option<&Bound<'_, PyAny>>, what: &str) -> PyResult<DistortionModel> {
    const NAMES: [(&str, DistortionModel); 5] = [
        ("auto", DistortionModel::Auto),
        ("none", DistortionModel::None),
        ("k1", DistortionModel::K1),
        ("k1k2", DistortionModel::K1K2),
        ("full", DistortionModel::Full),
    ];
    value.map_or(Ok(DistortionModel::Auto), |v| one_of(v, what, &NAMES))
}

/// The estimator.
pub(crate) fn method(value: Option<&Bound<'_, PyAny>>) -> PyResult<Method> {
    value.map_or(Ok(Method::Ml), |v| one_of(v, "method", &[("ml", Method::Ml), ("two-vp", Method::TwoVp)]))
}

/// "auto", "off" or an area in mm².
pub(crate) fn cull(value: Option<&Bound<'_, PyAny>>, default: CullRule) -> PyResult<CullRule> {
    const NAMES: [(&str, CullRule); 2] = [("auto", CullRule::Auto), ("off", CullRule::Off)];
    let Some(value) = value else { return Ok(default) };
    if name(value).is_none()
        && let Ok(area) = value.extract::<f64>()
        && area.is_finite()
        && area > 0.0
    {
        return Ok(CullRule::MaxAreaMm2(area));
    }
    one_of(value, "cull", &NAMES)
        .map_err(|_| refused(value, "cull", &NAMES, " or an area above zero in square millimetres"))
}

/// Whose coordinates a cloud has.
pub(crate) fn frame(value: Option<&Bound<'_, PyAny>>) -> PyResult<Frame> {
    const NAMES: [(&str, Frame); 2] = [("camera", Frame::Camera), ("plane", Frame::Plane)];
    value.map_or(Ok(Frame::Camera), |v| one_of(v, "frame", &NAMES))
}
