//! Marks at the corners of the panel and at the middles of its sides: they show whether the whole picture is seen, and which
//! way round.

use nalgebra::Point2;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::error::{Error, Result};

/// Most of the room between board and border that a mark may take: the background next to the board, by which the board is
/// told from its neighbours, stays free.
const SHARE_OF_MARGIN: f64 = 0.3;
/// Smallest mark, px: below, its hole is no wider than the blur of a projector.
const MIN_SIDE_PX: u32 = 8;
/// From a mark to the second one beside it, in sides.
const SECOND: f64 = 1.5;

/// Square rings in the colour that the background has not, each with a hole half as wide as itself. They touch the border of
/// the panel.
///
/// Beside the marks at the top left corner, the middle of the upper and the middle of the left side stands a second one, so that a
/// mirrored picture differs from an upright one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PanelMarks {
    /// Outer side of a ring, px; its hole is half as wide.
    pub side_px: f64,
    /// Middle of each ring, projector px.
    #[serde(serialize_with = "to_rows", deserialize_with = "from_rows")]
    pub centres_px: Vec<Point2<f64>>,
}

fn to_rows<S: Serializer>(points: &[Point2<f64>], to: S) -> std::result::Result<S::Ok, S::Error> {
    to.collect_seq(points.iter().map(|p| [p.x, p.y]))
}

fn from_rows<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Vec<Point2<f64>>, D::Error> {
    Ok(Vec::<[f64; 2]>::deserialize(from)?.into_iter().map(Point2::from).collect())
}

impl PanelMarks {
    /// Marks for a panel on which `margin_px` are free between the board and the nearest border, at most `most_px` wide, on whole
    /// pixels.
    ///
    /// # Errors
    /// [`Error::Invalid`] where there is no room for them.
    pub(super) fn around(panel: [u32; 2], margin_px: f64, most_px: f64) -> Result<Self> {
        // A multiple of four: the hole's border lies on whole pixels, too.
        let side = ((SHARE_OF_MARGIN * margin_px).min(most_px) / 4.0).floor().max(0.0) as u32 * 4;
        if side < MIN_SIDE_PX {
            return Err(Error::invalid(
                "marks",
                format!(
                    "{:.0} px of background around the board or more: marks are {MIN_SIDE_PX} px wide at least and leave the rest free",
                    f64::from(MIN_SIDE_PX) / SHARE_OF_MARGIN
                ),
                format!("{margin_px:.0} px"),
            ));
        }
        let from_border = |pixels: u32| f64::from(pixels) + (f64::from(side) - 1.0) / 2.0;
        let places = |size: u32| [0, (size - side) / 2, size - side].map(from_border);
        let ([left, middle, right], [top, centre, bottom]) = (places(panel[0]), places(panel[1]));
        let second = SECOND * f64::from(side);
        let centres = [
            (left, top),
            (middle, top),
            (right, top),
            (right, centre),
            (right, bottom),
            (middle, bottom),
            (left, bottom),
            (left, centre),
            (left + second, top),
            (middle + second, top),
            (left, centre + second),
        ];
        Ok(Self { side_px: f64::from(side), centres_px: centres.map(|(x, y)| Point2::new(x, y)).to_vec() })
    }

    /// With left and right exchanged on a panel whose last column is `right`.
    pub(super) fn mirrored(&self, right: f64) -> Self {
        let centres_px = self.centres_px.iter().map(|c| Point2::new(right - c.x, c.y)).collect();
        Self { centres_px, ..self.clone() }
    }

    /// Checks that every mark has a size and lies on the panel.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub(super) fn validate(&self, [w, h]: [u32; 2]) -> Result<()> {
        if !(self.side_px.is_finite() && self.side_px > 0.0) {
            return Err(Error::invalid("marks.side_px", "a positive length", self.side_px));
        }
        let (most_x, most_y) = (f64::from(w), f64::from(h));
        let outside = |p: &&Point2<f64>| !((-1.0..=most_x).contains(&p.x) && (-1.0..=most_y).contains(&p.y));
        match self.centres_px.iter().find(outside) {
            Some(p) => {
                let expected = format!("points on the panel of {w}x{h} px");
                Err(Error::invalid("marks.centres_px", expected, format!("({}, {})", p.x, p.y)))
            }
            None => Ok(()),
        }
    }

    /// Whether a point lies on a ring (`Some(true)`), in the hole of one (`Some(false)`), or beside all of them.
    pub(crate) fn at(&self, p: Point2<f64>) -> Option<bool> {
        let half = self.side_px / 2.0;
        let within = |c: &&Point2<f64>, reach: f64| (p.x - c.x).abs() < reach && (p.y - c.y).abs() < reach;
        let mark = self.centres_px.iter().find(|c| within(c, half))?;
        Some(!within(&mark, half / 2.0))
    }

    /// Distance of a point from the nearest border of a ring or a hole, px.
    pub(crate) fn edge_distance_px(&self, p: Point2<f64>) -> f64 {
        let from_square = |c: &Point2<f64>, half: f64| {
            let (x, y) = ((p.x - c.x).abs() - half, (p.y - c.y).abs() - half);
            if x < 0.0 && y < 0.0 { -x.max(y) } else { x.max(0.0).hypot(y.max(0.0)) }
        };
        let half = self.side_px / 2.0;
        let nearest = |c: &Point2<f64>| from_square(c, half).min(from_square(c, half / 2.0));
        self.centres_px.iter().map(nearest).fold(f64::INFINITY, f64::min)
    }

    /// Which marks and holes a row crosses, as a number that is the same for rows that cross the same ones.
    pub(super) fn row(&self, y: f64) -> i64 {
        let crosses = |c: &Point2<f64>, reach: f64| i64::from((y - c.y).abs() < reach);
        let half = self.side_px / 2.0;
        self.centres_px
            .iter()
            .fold(0, |id: i64, c| id.wrapping_mul(3).wrapping_add(crosses(c, half) + crosses(c, half / 2.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks() -> PanelMarks {
        PanelMarks::around([1024, 768], 192.0, 48.0).unwrap()
    }

    #[test]
    fn they_touch_every_corner_and_the_middle_of_every_side() {
        let marks = marks();
        assert_eq!(marks.side_px, 48.0);
        let on_ring = |x: f64, y: f64| marks.at(Point2::new(x, y)) == Some(true);
        for (x, y) in [(0.0, 0.0), (1023.0, 0.0), (1023.0, 767.0), (0.0, 767.0)] {
            assert!(on_ring(x, y), "corner {x}, {y}");
        }
        for (x, y) in [(511.5, 0.0), (1023.0, 383.5), (511.5, 767.0), (0.0, 383.5)] {
            assert!(on_ring(x, y), "side {x}, {y}");
        }
        assert_eq!(marks.at(Point2::new(23.5, 23.5)), Some(false));
        assert_eq!(marks.at(Point2::new(11.4, 23.5)), Some(true));
        assert_eq!(marks.at(Point2::new(48.0, 23.5)), None);
        marks.validate([1024, 768]).unwrap();
        assert!(marks.validate([640, 768]).is_err());
    }

    #[test]
    fn the_nearest_edge_is_that_of_a_ring_or_of_its_hole() {
        let marks = marks();
        let distance = |x: f64, y: f64| marks.edge_distance_px(Point2::new(x, y));
        // The first ring reaches from -0.5 to 47.5, its hole from 11.5 to 35.5.
        assert_eq!(distance(23.5, 23.5), 12.0);
        assert_eq!(distance(45.5, 23.5), 2.0);
        assert_eq!(distance(50.5, 51.5), 5.0);
        assert_eq!(distance(10.5, 30.0), 1.0);
    }

    #[test]
    fn no_mirrored_picture_has_the_same_marks() {
        let marks = marks();
        let flips: [fn(Point2<f64>) -> Point2<f64>; 3] = [
            |p| Point2::new(1023.0 - p.x, p.y),
            |p| Point2::new(p.x, 767.0 - p.y),
            |p| Point2::new(1023.0 - p.x, 767.0 - p.y),
        ];
        for flip in flips {
            let elsewhere = marks.centres_px.iter().filter(|c| !marks.centres_px.contains(&flip(**c)));
            assert!(elsewhere.count() >= 2);
        }
    }

    #[test]
    fn a_row_is_told_from_the_next_where_a_ring_or_a_hole_begins() {
        let marks = marks();
        let rows: Vec<i64> = (0..768).map(|y| marks.row(f64::from(y))).collect();
        let changes: Vec<usize> = (1..768).filter(|&y| rows[y] != rows[y - 1]).collect();
        // Rings at the top, two at the left and one at the right of the middle, rings at the bottom, each with its hole.
        assert_eq!(changes, [12, 36, 48, 360, 372, 396, 408, 432, 444, 468, 480, 720, 732, 756]);
    }

    #[test]
    fn a_board_that_leaves_no_room_is_refused() {
        let error = PanelMarks::around([1024, 768], 20.0, 48.0).unwrap_err().to_string();
        assert!(error.contains("27 px of background") && error.contains("20 px"), "{error}");
    }
}
