//! The values of a rig beyond the geometry of its devices: σ, poses of the sheet, quality, covariance. The names are those
//! of rig.json.

use serde_json::{Map, Value};

use crate::error::{Error, Result};
use crate::format::budget::Budget;
use crate::format::rig_json::{rig_of_value, rig_value};
use crate::format::tree::{Expecting, Node};
use crate::rig::Rig;

/// Values that are words, even where they look like numbers.
const WORDS: [&str; 13] = [
    "photo",
    "method",
    "verdict",
    "cause",
    "code",
    "message",
    "advice",
    "parameters",
    "text",
    "unit",
    "status",
    "reference",
    "from",
];

/// Where each of them stands in rig.json, and its name in other files.
const PLACES: [(&str, &str); 10] = [
    ("/method", "method"),
    ("/camera/sigma", "camera_sigma"),
    ("/projector/sigma", "projector_sigma"),
    ("/projector/mirrored", MIRRORED),
    ("/projector_from_camera/sigma_t_mm", "sigma_t_mm"),
    ("/projector_from_camera/sigma_r_rad", "sigma_r_rad"),
    ("/views", "views"),
    ("/quality", "quality"),
    ("/covariance", "covariance"),
    ("/channel_registration", "channel_registration"),
];

/// 1 where pictures appear mirrored, else left out: other files have numbers only.
pub(super) const MIRRORED: &str = "projector_mirrored";

/// All values that the rig has.
pub(super) fn of_rig(rig: &Rig) -> Result<Map<String, Value>> {
    let value = rig_value(rig)?;
    let found = PLACES.iter().filter_map(|(place, name)| {
        let part = value.pointer(place)?;
        // A missing covariance is stored as one without parameters.
        let list = part.get("parameters").unwrap_or(part);
        let empty = part.is_null() || list.as_array().is_some_and(Vec::is_empty);
        let part = if *name == MIRRORED { Value::from(1.0) } else { part.clone() };
        (!empty).then(|| ((*name).to_owned(), part))
    });
    Ok(found.collect())
}

/// The rig with the values read beside its devices.
pub(super) fn added_to(rig: &Rig, mut extras: Map<String, Value>, expecting: Expecting) -> Result<Rig> {
    let mut value = rig_value(rig)?;
    for (place, name) in PLACES {
        let Some((parent, field)) = place.rsplit_once('/') else { continue };
        if let (Some(part), Some(Value::Object(fields))) = (extras.remove(name), value.pointer_mut(parent)) {
            let part = if name == MIRRORED { Value::Bool(part.as_f64() == Some(1.0)) } else { part };
            fields.insert(field.to_owned(), part);
        }
    }
    rig_of_value(value).map_err(|e| renamed(e, expecting))
}

/// An error of the rig reader as an error of the imported file.
pub(super) fn renamed(error: Error, expecting: Expecting) -> Error {
    match error {
        Error::Malformed { detail, .. } => expecting.malformed(detail),
        other => other,
    }
}

/// Named values of a text: numbers, words where the name says so, matrices as their rows.
pub(super) fn from_node(node: &Node<'_>, name: &str, expecting: Expecting, budget: &Budget) -> Result<Value> {
    let list = |numbers: &[f64]| -> Result<Value> {
        budget.keep_list::<Value>(numbers.len())?;
        Ok(Value::from(numbers))
    };
    Ok(match node {
        Node::Scalar(text) if WORDS.contains(&name) => Value::String(kept(text, budget)?),
        Node::Scalar(text) => match numbers(node, name, expecting).as_deref() {
            Ok([one]) => Value::from(*one),
            Ok(many) => list(many)?,
            Err(_) => Value::String(kept(text, budget)?),
        },
        Node::List(items) => {
            budget.keep_list::<Value>(items.len())?;
            let values = items.iter().map(|i| from_node(i, name, expecting, budget));
            Value::Array(values.collect::<Result<_>>()?)
        }
        Node::Map(_) if node.get("data").is_some() => matrix(node, name, expecting, budget)?,
        Node::Map(fields) => {
            let mut values = Map::new();
            for (name, value) in fields {
                budget.push_name(values.len())?;
                values.insert(kept(name, budget)?, from_node(value, name, expecting, budget)?);
            }
            Value::Object(values)
        }
    })
}

/// A copy of a word.
fn kept(text: &str, budget: &Budget) -> Result<String> {
    budget.keep_text(text)?;
    Ok(text.to_owned())
}

fn matrix(node: &Node<'_>, name: &str, expecting: Expecting, budget: &Budget) -> Result<Value> {
    let values = numbers(node, name, expecting)?;
    let columns = node.get("cols").and_then(|c| c.words().first()?.parse::<usize>().ok());
    let Some(columns) = columns.filter(|c| *c > 0) else {
        return Err(expecting.malformed(format!("{name}: expected a matrix with rows, cols and data")));
    };
    budget.keep_list::<Value>(values.len().saturating_add(values.len() / columns))?;
    Ok(values.chunks(columns).map(Value::from).collect())
}

fn numbers(node: &Node<'_>, name: &str, expecting: Expecting) -> Result<Vec<f64>> {
    crate::format::camera::numbers(node, name, expecting)
}
