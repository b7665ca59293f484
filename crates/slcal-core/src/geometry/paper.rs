//! Sizes that sheets usually have: papers with names, boards, and proportions of screens.

use super::rectangle::RectangleSize;

/// Names of papers and their sizes upright, mm: ISO 216 and ANSI/ASME Y14.1.
const PAPERS: [(&str, f64, f64); 20] = [
    ("A0", 841.0, 1189.0),
    ("A1", 594.0, 841.0),
    ("A2", 420.0, 594.0),
    ("A3", 297.0, 420.0),
    ("A4", 210.0, 297.0),
    ("A5", 148.0, 210.0),
    ("A6", 105.0, 148.0),
    ("letter", 215.9, 279.4),
    ("legal", 215.9, 355.6),
    ("tabloid", 279.4, 431.8),
    ("ANSI-C", 431.8, 558.8),
    ("ANSI-D", 558.8, 863.6),
    ("ANSI-E", 863.6, 1117.6),
    ("B0", 1000.0, 1414.0),
    ("B1", 707.0, 1000.0),
    ("B2", 500.0, 707.0),
    ("B3", 353.0, 500.0),
    ("B4", 250.0, 353.0),
    ("B5", 176.0, 250.0),
    ("B6", 125.0, 176.0),
];
/// Of these, the first ones lie on desks; a size in millimetres is mistaken for one of the others by chance.
const ON_DESKS: usize = 10;
/// Boards and posters as they are sold, mm upright.
const BOARDS: [(&str, f64, f64); 6] = [
    ("16x20in", 406.4, 508.0),
    ("18x24in", 457.2, 609.6),
    ("20x30in", 508.0, 762.0),
    ("24x36in", 609.6, 914.4),
    ("50x70cm", 500.0, 700.0),
    ("70x100cm", 700.0, 1000.0),
];
/// Long side to short side of sheets and screens of no standard size.
const PROPORTIONS: [(&str, f64); 6] =
    [("1:1", 1.0), ("5:4", 1.25), ("4:3", 4.0 / 3.0), ("3:2", 1.5), ("16:10", 1.6), ("16:9", 16.0 / 9.0)];

/// How far the sides of a sheet may be off those of the paper that it is, as a share.
const PAPER_TOLERANCE: f64 = 0.01;
/// Ratios of sides that differ by less than this part belong to one proportion: papers are cut to half a millimetre.
const SAME_PROPORTION: f64 = 0.004;
/// Another sheet is taken for the one that was meant when its area is within this factor: the next paper of the same
/// proportion has twice the area.
const NEAR_AREA: f64 = 2.1;

/// A sheet of a usual size, upright.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UsualSheet {
    /// Its name, as it may be typed, or its proportion.
    pub(crate) name: &'static str,
    pub(crate) size: RectangleSize,
}

/// A proportion of sides, with the sheets that have it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct UsualProportion {
    /// Those whose size is near, nearest first; at least one.
    pub(crate) sheets: Vec<UsualSheet>,
}

fn sheet(&(name, width_mm, height_mm): &(&'static str, f64, f64)) -> UsualSheet {
    UsualSheet { name, size: RectangleSize { width_mm, height_mm } }
}

/// The paper of a name, in capitals or not.
pub(super) fn named(name: &str) -> Option<UsualSheet> {
    PAPERS.iter().find(|paper| paper.0.eq_ignore_ascii_case(name)).map(sheet)
}

impl RectangleSize {
    /// The names of papers that [`FromStr`](std::str::FromStr) knows; each of them may be followed by `-landscape` or
    /// `-portrait`.
    pub fn paper_names() -> impl Iterator<Item = &'static str> {
        PAPERS.iter().map(|paper| paper.0)
    }

    /// The name of the paper that has exactly this size, upright or lying across.
    #[must_use]
    pub fn paper(&self) -> Option<&'static str> {
        let sides = self.short_and_long_mm();
        let equal = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
        PAPERS.iter().find(|p| equal(sides[0], p.1) && equal(sides[1], p.2)).map(|p| p.0)
    }
}

/// Whether a sheet is as large as one of the papers on desks, within a per cent.
pub(super) fn is_paper(size: RectangleSize) -> bool {
    PAPERS[..ON_DESKS].iter().any(|paper| is_like(size, sheet(paper).size))
}

/// The same for boards and the larger papers.
pub(super) fn is_board(size: RectangleSize) -> bool {
    PAPERS[ON_DESKS..].iter().chain(&BOARDS).any(|board| is_like(size, sheet(board).size))
}

fn is_like(size: RectangleSize, other: RectangleSize) -> bool {
    let (a, b) = (size.short_and_long_mm(), other.short_and_long_mm());
    a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < PAPER_TOLERANCE)
}

/// All usual proportions, each with the sheets that have it and are about as large as `like`.
pub(crate) fn usual_proportions(like: RectangleSize) -> Vec<UsualProportion> {
    let area = |s: &RectangleSize| s.width_mm * s.height_mm;
    let apart = |s: &UsualSheet| (area(&s.size) / area(&like)).ln().abs();
    let known = PAPERS.iter().chain(&BOARDS).map(sheet).filter(|s| apart(s) < NEAR_AREA.ln());
    let mut all: Vec<UsualProportion> = Vec::new();
    let same = |p: &UsualProportion, s: &UsualSheet| {
        (s.size.elongation() / p.sheets[0].size.elongation()).ln().abs() < SAME_PROPORTION
    };
    for next in known {
        match all.iter_mut().find(|p| same(p, &next)) {
            Some(proportion) => proportion.sheets.push(next),
            None => all.push(UsualProportion { sheets: vec![next] }),
        }
    }
    for &(name, ratio) in &PROPORTIONS {
        let width_mm = (area(&like) / ratio).sqrt();
        let next = UsualSheet { name, size: RectangleSize { width_mm, height_mm: width_mm * ratio } };
        if !all.iter().any(|p| same(p, &next)) {
            all.push(UsualProportion { sheets: vec![next] });
        }
    }
    for proportion in &mut all {
        proportion.sheets.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn proportions(width_mm: f64, height_mm: f64) -> Vec<Vec<&'static str>> {
        let all = usual_proportions(RectangleSize { width_mm, height_mm });
        all.iter().map(|p| p.sheets.iter().map(|s| s.name).collect()).collect()
    }

    #[test]
    fn papers_have_the_proportions_of_their_standards() {
        for (name, short, long) in PAPERS {
            let ratio: f64 = long / short;
            // ISO 216: the square root of two, in whole millimetres, of which halving drops a half.
            let iso = name.starts_with(['A', 'B']) && !name.starts_with("ANSI");
            assert!(!iso || (ratio * short - short * std::f64::consts::SQRT_2).abs() <= 1.5, "{name}");
            // All others are whole halves of an inch.
            let halves = [short, long].map(|mm| mm / 12.7);
            assert!(iso || halves.iter().all(|h| (h - h.round()).abs() < 1e-9), "{name}");
        }
    }

    #[test]
    fn sheets_near_a_size_are_listed_by_their_proportion() {
        let all = proportions(297.0, 420.0);
        assert!(all.contains(&vec!["A3", "B4", "A4", "B3", "A2"]) || all[0][0] == "A3", "{all:?}");
        assert!(all.contains(&vec!["tabloid"]) && all.contains(&vec!["16:9"]), "{all:?}");
        // Letter and ANSI C have one proportion.
        assert!(
            all.contains(&vec!["letter", "ANSI-C"]) || all.contains(&vec!["ANSI-C", "letter"]),
            "{all:?}"
        );
        // Poster sizes take the place of their bare proportion.
        let large = proportions(600.0, 900.0);
        assert!(large.contains(&vec!["24x36in", "20x30in"]), "{large:?}");
        assert!(!large.contains(&vec!["3:2"]), "{large:?}");
    }

    #[test]
    fn a_square_sheet_has_proportions_too() {
        assert!(proportions(300.0, 300.0).contains(&vec!["1:1"]));
    }
}
