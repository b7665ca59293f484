//! Sequences of pictures: Gray code, and sinusoids that are shifted from picture to picture.

use image::{GrayImage, Luma};
use serde::{Deserialize, Serialize};

use super::panel::check_panel;
use super::stripes::Axis;
use crate::error::{Error, ErrorSubject, Result, within};
use crate::named::named;

/// Most pictures of a sequence: three times what the longest one of any projector takes.
const MOST_FRAMES: usize = 256;
/// Shortest period of a sinusoid, px: a shorter one is no sinusoid in whole pixels.
const SHORTEST_PERIOD_PX: f64 = 4.0;
/// Fewest steps of a sinusoid: mean, amplitude and phase are three unknowns.
const FEWEST_STEPS: u32 = 3;
/// Most steps of a sinusoid.
const MOST_STEPS: u32 = 64;

/// A sequence of pictures that together give every projector pixel a code (J. Posdamer, M. Altschuler, "Surface measurement by
/// space-encoded projected beam systems", Computer Graphics and Image Processing 18:1-17, 1982; G. Sansoni, M. Carocci,
/// R. Rodella, "Three-dimensional vision based on a combination of Gray-code and phase-shift light projection", Applied Optics
/// 38:6565-6573, 1999).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequencePattern {
    /// Width and height of the panel, px.
    pub projector: [u32; 2],
    /// The pictures, in the order in which they are shown.
    pub frames: Vec<SequenceFrame>,
}

/// One picture of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequenceFrame {
    /// Name of the file of its picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// What it shows.
    #[serde(flatten)]
    pub light: FrameLight,
}

/// What a picture of a sequence shows. Of `Rows`, read row for column.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "is", rename_all = "lowercase")]
pub enum FrameLight {
    /// All white.
    White,
    /// All black.
    Black,
    /// White where bit `bit` of the Gray code of ⌊column / 2^dropped⌋ is set, black elsewhere; the other way round when `inverted`. Bit 0 is
    /// the least significant one. `dropped` is the number of bits of a column less those of the sequence.
    Bit {
        /// What is coded.
        #[serde(default)]
        axis: Axis,
        /// Which bit.
        bit: u32,
        /// Whether black and white are exchanged.
        #[serde(default)]
        inverted: bool,
    },
    /// (1 + cos 2π(column / `period_px` − `step` / `of`)) / 2 of white.
    Sinusoid {
        /// What is coded.
        #[serde(default)]
        axis: Axis,
        /// Its period, px.
        period_px: f64,
        /// Which shift, from 0.
        step: u32,
        /// Number of shifts in a period.
        of: u32,
    },
}

/// What a sequence codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SequenceAxes {
    /// Columns: for a projector beside the camera.
    #[default]
    Columns,
    /// Rows: for a projector above or below it.
    Rows,
    /// Both: for calibration.
    Both,
}

named!(SequenceAxes, "axis", { Columns => "columns", Rows => "rows", Both => "both" });

impl SequenceAxes {
    fn axes(self) -> &'static [Axis] {
        match self {
            Self::Columns => &[Axis::Columns],
            Self::Rows => &[Axis::Rows],
            Self::Both => &[Axis::Columns, Axis::Rows],
        }
    }
}

/// The order of pictures of another program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SequencePreset {
    /// `GrayCodePattern` of OpenCV: the bits of the columns, the most significant first, each followed by its inverse; those of the
    /// rows likewise; white; black.
    OpencvGray,
    /// SLStudio: white; black; the bits of the columns, the most significant first, without inverses.
    SlstudioGray,
}

named!(SequencePreset, "preset", { OpencvGray => "opencv-gray", SlstudioGray => "slstudio-gray" });

/// Settings of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SequenceConfig {
    /// What is coded.
    pub axes: SequenceAxes,
    /// Number of bits, the most significant ones. `None`: all, or with a sinusoid one more than tell its periods apart. A pixel at the border
    /// of a cell may be read as on its other side; half a period is the margin then, and no pixel is off by one.
    pub bits: Option<u32>,
    /// The sinusoid within a cell of the Gray code.
    pub sinusoid: Option<SinusoidConfig>,
}

/// Settings of the sinusoid of a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinusoidConfig {
    /// Its period, px.
    pub period_px: f64,
    /// Number of shifts. N of them are blind to the harmonics 2 to N − 2, which an unknown gamma makes.
    pub steps: u32,
}

impl Default for SinusoidConfig {
    fn default() -> Self {
        Self { period_px: 16.0, steps: 8 }
    }
}

/// The code of one axis of a sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisCode {
    /// Columns (rows) of the panel.
    pub extent: u32,
    /// Number of bits of the Gray code.
    pub bits: u32,
    /// Columns of a cell, over which the code is constant: 2^dropped.
    pub cell_px: u32,
    /// Period and number of steps of the sinusoid.
    pub sinusoid: Option<(f64, u32)>,
}

/// Bits that tell `extent` columns apart.
fn bits_of(extent: u32) -> u32 {
    (u32::BITS - extent.saturating_sub(1).leading_zeros()).max(1)
}

/// The Gray code of a number.
pub(crate) fn gray_code(number: u32) -> u32 {
    number ^ (number >> 1)
}

impl SequencePattern {
    /// White, black, and for each axis its bits, the most significant first, each followed by its inverse, then the steps of the
    /// sinusoid.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a panel without pixels or absurdly large, more bits than the panel has, a period below 4 px or above
    /// the panel's side, or one that the bits cannot tell from the next, and fewer than 3 steps or more than 64.
    pub fn new(projector: [u32; 2], config: &SequenceConfig) -> Result<Self> {
        check_panel(projector)?;
        let mut lights = vec![FrameLight::White, FrameLight::Black];
        for &axis in config.axes.axes() {
            let extent = projector[axis.index()];
            let all = bits_of(extent);
            let needed = match config.sinusoid {
                Some(SinusoidConfig { period_px, .. }) => {
                    within("period", period_px, [SHORTEST_PERIOD_PX, f64::from(extent)], " px")?;
                    (all + 1).saturating_sub(period_px.log2() as u32).min(all)
                }
                None => all,
            };
            lights.extend(bits(axis, kept(config.bits, needed, all)?, true));
            if let Some(SinusoidConfig { period_px, steps }) = config.sinusoid {
                check_steps(steps)?;
                lights.extend((0..steps).map(|step| FrameLight::Sinusoid {
                    axis,
                    period_px,
                    step,
                    of: steps,
                }));
            }
        }
        Self::of(projector, lights)
    }

    /// The sequence of another program. `bits` keeps the most significant ones.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`new`](Self::new).
    pub fn preset(projector: [u32; 2], preset: SequencePreset, kept_bits: Option<u32>) -> Result<Self> {
        check_panel(projector)?;
        let of = |axis: Axis, inverses| {
            let all = bits_of(projector[axis.index()]);
            kept(kept_bits, all, all).map(|n| bits(axis, n, inverses))
        };
        let lights = match preset {
            SequencePreset::OpencvGray => {
                let mut lights: Vec<_> = of(Axis::Columns, true)?.chain(of(Axis::Rows, true)?).collect();
                lights.extend([FrameLight::White, FrameLight::Black]);
                lights
            }
            SequencePreset::SlstudioGray => {
                let black_and_white = [FrameLight::White, FrameLight::Black];
                black_and_white.into_iter().chain(of(Axis::Columns, false)?).collect()
            }
        };
        Self::of(projector, lights)
    }

    fn of(projector: [u32; 2], lights: Vec<FrameLight>) -> Result<Self> {
        let name = |i| Some(format!("frame_{i:03}.png"));
        let frames = lights.into_iter().enumerate();
        let frames = frames.map(|(i, light)| SequenceFrame { file: name(i), light }).collect();
        let pattern = Self { projector, frames };
        pattern.validate()?;
        Ok(pattern)
    }

    /// Checks that the pictures make a code that can be read.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a panel of absurd size, more than 256 pictures, pictures that contradict each other, bits or steps
    /// that are missing or there twice, bits without inverses where white or black is missing, and a sinusoid whose periods the
    /// bits do not tell apart.
    pub fn validate(&self) -> Result<()> {
        check_panel(self.projector)?;
        if self.frames.len() > MOST_FRAMES {
            return Err(invalid(format!("at most {MOST_FRAMES} pictures"), self.frames.len()));
        }
        for light in [FrameLight::White, FrameLight::Black] {
            let n = self.frames.iter().filter(|f| f.light == light).count();
            if n > 1 {
                return Err(invalid(format!("{} once", name(&light)), format!("it {n} times")));
            }
        }
        let codes = [Axis::Columns, Axis::Rows].map(|axis| self.check_axis(axis));
        let [columns, rows] = codes;
        if columns?.is_none() && rows?.is_none() {
            return Err(invalid("bits or sinusoids of columns, rows, or both".into(), "none"));
        }
        Ok(())
    }

    /// The code of an axis, if the sequence codes it. For a sequence that is [valid](Self::validate).
    #[must_use]
    pub fn code(&self, axis: Axis) -> Option<AxisCode> {
        self.check_axis(axis).ok().flatten()
    }

    fn check_axis(&self, axis: Axis) -> Result<Option<AxisCode>> {
        let extent = self.projector[axis.index()];
        let all = bits_of(extent);
        // How often each bit is there, as it is and inverted.
        let mut seen = [[0_u32; 2]; 32];
        let mut steps: Vec<(f64, u32, u32)> = Vec::new();
        for (i, frame) in self.frames.iter().enumerate() {
            match frame.light {
                FrameLight::Bit { axis: a, bit, inverted } if a == axis => {
                    if bit >= all {
                        let expected = format!("a bit below {all}, as {extent} {axis} have");
                        return Err(element(i, &expected, bit));
                    }
                    seen[bit as usize][usize::from(inverted)] += 1;
                }
                FrameLight::Sinusoid { axis: a, period_px, step, of } if a == axis => {
                    let is_right = period_px.is_finite() && period_px >= SHORTEST_PERIOD_PX;
                    if !is_right {
                        let expected = format!("a period of {SHORTEST_PERIOD_PX} px or more");
                        return Err(element(i, &expected, period_px));
                    }
                    check_steps(of)?;
                    if step >= of {
                        return Err(element(i, &format!("a step below {of}"), step));
                    }
                    steps.push((period_px, step, of));
                }
                _ => {}
            }
        }
        let bits = seen.iter().rposition(|n| n[0] + n[1] > 0).map_or(0, |last| last as u32 + 1);
        if bits == 0 && steps.is_empty() {
            return Ok(None);
        }
        let both_levels = [FrameLight::White, FrameLight::Black]
            .iter()
            .all(|level| self.frames.iter().any(|f| f.light == *level));
        for (bit, n) in seen[..bits as usize].iter().enumerate() {
            if n[0].max(n[1]) > 1 {
                return Err(invalid("each picture once".into(), format!("bit {bit} of the {axis} twice")));
            }
            if n[0] + n[1] == 0 {
                return Err(invalid(
                    format!("all bits of the {axis} from 0 to {}", bits - 1),
                    format!("none of bit {bit}"),
                ));
            }
            if n[0] + n[1] == 1 && !both_levels {
                let expected = "white and black, or every bit with its inverse";
                return Err(invalid(expected.into(), format!("bit {bit} of the {axis} alone")));
            }
        }
        let cell_px = 1_u32 << (all - bits);
        let sinusoid = check_sinusoid(&steps, axis)?;
        if let Some((period, _)) = sinusoid
            && period < f64::from(extent)
            && period < f64::from(cell_px)
        {
            return Err(invalid(
                format!("cells of the Gray code no wider than a period of {period} px of the {axis}"),
                format!("{cell_px} px, by {bits} bits"),
            ));
        }
        Ok(Some(AxisCode { extent, bits, cell_px, sinusoid }))
    }

    /// The picture of a frame, 8 bit.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a frame that is not there, or a sequence that is not [valid](Self::validate).
    pub fn image(&self, frame: usize) -> Result<GrayImage> {
        self.validate()?;
        let n = self.frames.len();
        let light = self.frames.get(frame).ok_or_else(|| {
            Error::invalid(ErrorSubject::Named("frame of a sequence"), format!("below {n}"), frame)
        })?;
        let [width, height] = self.projector;
        let level = |at: u32| (255.0 * self.level(&light.light, at)).round() as u8;
        Ok(match light.light {
            FrameLight::White | FrameLight::Black => GrayImage::from_pixel(width, height, Luma([level(0)])),
            FrameLight::Bit { axis, .. } | FrameLight::Sinusoid { axis, .. } => {
                let levels: Vec<u8> = (0..self.projector[axis.index()]).map(level).collect();
                GrayImage::from_fn(width, height, |x, y| Luma([levels[[x, y][axis.index()] as usize]]))
            }
        })
    }

    /// The share of white that a frame has in a column (row).
    fn level(&self, light: &FrameLight, at: u32) -> f64 {
        match *light {
            FrameLight::White => 1.0,
            FrameLight::Black => 0.0,
            FrameLight::Bit { axis, bit, inverted } => {
                let cell_px = self.code(axis).map_or(1, |code| code.cell_px);
                let is_set = gray_code(at / cell_px) >> bit & 1 == 1;
                f64::from(u8::from(is_set != inverted))
            }
            FrameLight::Sinusoid { period_px, step, of, .. } => {
                let turns = f64::from(at) / period_px - f64::from(step) / f64::from(of);
                0.5 + 0.5 * (std::f64::consts::TAU * turns).cos()
            }
        }
    }
}

/// The number of bits that are kept.
fn kept(asked: Option<u32>, usual: u32, all: u32) -> Result<u32> {
    match asked {
        None => Ok(usual),
        Some(n) if (1..=all).contains(&n) => Ok(n),
        Some(n) => Err(Error::invalid("bits", format!("1 to {all}, as the panel has"), n)),
    }
}

/// The most significant bit first.
fn bits(axis: Axis, bits: u32, inverses: bool) -> impl Iterator<Item = FrameLight> {
    let of = move |bit| {
        let both = [false, true].map(|inverted| FrameLight::Bit { axis, bit, inverted });
        both.into_iter().take(1 + usize::from(inverses))
    };
    (0..bits).rev().flat_map(of)
}

fn check_steps(steps: u32) -> Result<()> {
    within("steps", steps, [FEWEST_STEPS, MOST_STEPS], "")
}

/// Period and number of the steps, each of which must be there once.
fn check_sinusoid(steps: &[(f64, u32, u32)], axis: Axis) -> Result<Option<(f64, u32)>> {
    let Some(&(period, _, of)) = steps.first() else { return Ok(None) };
    if let Some(other) = steps.iter().find(|s| s.0.to_bits() != period.to_bits() || s.2 != of) {
        return Err(invalid(
            format!("one period and number of steps for the {axis}"),
            format!("{period} px in {of} steps and {} px in {}", other.0, other.2),
        ));
    }
    for step in 0..of {
        let n = steps.iter().filter(|s| s.1 == step).count();
        if n != 1 {
            let found = format!("step {step} {n} times");
            return Err(invalid(format!("each of the {of} steps of the {axis} once"), found));
        }
    }
    Ok(Some((period, of)))
}

fn name(light: &FrameLight) -> String {
    match light {
        FrameLight::White => "white".into(),
        FrameLight::Black => "black".into(),
        FrameLight::Bit { axis, bit, inverted } => {
            format!("bit {bit} of the {axis}{}", if *inverted { ", inverted" } else { "" })
        }
        FrameLight::Sinusoid { axis, step, of, .. } => format!("step {step} of {of} of the {axis}"),
    }
}

impl std::fmt::Display for FrameLight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(&name(self))
    }
}

fn invalid(expected: String, found: impl std::fmt::Display) -> Error {
    Error::invalid("frames", expected, found)
}

fn element(index: usize, expected: &str, found: impl std::fmt::Display) -> Error {
    Error::invalid(ErrorSubject::Element { list: "frames", index }, expected, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opencv() -> SequencePattern {
        SequencePattern::preset([1024, 768], SequencePreset::OpencvGray, None).unwrap()
    }

    #[test]
    fn neighbouring_cells_differ_in_one_bit_and_every_cell_has_its_own() {
        let pattern = opencv();
        let pictures: Vec<_> = (0..20).step_by(2).map(|i| pattern.image(i).unwrap()).collect();
        let word =
            |x: u32| pictures.iter().fold(0_u32, |w, p| w << 1 | u32::from(p.get_pixel(x, 5).0[0] > 127));
        let mut seen = std::collections::HashSet::new();
        for x in 0..1024 {
            assert!(seen.insert(word(x)));
            assert!(x == 0 || (word(x) ^ word(x - 1)).is_power_of_two());
            assert_eq!(word(x), gray_code(x));
        }
    }

    #[test]
    fn the_presets_have_the_order_of_their_programs() {
        let pattern = opencv();
        assert_eq!(pattern.frames.len(), 42);
        assert_eq!(pattern.frames[1].light, FrameLight::Bit { axis: Axis::Columns, bit: 9, inverted: true });
        assert_eq!(pattern.frames[20].light, FrameLight::Bit { axis: Axis::Rows, bit: 9, inverted: false });
        assert_eq!(
            [&pattern.frames[40].light, &pattern.frames[41].light],
            [&FrameLight::White, &FrameLight::Black]
        );
        let other = SequencePattern::preset([1824, 1140], SequencePreset::SlstudioGray, Some(10)).unwrap();
        assert_eq!(other.frames.len(), 12);
        let code = other.code(Axis::Columns).unwrap();
        assert_eq!((code.bits, code.cell_px, other.code(Axis::Rows)), (10, 2, None));
        assert_eq!(other.image(2).unwrap().get_pixel(1023, 0), &Luma([0]));
        assert_eq!(other.image(2).unwrap().get_pixel(1024, 0), &Luma([255]));
    }

    #[test]
    fn sinusoids_have_the_bits_that_tell_their_periods_apart() {
        for (period_px, bits, cell) in [(16.0, 7, 8), (20.0, 7, 8), (32.0, 6, 16)] {
            let sinusoid = Some(SinusoidConfig { period_px, steps: 8 });
            let config = SequenceConfig { sinusoid, ..SequenceConfig::default() };
            let pattern = SequencePattern::new([1024, 768], &config).unwrap();
            assert_eq!(pattern.frames.len(), 2 + 2 * bits + 8);
            let code = pattern.code(Axis::Columns).unwrap();
            assert_eq!((code.bits, code.cell_px, code.sinusoid), (bits as u32, cell, Some((period_px, 8))));
            // Brightest where column / period is step / of.
            let third = pattern.image(2 + 2 * bits + 2).unwrap();
            assert_eq!(third.get_pixel((period_px / 4.0) as u32, 0), &Luma([255]));
        }
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let broken = |change: &dyn Fn(&mut SequencePattern)| {
            let sinusoid = Some(SinusoidConfig::default());
            let config = SequenceConfig { sinusoid, ..SequenceConfig::default() };
            let mut pattern = SequencePattern::new([1024, 768], &config).unwrap();
            change(&mut pattern);
            pattern.validate().unwrap_err().to_string()
        };
        for (word, change) in [
            (
                "from 0 to 6",
                &(|p: &mut SequencePattern| drop(p.frames.drain(4..6))) as &dyn Fn(&mut SequencePattern),
            ),
            ("bit 6 of the columns twice", &|p| p.frames[3] = p.frames[2].clone()),
            ("white once", &|p| p.frames[1].light = FrameLight::White),
            ("step 7 0 times", &|p| drop(p.frames.pop())),
            ("bit 6 of the columns alone", &|p| {
                p.frames.remove(3);
                p.frames.remove(0);
            }),
            ("columns, rows, or both", &|p| p.frames.truncate(2)),
            ("no wider than a period", &|p| drop(p.frames.drain(2..6))),
            ("at most 256", &|p| p.frames = vec![p.frames[0].clone(); 300]),
            ("frames[2]", &|p| {
                p.frames[2].light = FrameLight::Bit { axis: Axis::Columns, bit: 31, inverted: false }
            }),
            ("px or more", &|p| {
                p.frames[16].light =
                    FrameLight::Sinusoid { axis: Axis::Columns, period_px: f64::NAN, step: 0, of: 8 };
            }),
        ] {
            let message = broken(change);
            assert!(message.contains(word), "{word}: {message}");
        }
        for config in [
            SequenceConfig { bits: Some(11), ..SequenceConfig::default() },
            SequenceConfig {
                bits: Some(3),
                sinusoid: Some(SinusoidConfig::default()),
                ..SequenceConfig::default()
            },
            SequenceConfig {
                sinusoid: Some(SinusoidConfig { period_px: 1.0, steps: 8 }),
                ..SequenceConfig::default()
            },
            SequenceConfig {
                sinusoid: Some(SinusoidConfig { period_px: 16.0, steps: 2 }),
                ..SequenceConfig::default()
            },
        ] {
            assert!(SequencePattern::new([1024, 768], &config).is_err(), "{config:?}");
        }
    }
}
