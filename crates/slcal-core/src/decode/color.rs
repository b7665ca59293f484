//! Which hue a stripe has; the hues are learned from the photograph.

use super::peaks::{Peak, total};

/// Angle between two colours of one hue, rad: what shading, crosstalk and surfaces leave when noise is small.
const MIN_SPREAD_RAD: f32 = 0.08;
/// Beyond this the classes overlap so much that they say nothing.
const MAX_SPREAD_RAD: f32 = 0.35;
/// Share of peaks whose colour says nothing (reflections, two stripes in one, coloured surfaces).
const OUTLIERS: f32 = 0.05;
/// Rounds of learning; the means settle in three or four.
const ROUNDS: usize = 8;
/// A class is learned from at least this many peaks.
const MIN_MEMBERS: f32 = 20.0;

/// Directions in linear RGB of the hues as this camera sees them.
#[derive(Debug, Clone)]
pub(super) struct Hues {
    pub(super) directions: Vec<[f32; 3]>,
    pub(super) spread_rad: f32,
    /// Typical light of each hue, as a share of the average.
    pub(super) brightness: Vec<f32>,
}

pub(super) fn unit(c: [f32; 3]) -> Option<[f32; 3]> {
    let norm = c.iter().map(|x| x * x).sum::<f32>().sqrt();
    (norm > 0.0 && norm.is_finite()).then(|| c.map(|x| x / norm))
}

fn squared_angle(a: [f32; 3], b: [f32; 3]) -> f32 {
    // The chord: 2 sin(angle/2), without the loss of digits of an arc cosine.
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum()
}

impl Hues {
    /// The palette's own directions, with the camera's colour balance matched to that of the peaks: over all of them, the
    /// channels must have the shares that they have over the pattern.
    pub(super) fn seed(palette: &[[f32; 3]], sequence: &[u8], peaks: &[Peak]) -> Self {
        let grey = unit([1.0; 3]).unwrap_or([0.0; 3]);
        let directions: Vec<_> = palette.iter().map(|&c| unit(c).unwrap_or(grey)).collect();
        let mean = |it: &mut dyn Iterator<Item = [f32; 3]>| {
            let mut sum = [1e-6_f32; 3];
            for c in it {
                for (s, x) in sum.iter_mut().zip(c) {
                    *s += x.max(0.0);
                }
            }
            unit(sum).unwrap_or(grey)
        };
        let expected = mean(&mut sequence.iter().filter_map(|&s| directions.get(usize::from(s)).copied()));
        let mut gain = [1.0_f32; 3];
        for _ in 0..5 {
            let balanced = |p: &Peak| unit(std::array::from_fn(|k| p.color[k].max(0.0) * gain[k]));
            let seen = mean(&mut peaks.iter().filter_map(balanced));
            // Within a factor of three: more is not balance, but a pattern of which only some hues are seen.
            gain = std::array::from_fn(|k| (gain[k] * expected[k] / seen[k].max(1e-3)).clamp(1.0 / 3.0, 3.0));
        }
        let seen = |c: [f32; 3]| unit(std::array::from_fn(|k| c[k] / gain[k])).unwrap_or(grey);
        let brightness = vec![1.0; directions.len()];
        Self {
            directions: directions.into_iter().map(seen).collect(),
            spread_rad: MAX_SPREAD_RAD,
            brightness,
        }
    }

    /// Moves the directions to the means of the peaks nearest to them, with the hues that the decoding gave to peaks (if
    /// any) taken as they are.
    pub(super) fn learn(&mut self, peaks: &[Peak], labels: Option<&[Option<u8>]>) {
        for _ in 0..ROUNDS {
            let mut sums = vec![([0.0_f32; 3], 0.0_f32); self.directions.len()];
            let mut logs = vec![0.0_f32; self.directions.len()];
            let mut deviations = Vec::with_capacity(peaks.len().min(20_000));
            let stride = peaks.len() / 20_000 + 1;
            for (i, p) in peaks.iter().enumerate() {
                let Some(c) = unit(p.color.map(|c| c.max(0.0))) else { continue };
                let hue = match labels {
                    Some(l) => l[i].map(usize::from),
                    None => self.nearest(c),
                };
                let Some((h, mean)) = hue.and_then(|h| Some((h, *self.directions.get(h)?))) else { continue };
                let d = squared_angle(c, mean);
                if i % stride == 0 {
                    deviations.push(d);
                }
                // Redescending: what lies beyond three spreads does not move the mean.
                if d < 9.0 * self.spread_rad * self.spread_rad {
                    let (sum, n) = &mut sums[h];
                    *n += 1.0;
                    logs[h] += total(p.color).max(1e-6).ln();
                    for (s, x) in sum.iter_mut().zip(c) {
                        *s += x;
                    }
                }
            }
            let all = logs.iter().sum::<f32>() / sums.iter().map(|s| s.1).sum::<f32>().max(1.0);
            for (h, (sum, n)) in sums.into_iter().enumerate() {
                if n >= MIN_MEMBERS
                    && let Some(mean) = unit(sum)
                {
                    self.directions[h] = mean;
                    self.brightness[h] = (logs[h] / n - all).exp();
                }
            }
            if !deviations.is_empty() {
                let middle = deviations.len() / 2;
                let (_, m, _) = deviations.select_nth_unstable_by(middle, f32::total_cmp);
                // The median of a squared deviation with two degrees of freedom is 1.39 σ².
                self.spread_rad = (*m / 1.386).sqrt().clamp(MIN_SPREAD_RAD, MAX_SPREAD_RAD);
            }
        }
    }

    /// Typical light of the hue nearest to a colour, as a share of the average.
    pub(super) fn brightness_of(&self, color: [f32; 3]) -> f32 {
        let hue = unit(color.map(|c| c.max(0.0))).and_then(|c| self.nearest(c));
        hue.map_or(1.0, |h| self.brightness[h])
    }

    fn nearest(&self, c: [f32; 3]) -> Option<usize> {
        let key = |h: &usize| squared_angle(c, self.directions[*h]);
        (0..self.directions.len()).min_by(|a, b| key(a).total_cmp(&key(b)))
    }

    /// Log-odds of each hue against chance, into `out` (one entry per hue): at most ln(hues), at least ln 0.05.
    pub(super) fn log_odds(&self, color: [f32; 3], out: &mut [f32]) {
        let n = self.directions.len() as f32;
        let Some(c) = unit(color.map(|c| c.max(0.0))) else {
            out.fill(0.0);
            return;
        };
        let scale = -0.5 / (self.spread_rad * self.spread_rad);
        let mut sum = 1e-9;
        for (o, d) in out.iter_mut().zip(&self.directions) {
            *o = (squared_angle(c, *d) * scale).exp();
            sum += *o;
        }
        for o in out {
            *o = ((1.0 - OUTLIERS) * *o / sum * n + OUTLIERS).ln();
        }
    }
}
