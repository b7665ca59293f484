//! JSON as values, within a budget of memory.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::budget::{Budget, DEEPEST};
use crate::error::{Error, ErrorSubject, Result};

/// The value of a text of JSON.
///
/// # Errors
/// [`Error::Malformed`] when it is not JSON, or takes more memory or levels than a file may.
pub(super) fn json(text: &[u8], what: ErrorSubject, budget: &Budget) -> Result<Value> {
    let mut parser = serde_json::Deserializer::from_slice(text);
    let level = Level { budget, depth: 0 };
    let value = level.deserialize(&mut parser).and_then(|value| parser.end().map(|()| value));
    value.map_err(|e| {
        // The values of JSON take all that JSON can hold: only the budget refuses them.
        if e.is_data() { Error::malformed(what, e.to_string()) } else { Error::unparsable(what, "JSON", e) }
    })
}

/// The values at this depth.
#[derive(Clone, Copy)]
struct Level<'b> {
    budget: &'b Budget,
    depth: usize,
}

impl Level<'_> {
    fn below<E: serde::de::Error>(self) -> std::result::Result<Self, E> {
        if self.depth == DEEPEST {
            return Err(E::custom(format!("expected at most {DEEPEST} levels of values, found more")));
        }
        Ok(Self { depth: self.depth + 1, ..self })
    }
}

/// A refusal of the budget as an error of the parser.
fn spent<T, E: serde::de::Error>(kept: Result<T>) -> std::result::Result<T, E> {
    kept.map_err(|e| match e {
        Error::Malformed { detail, .. } => E::custom(detail),
        other => E::custom(other),
    })
}

impl<'de> DeserializeSeed<'de> for Level<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> std::result::Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Level<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value of JSON")
    }

    fn visit_unit<E>(self) -> std::result::Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> std::result::Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> std::result::Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> std::result::Result<Value, E> {
        spent(self.budget.keep_text(text))?;
        Ok(text.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<Value, A::Error> {
        let inner = self.below()?;
        let mut items = Vec::new();
        while let Some(item) = list.next_element_seed(inner)? {
            spent(self.budget.push::<Value>(items.len()))?;
            items.push(item);
        }
        Ok(Value::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> std::result::Result<Value, A::Error> {
        let inner = self.below()?;
        let mut fields = Map::new();
        while let Some(name) = object.next_key::<String>()? {
            spent(self.budget.keep_text(&name))?;
            spent(self.budget.push_name(fields.len()))?;
            fields.insert(name, object.next_value_seed(inner)?);
        }
        Ok(Value::Object(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, spent: usize) -> Result<Value> {
        let budget = Budget::new(ErrorSubject::RigFile, text.len());
        budget.keep(spent)?;
        json(text.as_bytes(), ErrorSubject::RigFile, &budget)
    }

    #[test]
    fn the_values_are_those_of_serde() {
        let text = r#" {"a": [1, -2, 2.5e-3, 18446744073709551615, true, null], "é\n": {"b": "\u00fc"}, "": [[], {}], "a": 1} "#;
        assert_eq!(read(text, 0).unwrap(), serde_json::from_str::<Value>(text).unwrap());
        for text in ["", "{", "[1,]", "{} {}", "1e999", "nul"] {
            let said = read(text, 0).unwrap_err().to_string();
            let serde = serde_json::from_str::<Value>(text).unwrap_err();
            assert_eq!(said, format!("malformed rig JSON: this is not JSON: {serde}"));
        }
    }

    #[test]
    fn values_and_levels_are_counted() {
        for item in ["0,", "[0],", "{\"\":0},", "\"\",", "[],", "\"a\","] {
            let text = format!("[{}0]", item.repeat(1000));
            assert!(read(&text, 0).is_ok(), "{item}");
            let said = read(&text, 48_000_000 + 15 * text.len()).unwrap_err().to_string();
            assert!(said.contains("MB of memory") && said.contains("line 1 column"), "{said}");
        }
        let deep = |levels: usize| format!("{}{}", "[".repeat(levels), "]".repeat(levels));
        assert!(read(&deep(DEEPEST), 0).is_ok());
        let said = read(&deep(DEEPEST + 1), 0).unwrap_err().to_string();
        assert!(said.contains("at most 32 levels") && !said.contains("not JSON"), "{said}");
    }
}
