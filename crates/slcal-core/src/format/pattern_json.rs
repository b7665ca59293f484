//! Pattern files: JSON with `"schema": "slcal-pattern/1"` and a `kind`.

use std::io::{Read, Write};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::recognise::read_json;
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::{Axis, CheckerPattern, Pattern, SequencePattern, StripePattern, unique_window};

const SCHEMA: &str = "slcal-pattern/1";

/// Stripes as other programs may write them.
#[derive(Deserialize)]
struct StripesFile {
    projector: [u32; 2],
    #[serde(default)]
    axis: Axis,
    palette: Vec<[u8; 3]>,
    sequence: Vec<u8>,
    centres_px: Vec<f64>,
    width_px: Option<Width>,
    order: Option<u32>,
}

/// One width for all slits, or one for each.
#[derive(Deserialize)]
#[serde(untagged)]
enum Width {
    All(f64),
    Each(Vec<f64>),
}

#[derive(Serialize)]
struct Envelope<'a> {
    schema: &'a str,
    #[serde(flatten)]
    pattern: &'a Pattern,
}

fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::PatternFile, detail)
}

/// Reads a pattern of any kind. `axis`, `width_px` and `order` of stripes may be left out by other programs
/// (columns, half the period, the shortest window that is unique); unknown fields are ignored.
///
/// # Errors
/// [`Error::Malformed`] naming the field that is missing, of the wrong type, or inconsistent; [`Error::Io`] when the
/// stream fails.
pub fn read_pattern(input: impl Read) -> Result<Pattern> {
    let value = read_json(input, ErrorSubject::PatternFile, "a pattern")?;
    let tag = |name: &str| value.get(name).and_then(Value::as_str);
    if tag("schema") != Some(SCHEMA) {
        let found = value.get("schema").map_or("none".into(), Value::to_string);
        return Err(malformed(format!("expected \"schema\": \"{SCHEMA}\", found {found}")));
    }
    // Both branches name the field of an invalid value, whether serde or the pattern detects it.
    let broken = |e: Error| match e {
        Error::Invalid { what, expected, found } => {
            malformed(format!("{what}: expected {expected}, found {found}"))
        }
        e => e,
    };
    match tag("kind") {
        Some("checker") => checker(value).map_err(broken).map(Pattern::Checker),
        Some("stripes") => stripes(value).map_err(broken).map(Pattern::Stripes),
        Some("sequence") => sequence(value).map_err(broken).map(Pattern::Sequence),
        _ => {
            let found = value.get("kind").map_or("none".into(), Value::to_string);
            Err(malformed(format!(
                "expected \"kind\": \"checker\", \"stripes\" or \"sequence\", found {found}"
            )))
        }
    }
}

fn checker(value: Value) -> Result<CheckerPattern> {
    let pattern: CheckerPattern =
        serde_json::from_value(value).map_err(|e| malformed(format!("checker: {e}")))?;
    pattern.validate()?;
    Ok(pattern)
}

fn sequence(value: Value) -> Result<SequencePattern> {
    let pattern: SequencePattern =
        serde_json::from_value(value).map_err(|e| malformed(format!("sequence: {e}")))?;
    pattern.validate()?;
    Ok(pattern)
}

fn stripes(value: Value) -> Result<StripePattern> {
    let f: StripesFile = serde_json::from_value(value).map_err(|e| malformed(format!("stripes: {e}")))?;
    let mut pattern = StripePattern {
        projector: f.projector,
        axis: f.axis,
        order: f.order.unwrap_or_else(|| unique_window(&f.sequence).max(1) as u32),
        palette: f.palette,
        sequence: f.sequence,
        centres_px: f.centres_px,
        width_px: 0.0,
    };
    pattern.width_px = match f.width_px {
        Some(Width::All(width)) => width,
        Some(Width::Each(mut widths)) => {
            let n = pattern.sequence.len();
            if widths.len() != n || widths.is_empty() {
                let found = widths.len();
                return Err(Error::invalid(
                    "width_px",
                    format!("one number, or one for each of {n} slits"),
                    found,
                ));
            }
            widths.sort_by(f64::total_cmp);
            widths[widths.len() / 2]
        }
        None => pattern.period_px() / 2.0,
    };
    pattern.validate()?;
    Ok(pattern)
}

/// Writes a pattern of any kind.
///
/// # Errors
/// [`Error::Io`] when the stream fails.
pub fn write_pattern(pattern: &Pattern, mut output: impl Write) -> Result<()> {
    let written = serde_json::to_writer_pretty(&mut output, &Envelope { schema: SCHEMA, pattern });
    written
        .map_err(Into::into)
        .and_then(|()| writeln!(output))
        .map_err(|e| Error::writing(ErrorSubject::PatternFile, e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::rendered_scenes;
    use crate::pattern::{
        CheckerConfig, FrameLight, SequenceAxes, SequenceConfig, SinusoidConfig, StripeConfig,
    };
    use serde_json::json;

    fn text(pattern: &Pattern) -> Value {
        let mut out = Vec::new();
        write_pattern(pattern, &mut out).unwrap();
        serde_json::from_slice(&out).unwrap()
    }

    fn read(value: &Value) -> std::result::Result<Pattern, String> {
        read_pattern(value.to_string().as_bytes()).map_err(|e| e.to_string())
    }

    fn default_stripes() -> Pattern {
        Pattern::Stripes(StripePattern::new([1024, 768], &StripeConfig::default()).unwrap())
    }

    fn default_checker() -> Pattern {
        Pattern::Checker(CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap())
    }

    #[test]
    fn what_is_written_is_read() {
        let config = CheckerConfig { marks: true, ..CheckerConfig::default() };
        let marked = Pattern::Checker(CheckerPattern::new([1024, 768], &config).unwrap());
        let both = SequenceConfig {
            axes: SequenceAxes::Both,
            sinusoid: Some(SinusoidConfig::default()),
            ..SequenceConfig::default()
        };
        let sequence = Pattern::Sequence(SequencePattern::new([1024, 768], &both).unwrap());
        for pattern in [default_checker(), default_stripes(), marked, sequence] {
            assert_eq!(read(&text(&pattern)).unwrap(), pattern);
        }
        assert!(text(&default_checker()).get("marks").is_none());
    }

    #[test]
    fn the_files_of_the_rendered_scenes_are_the_defaults() {
        for (name, pattern) in [("checker.json", default_checker()), ("stripes.json", default_stripes())] {
            let Some(path) = rendered_scenes(&format!("paper_tilted/patterns/{name}")) else { return };
            assert_eq!(read_pattern(std::fs::File::open(path).unwrap()).unwrap(), pattern);
        }
    }

    #[test]
    fn stripes_from_elsewhere_need_only_colours_and_centres() {
        let file = json!({"schema": SCHEMA, "kind": "stripes", "projector": [800, 600], "note": "three colours",
            "palette": [[255, 0, 0], [0, 255, 0], [0, 0, 255]], "sequence": [0, 1, 2, 0, 2], "centres_px": [10, 20.25, 33, 47, 60]});
        let Pattern::Stripes(p) = read(&file).unwrap() else { panic!("stripes") };
        assert_eq!((p.axis, p.order, p.width_px), (Axis::Columns, 2, 13.0 / 2.0));
        let mut each = file.clone();
        each["width_px"] = json!([5, 5, 6, 5, 5]);
        let Pattern::Stripes(p) = read(&each).unwrap() else { panic!("stripes") };
        assert_eq!(p.width_px, 5.0);
    }

    #[test]
    fn an_ambiguous_board_from_elsewhere_is_read_and_flagged() {
        let mut file = text(&default_checker());
        file["squares"] = json!([10, 8]);
        let Pattern::Checker(p) = read(&file).unwrap() else { panic!("checker") };
        assert!(p.half_turn_ambiguous());
    }

    #[test]
    fn a_sequence_from_elsewhere_needs_neither_files_nor_axes() {
        let bit = |bit, inverted| json!({"is": "bit", "bit": bit, "inverted": inverted});
        let mut file = json!({"schema": SCHEMA, "kind": "sequence", "projector": [4, 3], "by": "another program",
            "frames": [bit(1, false), bit(1, true), bit(0, true), {"is": "bit", "bit": 0, "note": 7}]});
        let Pattern::Sequence(p) = read(&file).unwrap() else { panic!("sequence") };
        assert_eq!(p.frames[2].light, FrameLight::Bit { axis: Axis::Columns, bit: 0, inverted: true });
        for (frame, word) in [
            (json!({"is": "bit"}), "bit"),
            (json!({"is": "dots"}), "dots"),
            (json!({"is": "sinusoid", "period_px": 8, "step": 9, "of": 4}), "frames[1]"),
            (json!(7), "sequence"),
        ] {
            file["frames"][1] = frame;
            let message = read(&file).unwrap_err();
            assert!(message.contains(word), "{word}: {message}");
        }
    }

    #[test]
    fn broken_files_name_what_is_broken() {
        let checker = text(&default_checker());
        let stripes = text(&default_stripes());
        let cases: [(&Value, &str, Value, &str); 17] = [
            (&checker, "schema", json!("slcal-rig/1"), "slcal-rig/1"),
            (&checker, "kind", json!("dots"), "dots"),
            (&checker, "squares", Value::Null, "squares"),
            (&checker, "squares", json!([1, 8]), "squares"),
            (&checker, "square_px", json!("wide"), "expected f64"),
            (&checker, "square_px", json!(0), "square_px"),
            (&checker, "origin_px", json!([900, 191.5]), "inside the panel"),
            (&checker, "first_square", json!("blue"), "blue"),
            (&checker, "marks", json!({"side_px": 0, "centres_px": []}), "marks.side_px"),
            (&checker, "marks", json!({"side_px": 8, "centres_px": [[9, 9], [2000, 9]]}), "marks.centres_px"),
            (&stripes, "centres_px", Value::Null, "centres_px"),
            (&stripes, "centres_px", json!([1, 2]), "each of the 64"),
            (&stripes, "sequence", json!([9]), "centres_px"),
            (&stripes, "palette", json!([[1, 2, 3]]), "sequence[3]"),
            (&stripes, "projector", json!([500, 768]), "centres_px[31]"),
            (&stripes, "width_px", json!(-1), "width_px"),
            (&stripes, "axis", json!("diagonal"), "diagonal"),
        ];
        for (base, field, value, expected) in cases {
            let mut file = base.clone();
            if value.is_null() {
                file.as_object_mut().unwrap().remove(field);
            } else {
                file[field] = value;
            }
            let message = read(&file).unwrap_err();
            assert!(message.contains(expected), "{field}: {message}");
        }
        let mut many = stripes.clone();
        many["sequence"] = json!(vec![0; 1_000_000]);
        many["centres_px"] = json!((0..1_000_000).map(|i| f64::from(i) * 1e-3).collect::<Vec<_>>());
        many.as_object_mut().unwrap().remove("order");
        assert!(read(&many).unwrap_err().contains("found 1000000"));
        many["sequence"] = json!(vec![0; 600]);
        many["centres_px"] = json!((0..600).collect::<Vec<_>>());
        assert!(read(&many).unwrap_err().contains("at most 512 slits"));
        many["sequence"] = json!([0, 1]);
        many["centres_px"] = json!([3, 9]);
        many["palette"] = json!(vec![[1, 2, 3]; 100_000]);
        assert!(read(&many).unwrap_err().contains("1 to 64 colours"));
        let mut swapped = stripes.clone();
        swapped["centres_px"][5] = json!(7.5);
        assert!(read(&swapped).unwrap_err().contains("centres_px[5]"));
        assert!(read_pattern(&b"\x89PNG"[..]).unwrap_err().to_string().contains("a PNG picture"));
        assert!(read_pattern(&b"[1, NaN]"[..]).is_err());
        assert!(read_pattern(&b"7"[..]).unwrap_err().to_string().contains("schema"));
    }
}
