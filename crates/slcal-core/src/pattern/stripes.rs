//! Coloured slits that are identified by the colours of their neighbours.

use serde::{Deserialize, Serialize};

use super::de_bruijn::de_bruijn;
use super::panel::check_panel;
use crate::error::{Error, ErrorSubject, Result, within};
use crate::named::named;

/// Direction of the slits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// Vertical slits, each at one projector column.
    #[default]
    Columns,
    /// Horizontal slits, each at one projector row.
    Rows,
}

named!(Axis, "axis", { Columns => "columns", Rows => "rows" });

impl Axis {
    /// 0 for columns, which are counted along x, 1 for rows.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Columns => 0,
            Self::Rows => 1,
        }
    }
}

/// A multi-slit pattern: coloured slits between black bands (paper, section 3; J. Pagès, J. Salvi, C. Collewet,
/// J. Forest, "Optimised De Bruijn patterns for one-shot shape acquisition", Image and Vision Computing 23:707-720, 2005).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StripePattern {
    /// Width and height of the panel, px.
    pub projector: [u32; 2],
    /// Direction of the slits.
    pub axis: Axis,
    /// Colours of the hues, sRGB code values.
    pub palette: Vec<[u8; 3]>,
    /// Hue of each slit: an index into `palette`.
    pub sequence: Vec<u8>,
    /// Projector column (row) of each slit's centre, px, ascending.
    pub centres_px: Vec<f64>,
    /// Width of the slits, px.
    pub width_px: f64,
    /// Every window of this many neighbouring colours occurs at most once.
    pub order: u32,
}

/// Layout of a stripe pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StripeConfig {
    /// Number of hues, 2 to 12 (a camera cannot distinguish neighbouring hues of more).
    pub hues: u32,
    /// Length of the window of colours that occurs once.
    pub order: u32,
    /// Number of slits, at most hues^order + order − 1; `None`: 64, or as many as there are when that is fewer.
    pub slits: Option<u32>,
    /// Direction of the slits.
    pub axis: Axis,
    /// Lit share of the period, between 0.1 and 0.9.
    pub lit: f64,
}

impl Default for StripeConfig {
    fn default() -> Self {
        Self { hues: 4, order: 3, slits: None, axis: Axis::Columns, lit: 0.5 }
    }
}

/// Default number of slits (paper, section 3).
const DEFAULT_SLITS: u32 = 64;
/// Hues beyond this are less than 30° apart.
const MAX_HUES: u32 = 12;
/// Largest palette of other programs: far more colours than a camera can distinguish. Decoding takes memory for each.
const MAX_PALETTE: usize = 64;

impl StripeConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        within("hues", self.hues, [2, MAX_HUES], "")?;
        within("lit share of the period", self.lit, [0.1, 0.9], "")?;
        let windows = de_bruijn(self.hues, self.order)?.len();
        let most = windows + self.order as usize - 1;
        let slits = self.slits.unwrap_or(DEFAULT_SLITS.min(most as u32)) as usize;
        if !(3..=most).contains(&slits) {
            return Err(Error::invalid(
                "slits",
                format!(
                    "3 to {most}: {} hues of order {} make {windows} different windows (more hues or a higher order make more)",
                    self.hues, self.order
                ),
                slits,
            ));
        }
        Ok(())
    }
}

impl StripePattern {
    /// Equally spaced slits over the whole panel, coloured by a De Bruijn sequence; widths and positions are whole
    /// pixels, so that what is projected is what the pattern says.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a configuration out of range, or slits so many that a slit or the gap between two would
    /// be thinner than a pixel.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::{StripeConfig, StripePattern};
    ///
    /// let stripes = StripePattern::new([1024, 768], &StripeConfig::default())?;
    /// assert_eq!((stripes.centres_px.len(), stripes.width_px), (64, 8.0));
    /// assert_eq!(stripes.image()?.dimensions(), (1024, 768)); // what to project
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    pub fn new(projector: [u32; 2], config: &StripeConfig) -> Result<Self> {
        check_panel(projector)?;
        config.validate()?;
        let mut sequence = de_bruijn(config.hues, config.order)?;
        let head = sequence[..config.order as usize - 1].to_vec();
        sequence.extend(head);
        let slits = config.slits.unwrap_or(DEFAULT_SLITS.min(sequence.len() as u32));
        sequence.truncate(slits as usize);
        let length = f64::from(if config.axis == Axis::Columns { projector[0] } else { projector[1] });
        let period = length / f64::from(slits);
        let width_px = (period * config.lit).round().max(1.0);
        if period - width_px < 1.0 {
            return Err(Error::invalid(
                "slits",
                format!(
                    "at most {} on {length} px: a slit and a gap need a pixel each",
                    (length / 2.0).floor()
                ),
                slits,
            ));
        }
        let centre = |i: u32| {
            let left = ((f64::from(i) + 0.5) * period - width_px / 2.0).round();
            left + (width_px - 1.0) / 2.0
        };
        Ok(Self {
            projector,
            axis: config.axis,
            palette: (0..config.hues).map(|i| pure_hue(f64::from(i) / f64::from(config.hues))).collect(),
            sequence,
            centres_px: (0..slits).map(centre).collect(),
            width_px,
            order: config.order,
        })
    }

    /// The same picture with left and right exchanged, as a pattern of its own: where each slit lies on the panel of a projector that
    /// shows pictures mirrored. Vertical slits are then counted from the other end.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::{StripeConfig, StripePattern};
    ///
    /// let stripes = StripePattern::new([1024, 768], &StripeConfig::default())?;
    /// let flipped = image::imageops::flip_horizontal(&stripes.image()?);
    /// assert_eq!(stripes.mirrored().image()?, flipped);
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mut mirrored = self.clone();
        if self.axis == Axis::Columns {
            let right = self.length_px() - 1.0;
            mirrored.sequence.reverse();
            mirrored.centres_px = self.centres_px.iter().rev().map(|c| right - c).collect();
        }
        mirrored
    }

    /// Length of the panel across the slits, px.
    #[must_use]
    pub fn length_px(&self) -> f64 {
        f64::from(if self.axis == Axis::Columns { self.projector[0] } else { self.projector[1] })
    }

    /// Median distance between neighbouring centres, px; the panel's length for a single slit.
    #[must_use]
    pub fn period_px(&self) -> f64 {
        let mut gaps: Vec<f64> = self.centres_px.windows(2).map(|w| w[1] - w[0]).collect();
        gaps.sort_by(f64::total_cmp);
        gaps.get(gaps.len() / 2).copied().unwrap_or_else(|| self.length_px())
    }

    /// Checks that the fields agree with each other; patterns from elsewhere need not be De Bruijn sequences.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field, what it holds and what it should.
    pub fn validate(&self) -> Result<()> {
        check_panel(self.projector)?;
        let n = self.sequence.len();
        if !(1..=usize::from(u16::MAX)).contains(&n) {
            return Err(Error::invalid("sequence", "1 to 65535 slits", n));
        }
        if self.centres_px.len() != n {
            return Err(Error::invalid(
                "centres_px",
                format!("one centre for each of the {n} slits of the sequence"),
                self.centres_px.len(),
            ));
        }
        // A slit and the gap beside it need a pixel each.
        let most = (self.length_px() / 2.0).ceil() as usize;
        if n > most {
            let expected = format!("at most {most} slits on a panel of {} px", self.length_px());
            return Err(Error::invalid("sequence", expected, format!("{n} slits")));
        }
        let hues = self.palette.len();
        if !(1..=MAX_PALETTE).contains(&hues) {
            return Err(Error::invalid("palette", format!("1 to {MAX_PALETTE} colours"), hues));
        }
        if let Some((i, s)) = self.sequence.iter().enumerate().find(|(_, s)| usize::from(**s) >= hues) {
            return Err(Error::invalid(
                ErrorSubject::Element { list: "sequence", index: i },
                format!("an index into the palette of {hues} colours"),
                s,
            ));
        }
        let inside = -0.5..=self.length_px() - 0.5;
        if let Some((i, c)) = self.centres_px.iter().enumerate().find(|(_, c)| !inside.contains(*c)) {
            return Err(Error::invalid(
                ErrorSubject::Element { list: "centres_px", index: i },
                format!("a position on the panel, {} to {}", inside.start(), inside.end()),
                c,
            ));
        }
        if let Some(i) = self.centres_px.windows(2).position(|w| w[0] >= w[1]) {
            return Err(Error::invalid(
                ErrorSubject::Element { list: "centres_px", index: i + 1 },
                format!("ascending positions, more than {}", self.centres_px[i]),
                self.centres_px[i + 1],
            ));
        }
        if !(self.width_px.is_finite()
            && self.width_px > 0.0
            && (n == 1 || self.width_px < 2.0 * self.period_px()))
        {
            return Err(Error::invalid(
                "width_px",
                "a positive width below the distance of the slits",
                self.width_px,
            ));
        }
        if self.order == 0 {
            return Err(Error::invalid("order", "at least 1", 0));
        }
        Ok(())
    }
}

/// The fully saturated colour of a hue (0–1 around the circle): the largest possible difference between N colours of
/// a projector with three primaries.
fn pure_hue(hue: f64) -> [u8; 3] {
    [0.0, 2.0, 4.0].map(|shift: f64| {
        let distance = (hue * 6.0 - shift + 3.0).rem_euclid(6.0) - 3.0;
        // Rounded to a twentieth of a level first: 127.5 must not fall to either side by rounding error.
        let level = (2.0 - distance.abs()).clamp(0.0, 1.0) * 255.0;
        ((level * 20.0).round() / 20.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::unique_window;

    #[test]
    fn the_default_is_the_pattern_of_the_paper() {
        let p = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
        assert_eq!(p.palette, [[255, 0, 0], [128, 255, 0], [0, 255, 255], [128, 0, 255]]);
        assert_eq!(p.sequence[..12], [0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 1]);
        assert_eq!((p.sequence.len(), p.centres_px[0], p.centres_px[63]), (64, 7.5, 1015.5));
        assert_eq!((p.width_px, p.period_px(), p.order), (8.0, 16.0, 3));
        p.validate().unwrap();
    }

    #[test]
    fn any_hues_orders_and_panels_give_unique_windows_and_lit_pixels_where_they_say() {
        for (hues, order, slits) in
            [(3, 4, Some(61)), (5, 3, Some(127)), (2, 6, None), (3, 2, None), (6, 2, Some(37))]
        {
            let config = StripeConfig { hues, order, slits, axis: Axis::Rows, ..StripeConfig::default() };
            let p = StripePattern::new([854, 481], &config).unwrap();
            p.validate().unwrap();
            assert!(unique_window(&p.sequence) <= order as usize);
            let image = p.image().unwrap();
            for (c, &s) in p.centres_px.iter().zip(&p.sequence) {
                let lit = (c - (p.width_px - 1.0) / 2.0) as u32;
                assert_eq!(image.get_pixel(400, lit).0, p.palette[usize::from(s)]);
            }
        }
    }

    #[test]
    fn impossible_layouts_are_refused_with_a_reason() {
        let with = |f: fn(&mut StripeConfig)| {
            let mut c = StripeConfig::default();
            f(&mut c);
            StripePattern::new([1024, 768], &c).map_err(|e| e.to_string())
        };
        assert!(with(|c| c.hues = 1).unwrap_err().contains("hues"));
        assert!(with(|c| c.slits = Some(67)).unwrap_err().contains("3 to 66"));
        assert!(with(|c| c.slits = Some(66)).is_ok());
        assert!(with(|c| c.slits = Some(0)).is_err());
        assert!(with(|c| c.order = 0).is_err());
        assert!(with(|c| c.lit = f64::NAN).is_err());
        assert!(StripePattern::new([64, 64], &StripeConfig::default()).is_err());
        assert!(StripePattern::new([0, 768], &StripeConfig::default()).is_err());
    }
}
