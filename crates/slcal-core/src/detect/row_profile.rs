//! How the light changes from row to row, the same for all that a photograph shows.
//!
//! What the gain of a row changes, it changes in all columns by the same factor. A column tells the ratio of two rows only
//! where nothing but the gain differs between them. Edges, shading and texture differ from column to column: the ratio on which most columns
//! agree is that of the gains, and strips of columns tell how well they agree.

use crate::photo::LinearPhoto;
use crate::solve::{Loss, median_f32, robust_scale};

/// Strips of columns whose agreement is the measure of uncertainty.
pub(super) const STRIPS: usize = 8;
/// Samples whose next code value stands for more light than this share of their own are too coarse to compare.
const COARSE: f32 = 0.1;
/// Samples from this share of the brightest one on may be at the end of the range.
const FULL: f32 = 0.99;
/// Samples below this share of the brightest one are noise.
const DARK: f32 = 0.003;
/// The cutoff of Tukey's biweight in σ: 95 % efficiency on normal errors.
const TUKEY: f64 = 4.685;
/// Rounds of reweighting: columns on the other side of an edge lose their weight in the first ones.
const ROUNDS: usize = 4;
/// Rows in which fewer columns than this share agree tell nothing.
const MIN_SHARE: f64 = 0.1;

/// The light of some columns of one channel, in blocks of rows.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    /// Rows in a block.
    pub(super) block: usize,
    /// Number of blocks.
    pub(super) count: usize,
    /// Number of columns.
    width: usize,
    /// Block by block; NaN where samples are too dark or at the end of the range.
    light: Vec<f32>,
    /// The step between code values as a share of the light, the mean of all samples.
    quantum: f64,
}

impl Columns {
    /// Reads every so many columns, so that there are `wanted` to twice as many, or all. The light of rows is divided by
    /// gains that are known.
    pub(super) fn read(
        photo: &LinearPhoto<'_>,
        channel: usize,
        wanted: usize,
        block: usize,
        gain: impl Fn(usize) -> f32,
    ) -> Self {
        let step = (photo.width() / wanted).max(1);
        let columns = photo.width() / step;
        let count = photo.height() / block;
        let mut light = vec![0.0_f32; count * columns];
        let (mut most, mut steps, mut compared) = (0.0_f32, 0.0, 0_u32);
        for (b, sums) in light.chunks_exact_mut(columns.max(1)).enumerate() {
            for y in b * block..(b + 1) * block {
                let factor = 1.0 / (gain(y) * block as f32);
                for (i, sum) in sums.iter_mut().enumerate() {
                    let (light, next) = photo.channel_and_step(i * step + step / 2, y, channel);
                    most = most.max(light);
                    if next < COARSE * light {
                        steps += f64::from(next / light);
                        compared += 1;
                        *sum += factor * light;
                    } else {
                        *sum += f32::NAN;
                    }
                }
            }
        }
        for (b, light) in light.chunks_exact_mut(columns.max(1)).enumerate() {
            let gain = gain(b * block + block / 2);
            let comparable = DARK * most..FULL * most;
            light.iter_mut().filter(|l| !comparable.contains(&(gain * **l))).for_each(|l| *l = f32::NAN);
        }
        let quantum = steps / f64::from(compared.max(1));
        Self { block, count, width: columns, light, quantum }
    }

    /// The same in blocks of twice as many rows.
    pub(super) fn halved(&self) -> Self {
        let pairs = self.light.chunks_exact(2 * self.width.max(1));
        let mean = |pair: &[f32]| {
            let (a, b) = pair.split_at(self.width);
            a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect::<Vec<_>>()
        };
        let light = pairs.flat_map(mean).collect();
        Self { block: 2 * self.block, count: self.count / 2, light, ..*self }
    }

    /// The changes in each strip of columns alone.
    pub(super) fn strips(&self) -> Vec<Option<Profile>> {
        let width = self.width / STRIPS;
        let strip = |s: usize| {
            let rows = self.light.chunks_exact(self.width.max(1));
            let light = rows.flat_map(|row| &row[s * width..(s + 1) * width]).copied().collect();
            Self { width, light, ..*self }.profile()
        };
        (0..STRIPS).map(strip).collect()
    }

    /// The changes from block to block; `None` where hardly any block can be compared with the next.
    pub(super) fn profile(&self) -> Option<Profile> {
        /// Fewer changes than this hold no period.
        const MIN_CHANGES: usize = 16;
        if self.count < MIN_CHANGES || self.width < STRIPS {
            return None;
        }
        let logs: Vec<f32> = self.light.iter().map(|l| l.ln()).collect();
        let rows: Vec<&[f32]> = logs.chunks_exact(self.width).collect();
        let changes = |pair: &[&[f32]]| pair[1].iter().zip(pair[0]).map(|(b, a)| b - a).collect::<Vec<_>>();
        let changes: Vec<Vec<f32>> = rows.windows(2).map(changes).collect();
        let mut scratch = Vec::with_capacity(self.width);
        let mut starts = Vec::with_capacity(changes.len());
        for row in &changes {
            scratch.clear();
            scratch.extend(row.iter().filter(|d| d.is_finite()));
            let seen = scratch.len() as f64 >= MIN_SHARE * self.width as f64;
            let middle = median_f32(&mut scratch).filter(|_| seen);
            starts.push(middle.map(|m| {
                for d in &mut scratch {
                    *d = (*d - m).abs();
                }
                let mad = median_f32(&mut scratch).unwrap_or(0.0);
                (f64::from(m), robust_scale(std::iter::once(f64::from(mad))))
            }));
        }
        let usual = median_of(starts.iter().flatten().map(|s| s.1))?.max(self.quantum);
        let mut found: Vec<RowChange> = changes
            .iter()
            .zip(&starts)
            .map(|(row, start)| {
                start.map_or_else(RowChange::default, |(middle, spread)| {
                    RowChange::of(row, middle, spread, usual)
                })
            })
            .collect();
        let few = MIN_SHARE * self.width as f64;
        found.iter_mut().filter(|c| c.agreeing < few).for_each(|c| c.variance = None);
        let rounding = self.quantum.powi(2) / (12.0 * self.width as f64);
        let usual = median_of(found.iter().filter_map(|c| c.variance))?.max(rounding);
        let weights: Vec<f64> = found.iter().map(|c| c.variance.map_or(0.0, |v| 1.0 / (v + usual))).collect();
        (weights.iter().filter(|w| **w > 0.0).count() >= MIN_CHANGES).then(|| Profile {
            block: self.block,
            changes: found.iter().map(|c| c.change).collect(),
            weights,
        })
    }
}

/// The median; `None` for nothing.
fn median_of(values: impl Iterator<Item = f64>) -> Option<f64> {
    crate::solve::median(&mut values.collect::<Vec<_>>())
}

/// Changes of the logarithm of light from each block of rows to the next.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Rows in a block.
    pub(super) block: usize,
    /// The change on which the columns agree.
    pub(super) changes: Vec<f64>,
    /// 1/σ²; zero where the change is not known.
    pub(super) weights: Vec<f64>,
}

/// One change, as the columns see it.
#[derive(Debug, Clone, Default)]
struct RowChange {
    change: f64,
    /// Of the mean of the strips; `None` where the change is not known.
    variance: Option<f64>,
    /// How many columns agree.
    agreeing: f64,
}

impl RowChange {
    /// The change on which most columns of `row` agree, from a start and its spread, where `usual` is the spread of rows without edges.
    fn of(row: &[f32], start: f64, spread: f64, usual: f64) -> Self {
        let width = row.len() / STRIPS;
        let mut found = Self { change: start, ..Self::default() };
        for round in 0..ROUNDS {
            let cutoff = TUKEY * if round == 0 { spread.max(usual) } else { usual };
            let loss = Loss::Tukey(cutoff);
            let mut sums = [(0.0, 0.0); STRIPS];
            for (i, d) in row.iter().enumerate().filter(|(_, d)| d.is_finite()) {
                let d = f64::from(*d);
                let weight = loss.weight((d - found.change).powi(2));
                let sum = &mut sums[(i / width.max(1)).min(STRIPS - 1)];
                sum.0 += weight * d;
                sum.1 += weight;
            }
            let (sum, weight) = sums.iter().fold((0.0, 0.0), |t, s| (t.0 + s.0, t.1 + s.1));
            if weight <= 0.0 {
                return Self::default();
            }
            found.change = sum / weight;
            found.agreeing = weight;
            let strips = sums.iter().filter(|s| s.1 > 0.0);
            let squares =
                strips.map(|(sum, weight)| weight * (sum / weight - found.change).powi(2)).sum::<f64>();
            found.variance = Some(squares / weight / (STRIPS - 1) as f64);
        }
        found
    }
}
