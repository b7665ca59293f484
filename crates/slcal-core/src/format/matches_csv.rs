//! Matches as CSV: one row per stripe and image line.

use std::io::{BufRead as _, BufReader, Read, Write};

use nalgebra::Point2;

use super::budget::{Budget, Metered};
use super::recognise::refuse_others;
use crate::cloud::CloudPoint;
use crate::error::{Error, ErrorSubject, Result};
use crate::matches::{Match, Matches};

/// The columns that are read.
const COLUMNS: [&str; 7] = ["u", "v", "projector_column", "projector_row", "slit", "confidence", "sigma_px"];

/// Columns of a file; those of other programs are ignored.
const MOST_COLUMNS: usize = 1000;

fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::MatchesFile, detail)
}

/// Writes `u,v,projector_column,slit,confidence,sigma_px` (`projector_row` for matches with rows; both, when a
/// match has both).
///
/// # Errors
/// [`Error::Io`] when the stream fails.
pub fn write_matches(matches: &Matches, output: impl Write) -> Result<()> {
    let write = |e: csv::Error| Error::writing(ErrorSubject::MatchesFile, e);
    let rows = matches.items.iter().any(|m| m.projector_row.is_some());
    let columns = !rows || matches.items.iter().any(|m| m.projector_column.is_some());
    let mut out = csv::WriterBuilder::new().from_writer(output);
    let mut header = vec!["u", "v"];
    header.extend(columns.then_some("projector_column"));
    header.extend(rows.then_some("projector_row"));
    header.extend(["slit", "confidence", "sigma_px"]);
    out.write_record(&header).map_err(write)?;
    let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
    for m in &matches.items {
        let mut record = vec![short(m.camera.x), short(m.camera.y)];
        record.extend(columns.then(|| number(m.projector_column)));
        record.extend(rows.then(|| number(m.projector_row)));
        let slit = m.slit.map_or(String::new(), |s| s.to_string());
        record.extend([slit, short(m.confidence), short(m.sigma_px)]);
        out.write_record(&record).map_err(write)?;
    }
    out.flush().map_err(|e| Error::writing(ErrorSubject::MatchesFile, e))
}

/// At most five decimals (1e-5 px is far below any measurement), without trailing zeros.
fn short(x: f64) -> String {
    // Larger numbers have fewer decimals; rounded, they would change every time that they are written.
    const LARGE: f64 = 1e9;
    format!("{}", if x.abs() < LARGE { (x * 1e5).round() / 1e5 } else { x })
}

/// Reads matches: `u`, `v` and at least one of `projector_column` and `projector_row`, in any order of columns; `slit`,
/// `confidence` and `sigma_px` may be missing, other columns are ignored. A cell may be empty where it is optional.
///
/// # Errors
/// [`Error::Malformed`] naming the line and the column.
pub fn read_matches(input: impl Read) -> Result<Matches> {
    let budget = Budget::of_stream(ErrorSubject::MatchesFile);
    let mut input = BufReader::new(Metered::of_lines(input, &budget));
    let start = input.fill_buf().map_err(unreadable)?;
    refuse_others(start, ErrorSubject::MatchesFile, &["a file of matches"])?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(input);
    let headers = reader.headers().map_err(|e| broken(&e))?.clone();
    if headers.len() > MOST_COLUMNS {
        let found = headers.len();
        return Err(malformed(format!("expected at most {MOST_COLUMNS} columns, found {found}")));
    }
    let bare = |h: &str| h.trim_start_matches('\u{feff}').to_owned();
    let names: Vec<String> = headers.iter().map(bare).collect();
    let place = |name: &str| names.iter().position(|n| n == name);
    if let Some(name) = COLUMNS.iter().find(|&name| names.iter().filter(|n| n == name).count() > 1) {
        return Err(malformed(format!("the header names column \"{name}\" twice")));
    }
    let need = |name: &str| {
        place(name).ok_or_else(|| {
            let found: Vec<&str> = headers.iter().take(12).collect();
            malformed(format!(
                "expected a header with column \"{name}\" and commas between the columns, found \"{}\"",
                found.join(",")
            ))
        })
    };
    let (u, v) = (need("u")?, need("v")?);
    let (column, row) = (place("projector_column"), place("projector_row"));
    if column.is_none() && row.is_none() {
        need("projector_column")?;
    }
    let [slit, confidence, sigma] = ["slit", "confidence", "sigma_px"].map(place);
    let mut items = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| broken(&e))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |i: Option<usize>| -> Result<Option<f64>> {
            let Some((i, text)) = i.and_then(|i| Some((i, record.get(i)?))).filter(|(_, t)| !t.is_empty())
            else {
                return Ok(None);
            };
            match text.parse::<f64>() {
                Ok(x) if x.is_finite() => Ok(Some(x)),
                _ => {
                    let name = headers.get(i).unwrap_or_default();
                    Err(malformed(format!("line {line}, column {name}: \"{text}\" is not a finite number")))
                }
            }
        };
        let given = |i: usize| {
            number(Some(i))?
                .ok_or_else(|| malformed(format!("line {line}: no {}", headers.get(i).unwrap_or_default())))
        };
        let (projector_column, projector_row) = (number(column)?, number(row)?);
        if projector_column.is_none() && projector_row.is_none() {
            return Err(malformed(format!("line {line}: neither projector_column nor projector_row")));
        }
        let whole = |x: f64| (x.fract() == 0.0 && (0.0..65535.0).contains(&x)).then_some(x as u16);
        let slit = match number(slit)? {
            None => None,
            Some(x) => {
                Some(whole(x).ok_or_else(|| malformed(format!("line {line}: slit {x} is no slit number")))?)
            }
        };
        let sigma_px = number(sigma)?.unwrap_or(Match::DEFAULT_SIGMA_PX);
        if sigma_px < 0.0 {
            return Err(malformed(format!("line {line}: sigma_px {sigma_px} is negative")));
        }
        let confidence = number(confidence)?.unwrap_or(1.0);
        if !(0.0..=1.0).contains(&confidence) {
            return Err(malformed(format!(
                "line {line}: expected a confidence from 0 to 1, found {confidence}"
            )));
        }
        let camera = Point2::new(given(u)?, given(v)?);
        budget.keep(size_of::<Match>() + size_of::<CloudPoint>())?;
        let found = Match::at(camera, projector_column, projector_row);
        items.push(Match { slit, confidence, sigma_px, ..found });
    }
    Ok(Matches { items })
}

fn broken(e: &csv::Error) -> Error {
    if let csv::ErrorKind::Io(io) = e.kind() {
        return unreadable(std::io::Error::new(io.kind(), io.to_string()));
    }
    malformed(e.to_string())
}

fn unreadable(e: std::io::Error) -> Error {
    if e.kind() == std::io::ErrorKind::InvalidData {
        return malformed(e.to_string());
    }
    Error::reading(ErrorSubject::MatchesFile, e)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn a_match() -> Match {
        Match {
            camera: Point2::new(12.345_678_9, 7.0),
            projector_column: Some(23.5),
            projector_row: None,
            slit: Some(1),
            confidence: 0.9,
            sigma_px: 0.05,
            color: [255; 3],
        }
    }

    #[test]
    fn rounding_twice_is_rounding_once() {
        for x in [0.123_456_7, -885.463_025, 1e9 - 0.123_456, 3.914_639e55, 0.711_111e70, f64::MAX] {
            let once = short(x);
            assert_eq!(short(once.parse().unwrap()), once);
            assert!((once.parse::<f64>().unwrap() - x).abs() <= 5.1e-6 * x.abs().max(1.0));
        }
    }

    #[test]
    fn what_is_written_is_read_to_a_hundred_thousandth_of_a_pixel() {
        let row = Match { projector_column: None, projector_row: Some(4.0), slit: None, ..a_match() };
        let both = Match { projector_row: Some(9.25), ..a_match() };
        for items in [vec![a_match()], vec![row], vec![a_match(), row, both]] {
            let mut text = Vec::new();
            write_matches(&Matches { items: items.clone() }, &mut text).unwrap();
            let read = read_matches(&text[..]).unwrap().items;
            for (a, b) in items.iter().zip(&read) {
                assert!((a.camera - b.camera).norm() < 1e-5);
                assert_eq!(Match { camera: b.camera, ..*a }, *b);
            }
        }
    }

    #[test]
    fn the_header_is_that_of_the_interface() {
        let mut text = Vec::new();
        write_matches(&Matches { items: vec![a_match()] }, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text, "u,v,projector_column,slit,confidence,sigma_px\n12.34568,7,23.5,1,0.9,0.05\n");
    }

    #[test]
    fn files_from_elsewhere_may_hold_more_or_less() {
        let text = "projector_row, note, v, u\n 5 , x, 2, 1.5\n";
        let m = read_matches(text.as_bytes()).unwrap().items[0];
        assert_eq!((m.camera, m.projector_row, m.projector_column), (Point2::new(1.5, 2.0), Some(5.0), None));
        assert_eq!((m.confidence, m.sigma_px, m.slit), (1.0, 0.1, None));
    }

    #[test]
    fn columns_lines_and_rows_are_limited() {
        let says = |text: String, what: &str| {
            let message = read_matches(text.as_bytes()).map(drop).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        };
        let header = "u,v,projector_column";
        assert!(read_matches(format!("{header}{}\n", ",x".repeat(997)).as_bytes()).is_ok());
        says(format!("{header}{}\n", ",x".repeat(998)), "at most 1000 columns, found 1001");
        says(format!("{header}{}", ",x".repeat(1 << 20)), "lines of at most 1048576 bytes");
        says(format!("{header}\n{}", "0,0,0\n".repeat(2_000_000)), "MB of memory");
        assert!(read_matches(format!("{header}\n{}", "612.5,100,333\n".repeat(500_000)).as_bytes()).is_ok());
    }

    #[test]
    fn broken_files_name_line_and_column() {
        let says = |text: &str, what: &str| {
            let message = read_matches(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        };
        says("", "column \"u\"");
        says("x,y\n1,2\n", "found \"x,y\"");
        says("u;v;projector_column\n1;2;3\n", "commas");
        says("u,v,projector_column,u\n1,2,3,4\n", "\"u\" twice");
        says("u,v\n1,2\n", "projector_column");
        says("u,v,projector_column\n1,2,3\n1,zwei,3\n", "line 3, column v");
        says("u,v,projector_column\n1,nan,3\n", "not a finite number");
        says("u,v,projector_column\n1,2,\n", "neither");
        says("u,v,projector_column\n1,2\n", "line");
        says("u,v,projector_column,slit\n1,2,3,1.5\n", "slit");
        says("u,v,projector_column,sigma_px\n1,2,3,-1\n", "negative");
        says("u,v,projector_column,confidence\n1,2,3,7\n", "from 0 to 1, found 7");
    }
}
