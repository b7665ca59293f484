//! One colour per pixel, and three made of it: the Bayer mosaic of a sensor, and how cameras fill it in.

use serde::{Deserialize, Serialize};

use crate::named::named;

/// Pixels beyond the border that the filters need.
const REACH: usize = 2;

/// How the two missing colours of every pixel are found. The mosaic is RGGB: the pixel at the top left is red.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Demosaic {
    /// H. S. Malvar, L. He, R. Cutler, "High-quality linear interpolation for demosaicing of Bayer-patterned color images",
    /// ICASSP 2004: linear filters of 5×5 pixels that take detail from the colour that is there.
    Malvar,
    /// The mean of the nearest two or four pixels of the colour.
    Bilinear,
}

named!(Demosaic, "demosaicing", { Malvar => "malvar", Bilinear => "bilinear" });

/// The channel that the sensor measures at a pixel.
pub(super) fn measured(x: usize, y: usize) -> usize {
    x % 2 + y % 2
}

impl Demosaic {
    /// All three channels of a mosaic that is `width` wide. They may lie a little outside the range of the samples.
    pub(super) fn fill(self, mosaic: &[f64], width: usize) -> Vec<[f64; 3]> {
        let mosaic = Mosaic::new(mosaic, width);
        let pixel = |i: usize| {
            let (x, y) = (i % width, i / width);
            let around = mosaic.around(x, y);
            let (centre, [green, across, along, opposite]) = match self {
                Self::Malvar => (around.centre, around.malvar()),
                Self::Bilinear => (around.centre, around.bilinear()),
            };
            match (x % 2, y % 2) {
                (0, 0) => [centre, green, opposite],
                (1, 0) => [across, centre, along],
                (0, _) => [along, centre, across],
                _ => [opposite, green, centre],
            }
        };
        (0..mosaic.pixels).map(pixel).collect()
    }
}

/// The samples with two pixels more on every side, mirrored about the outermost ones, so that colours stay where they were.
struct Mosaic {
    values: Vec<f64>,
    stride: usize,
    pixels: usize,
}

/// Sums over the neighbours of a pixel.
struct Around {
    centre: f64,
    left_right: f64,
    up_down: f64,
    diagonal: f64,
    far_left_right: f64,
    far_up_down: f64,
}

impl Mosaic {
    fn new(samples: &[f64], width: usize) -> Self {
        let height = samples.len() / width;
        let (columns, rows) = (mirrored(width), mirrored(height));
        let values = rows.iter().flat_map(|y| columns.iter().map(move |x| samples[y * width + x])).collect();
        Self { values, stride: columns.len(), pixels: width * height }
    }

    fn around(&self, x: usize, y: usize) -> Around {
        let at = |dx: usize, dy: usize| self.values[(y + dy) * self.stride + x + dx];
        Around {
            centre: at(2, 2),
            left_right: at(1, 2) + at(3, 2),
            up_down: at(2, 1) + at(2, 3),
            diagonal: at(1, 1) + at(3, 1) + at(1, 3) + at(3, 3),
            far_left_right: at(0, 2) + at(4, 2),
            far_up_down: at(2, 0) + at(2, 4),
        }
    }
}

/// The pixels that stand for those from [`REACH`] before the first to [`REACH`] after the last of `length`.
fn mirrored(length: usize) -> Vec<usize> {
    let period = 2 * (length - 1).max(1);
    let pixel = |i: usize| {
        let i = (i + REACH * (period - 1)) % period;
        i.min(period - i).min(length - 1)
    };
    (0..length + 2 * REACH).map(pixel).collect()
}

/// Green at a red or blue pixel; at a green pixel the colour of its row's other pixels and that of its column's; at a red
/// or blue pixel the other one of these two.
impl Around {
    fn bilinear(&self) -> [f64; 4] {
        [
            (self.left_right + self.up_down) / 4.0,
            self.left_right / 2.0,
            self.up_down / 2.0,
            self.diagonal / 4.0,
        ]
    }

    fn malvar(&self) -> [f64; 4] {
        let Self { centre, left_right, up_down, diagonal, far_left_right, far_up_down } = self;
        [
            (4.0 * centre + 2.0 * (left_right + up_down) - far_left_right - far_up_down) / 8.0,
            (5.0 * centre + 4.0 * left_right - diagonal - far_left_right + 0.5 * far_up_down) / 8.0,
            (5.0 * centre + 4.0 * up_down - diagonal - far_up_down + 0.5 * far_left_right) / 8.0,
            (6.0 * centre + 2.0 * diagonal - 1.5 * (far_left_right + far_up_down)) / 8.0,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mosaic([width, height]: [usize; 2], color: impl Fn(usize, usize) -> [f64; 3]) -> Vec<f64> {
        (0..width * height)
            .map(|i| (i % width, i / width))
            .map(|(x, y)| color(x, y)[measured(x, y)])
            .collect()
    }

    #[test]
    fn the_mosaic_begins_with_red_green_above_green_blue() {
        assert_eq!([measured(0, 0), measured(1, 0), measured(0, 1), measured(1, 1)], [0, 1, 1, 2]);
    }

    #[test]
    fn pixels_beyond_the_border_are_those_as_far_inside() {
        assert_eq!(mirrored(5), [2, 1, 0, 1, 2, 3, 4, 3, 2]);
        assert_eq!(mirrored(2), [0, 1, 0, 1, 0, 1]);
        assert_eq!(mirrored(1), [0; 5]);
    }

    #[test]
    fn one_colour_is_exact_up_to_the_border() {
        let color = [0.7, 0.4, 0.2];
        for demosaic in Demosaic::ALL {
            for size in [[9, 7], [8, 6], [2, 2], [3, 2]] {
                let filled = demosaic.fill(&mosaic(size, |_, _| color), size[0]);
                assert_eq!(filled.len(), size[0] * size[1]);
                for value in filled {
                    assert!((0..3).all(|c| (value[c] - color[c]).abs() < 1e-15), "{demosaic} {value:?}");
                }
            }
            // A picture with no second row or column has no colour to be right about, but has every pixel.
            assert_eq!(demosaic.fill(&[0.5; 4], 4).len(), 4);
            assert_eq!(demosaic.fill(&[0.5], 1).len(), 1);
        }
    }

    #[test]
    fn grey_ramps_are_exact_inside() {
        let size = [12, 10];
        let ramp = |x: usize, y: usize| [0.1 + 0.03 * x as f64 - 0.02 * y as f64; 3];
        for demosaic in Demosaic::ALL {
            let filled = demosaic.fill(&mosaic(size, ramp), 12);
            for (x, y) in (2..8).flat_map(|y| (2..10).map(move |x| (x, y))) {
                let (value, expected) = (filled[y * 12 + x], ramp(x, y));
                assert!((0..3).all(|c| (value[c] - expected[c]).abs() < 1e-15), "{demosaic} {x},{y}");
            }
        }
        // Interpolation alone needs no equal slopes.
        let tinted = |x: usize, y: usize| [0.02 * x as f64, 0.05 * y as f64, 0.3 - 0.01 * (x + y) as f64];
        let filled = Demosaic::Bilinear.fill(&mosaic(size, tinted), 12);
        for (x, y) in (1..9).flat_map(|y| (1..11).map(move |x| (x, y))) {
            let (value, expected) = (filled[y * 12 + x], tinted(x, y));
            assert!((0..3).all(|c| (value[c] - expected[c]).abs() < 1e-15), "{x},{y}");
        }
    }

    #[test]
    fn the_filters_are_those_of_the_paper() {
        // The response to one bright sample, in eighths, as in figure 2 of the paper: what it adds to the pixels around it.
        let at = |x: usize, y: usize, to: [usize; 2]| {
            let mut samples = vec![0.0; 144];
            samples[y * 12 + x] = 8.0;
            Demosaic::Malvar.fill(&samples, 12)[to[1] * 12 + to[0]]
        };
        // From red (6, 6): green at itself, two pixels away, and blue at itself; green (7, 6) has red beside it.
        assert_eq!(at(6, 6, [6, 6]), [8.0, 4.0, 6.0]);
        assert_eq!(at(6, 6, [8, 6]), [0.0, -1.0, -1.5]);
        assert_eq!(at(6, 6, [7, 6])[0], 4.0);
        assert_eq!(at(6, 6, [6, 7])[0], 4.0);
        assert_eq!(at(6, 6, [7, 7])[0], 2.0);
        // From green (7, 6), in a red row: green, red and blue around it.
        assert_eq!(at(7, 6, [6, 6])[1], 2.0);
        assert_eq!(at(7, 6, [7, 6]), [5.0, 8.0, 5.0]);
        assert_eq!(at(7, 6, [9, 6]), [-1.0, 0.0, 0.5]);
        assert_eq!(at(7, 6, [7, 8]), [0.5, 0.0, -1.0]);
        assert_eq!(at(7, 6, [8, 7]), [-1.0, 0.0, -1.0]);
    }
}
