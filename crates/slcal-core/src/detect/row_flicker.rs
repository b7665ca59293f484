//! Bands of flicker: rows that got less light than others, because a lamp or the projector's colour wheel flickered while a rolling
//! shutter read the rows one after the other.
//!
//! A band darkens everything in its rows by the same factor, and bands follow each other periodically. The changes of light from row to row on
//! which all columns agree (`row_profile`) are searched for a period. The gain of each channel, a mean and a sinusoid as the power of
//! a lamp has (with two harmonics where they show), is then fitted to the changes, together with a smooth trend that lamps and lenses
//! leave. It counts as flicker only if it explains the changes far better than chance, and if all parts of the width show
//! it alike: sides of sheets, squares and shelves do not.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector, SMatrix, SVector};

use super::row_profile::{Columns, Profile, STRIPS};
use crate::photo::LinearPhoto;
use crate::solve::{Loss, robust_scale};

/// Columns that are read in the search, and where something was found.
const FEW_COLUMNS: usize = 128;
const MANY_COLUMNS: usize = 384;
/// The height is divided into no more blocks than this at first. Bands shorter than two and a half blocks are not looked for: they average
/// out within any square and any part of a side.
const MAX_BLOCKS: usize = 512;
/// Periods are looked for in blocks of this part of them: finer blocks only add noise, coarser ones blur them.
const FINEST: f64 = 1.0 / 16.0;
const COARSEST: f64 = 1.0 / 8.0;
const SHORTEST: f64 = 1.0 / 2.5;
/// Blocks are not made coarser than that there are this many.
const MIN_BLOCKS: usize = 48;
/// Bands are seen at least this many times: fewer cannot be told from shading.
const MIN_PERIODS: f64 = 2.0;
/// Frequencies per independent one.
const OVERSAMPLING: f64 = 3.0;
/// The green channel is searched first; the F ratio at which all are looked at.
const SUSPICIOUS: f64 = 20.0;
/// The F ratio of the fit from which it can be divided out. In 103 photographs without flicker it was 43 at most; with bands of 20 % that are seen
/// twice it is 80 to 200, with all others more.
const SIGNIFICANT: f64 = 60.0;
/// The mean over the strips of how much of the fitted gain they show, in σ of that mean, from which it is flicker. In the 103 photographs
/// it was 3.6 at most, with bands of 20 % 8.5 or more. Blinds behind a sheet reach 5, and 9 where four fifths of the width are blinds.
const AGREEMENT: f64 = 8.0;
/// No strip counts as if it knew its share of the gain to better than this: one that shows something else is to be heard.
const BEST_KNOWN: f64 = 0.1;
/// Shallower bands displace nothing.
const MIN_DEPTH: f64 = 0.02;
/// Bands that cannot be divided out are told from this depth on: what displaces edges by much of their blur.
const DEEP: f64 = 0.1;
/// The F ratio from which harmonics are part of the gain. Up to 20 was seen where there are none.
const HARMONIC: f64 = 60.0;
const HARMONICS: usize = 3;
/// Terms of the trend of changes; the trend of light has one more.
const TREND: usize = 3;
/// The cutoff of Huber's loss in σ.
const HUBER: f64 = 2.5;
/// Steps of the fit. It starts near the minimum, and three or four of them reach it.
const STEPS: usize = 12;
/// No gain is taken to be less than this part of the mean.
const MIN_GAIN: f64 = 0.01;

/// Bands that were found in a photograph.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowFlicker {
    /// Whether bands with one period explain the changes, so that they can be divided out.
    pub(super) periodic: bool,
    /// Rows from one band to the next.
    pub(super) period_px: f64,
    /// What the darkest rows lose, as a share of the brightest, in the channel where they lose most.
    pub(super) depth: f64,
    channels: Vec<Gain>,
    /// The largest gain of each channel.
    brightest: Vec<f64>,
}

impl RowFlicker {
    /// The bands in a photograph beside those that are known already, if there are any.
    pub(super) fn find(photo: &LinearPhoto<'_>, known: &[Self]) -> Option<Self> {
        let block = photo.height().div_ceil(MAX_BLOCKS).max(1);
        let green = usize::from(photo.channels() > 1);
        let (halvings, frequency) =
            search(Columns::read(photo, green, FEW_COLUMNS, block, |y| gains(known, y)[green]))?;
        let channel = |c| {
            let columns = Columns::read(photo, c, MANY_COLUMNS, block, |y| gains(known, y)[c]);
            (0..halvings).fold(columns, |c, _| c.halved())
        };
        let channels: Vec<Columns> = (0..photo.channels()).map(channel).collect();
        let profiles: Vec<Profile> = channels.iter().map(Columns::profile).collect::<Option<_>>()?;
        let strips: Vec<Vec<Option<Profile>>> = channels.iter().map(Columns::strips).collect();
        let starts = profiles.iter().map(|p| start(p, frequency)).collect::<Option<Vec<_>>>()?;
        let mut fit = Fit::new(&profiles, frequency, starts)?;
        let agreed = agreement(&strips, &fit.channels)?;
        let without: f64 = profiles.iter().map(|p| robust(p, &p.changes).1).sum();
        let parameters = |harmonics: usize| 1 + profiles.len() * 2 * harmonics;
        let ratio = fit.f_ratio(without, parameters(1));
        if agreed < AGREEMENT {
            return None;
        }
        let further = fit.channels.iter().map(|g| {
            let none = std::iter::repeat_n([0.0; 2], HARMONICS - 1);
            Gain { omega: g.omega, harmonics: g.harmonics.iter().copied().chain(none).collect() }
        });
        let further = Fit::new(&profiles, frequency, further.collect());
        if let Some(further) = further
            && further.f_ratio(fit.cost, parameters(HARMONICS) - parameters(1)) > HARMONIC
        {
            fit = further;
        }
        let period_px = 2.0 * PI / fit.channels[0].omega;
        let depth = fit.channels.iter().map(Gain::depth).fold(0.0, f64::max);
        let seen_often = period_px * MIN_PERIODS <= photo.height() as f64;
        let periodic = ratio > SIGNIFICANT;
        (seen_often && depth > if periodic { MIN_DEPTH } else { DEEP }).then_some(Self {
            periodic,
            period_px,
            depth,
            brightest: fit.channels.iter().map(|g| g.range()[1]).collect(),
            channels: fit.channels,
        })
    }

    fn gain(&self, channel: usize, y: usize) -> f32 {
        let channel = channel.min(self.channels.len() - 1);
        (self.channels[channel].at(y as f64) / self.brightest[channel]).max(MIN_GAIN) as f32
    }
}

/// What all these bands leave of the light of a row, red, green and blue; all of it in the brightest row.
pub(super) fn gains(bands: &[RowFlicker], y: usize) -> [f32; 3] {
    std::array::from_fn(|c| bands.iter().map(|b| b.gain(c, y)).product())
}

/// The gain of the rows in one channel.
#[derive(Debug, Clone, PartialEq)]
struct Gain {
    /// Radians per row.
    omega: f64,
    /// Cosine and sine of each harmonic, against a mean of one.
    harmonics: Vec<[f64; 2]>,
}

impl Gain {
    fn at(&self, y: f64) -> f64 {
        let wave = |(k, [a, b]): (usize, &[f64; 2])| {
            let (sin, cos) = ((k + 1) as f64 * self.omega * y).sin_cos();
            a * cos + b * sin
        };
        1.0 + self.harmonics.iter().enumerate().map(wave).sum::<f64>()
    }

    /// The smallest and the largest gain.
    fn range(&self) -> [f64; 2] {
        const PLACES: u32 = 96;
        let places = (0..PLACES).map(|i| self.at(f64::from(i) / f64::from(PLACES) * 2.0 * PI / self.omega));
        places.fold([f64::MAX, f64::MIN], |[low, high], g| [low.min(g), high.max(g)])
    }

    /// The same with waves so low that no gain is less than the least. `None` for no period.
    fn above_least(mut self) -> Option<Self> {
        if self.omega.is_nan() || self.omega <= 0.0 {
            return None;
        }
        let below = 1.0 - self.range()[0];
        if below > 1.0 - MIN_GAIN {
            let factor = (1.0 - MIN_GAIN) / below;
            self.harmonics.iter_mut().flatten().for_each(|h| *h *= factor);
        }
        Some(self)
    }

    fn depth(&self) -> f64 {
        let [low, high] = self.range();
        1.0 - low / high
    }

    /// The logarithm of the mean gain of each block of rows, and its derivatives by ω and by the harmonics. `None` where a
    /// gain is not positive.
    fn logarithms(&self, block: usize, count: usize) -> Option<Vec<(f64, Vec<f64>)>> {
        let rows = block as f64;
        // The mean of a wave over the rows of a block is its value in the middle, reduced by this.
        let reduced = |k: f64| {
            let half = 0.5 * k * self.omega;
            if half.sin().abs() < 1e-9 { 1.0 } else { (half * rows).sin() / (rows * half.sin()) }
        };
        let reduced: Vec<f64> = (1..=self.harmonics.len()).map(|k| reduced(k as f64)).collect();
        let of_block = |b: usize| {
            let y = b as f64 * rows + 0.5 * (rows - 1.0);
            let mut by = vec![0.0; 1 + 2 * self.harmonics.len()];
            let mut gain = 1.0;
            for (i, [a, b]) in self.harmonics.iter().enumerate() {
                let k = (i + 1) as f64;
                let (sin, cos) = (k * self.omega * y).sin_cos();
                let (sin, cos) = (sin * reduced[i], cos * reduced[i]);
                gain += a * cos + b * sin;
                by[0] += k * y * (b * cos - a * sin);
                by[1 + 2 * i] = cos;
                by[2 + 2 * i] = sin;
            }
            for d in &mut by {
                *d /= gain;
            }
            (gain > 0.0).then(|| (gain.ln(), by))
        };
        (0..count).map(of_block).collect()
    }
}

/// Gains fitted to the changes of all channels, with one frequency.
struct Fit {
    channels: Vec<Gain>,
    /// Weighted squares of what is left.
    cost: f64,
    /// Changes that are known, less the unknowns.
    freedom: f64,
}

impl Fit {
    /// Gauss-Newton from these gains on.
    fn new(profiles: &[Profile], frequency: f64, starts: Vec<Gain>) -> Option<Self> {
        let mut channels = starts;
        let harmonics = channels.first()?.harmonics.len();
        let each = 2 * harmonics + TREND;
        let unknowns = 1 + channels.len() * each;
        let known: usize = profiles.iter().map(|p| p.weights.iter().filter(|w| **w > 0.0).count()).sum();
        let freedom = known.checked_sub(unknowns + 1)? as f64;
        let block = profiles[0].block;
        // ω in units of the frequency's own resolution, so that all unknowns are of the order of one.
        let unit = 2.0 * PI * frequency / block as f64 / profiles[0].changes.len() as f64;
        let mut cost = f64::INFINITY;
        for _ in 0..STEPS {
            let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
            let mut side = DVector::<f64>::zeros(unknowns);
            cost = 0.0;
            for (c, (profile, gain)) in profiles.iter().zip(&channels).enumerate() {
                let logs = gain.logarithms(block, profile.changes.len() + 1)?;
                let wanted: Vec<f64> =
                    profile.changes.iter().zip(logs.windows(2)).map(|(d, l)| d - (l[1].0 - l[0].0)).collect();
                let (weights, own) = robust(profile, &wanted);
                cost += own;
                let first = 1 + c * each;
                for (j, pair) in logs.windows(2).enumerate().filter(|(j, _)| weights[*j] > 0.0) {
                    let step = |i: usize| pair[1].1[i] - pair[0].1[i];
                    let mut terms = vec![(0, unit * step(0))];
                    terms.extend((0..2 * harmonics).map(|i| (first + i, step(1 + i))));
                    let trend = trend(j, profile.changes.len());
                    terms.extend(trend.iter().enumerate().map(|(i, t)| (first + 2 * harmonics + i, *t)));
                    for &(row, t) in &terms {
                        for &(column, u) in &terms {
                            normal[(row, column)] += weights[j] * t * u;
                        }
                        side[row] += weights[j] * t * wanted[j];
                    }
                }
            }
            let step = normal.cholesky()?.solve(&side);
            let moved = |(c, g): (usize, &Gain)| {
                let first = 1 + c * each;
                let add =
                    |(i, [a, b]): (usize, &[f64; 2])| [a + step[first + 2 * i], b + step[first + 2 * i + 1]];
                let harmonics = g.harmonics.iter().enumerate().map(add).collect();
                Gain { omega: g.omega + unit * step[0], harmonics }.above_least()
            };
            channels = channels.iter().enumerate().map(moved).collect::<Option<_>>()?;
        }
        Some(Self { channels, cost, freedom })
    }

    /// By how much more these unknowns lower the cost than chance would.
    fn f_ratio(&self, without: f64, unknowns: usize) -> f64 {
        (without - self.cost) / unknowns as f64 / (self.cost / self.freedom).max(f64::MIN_POSITIVE)
    }
}

/// Which blocks show bands in one channel, as halvings of these, and the bands per block. `None` where nothing is suspicious.
fn search(mut columns: Columns) -> Option<(usize, f64)> {
    let mut best = (SUSPICIOUS, None);
    for halvings in 0.. {
        let last = columns.count / 2 < MIN_BLOCKS;
        let shortest = if halvings == 0 { SHORTEST } else { COARSEST };
        let longest = if last { MIN_PERIODS / columns.count.max(1) as f64 } else { FINEST };
        if let Some(profile) = columns.profile()
            && let count = profile.changes.len()
            && let Some((_, without)) =
                least_squares(|j| SVector::from(trend(j, count)), &profile.changes, &profile.weights)
        {
            let known = profile.weights.iter().filter(|w| **w > 0.0).count() as f64;
            let independent = (shortest - longest).max(0.0) * columns.count as f64;
            let steps = (OVERSAMPLING * independent).ceil().max(1.0);
            for i in 0..=steps as usize {
                let frequency = longest + (shortest - longest).max(0.0) * i as f64 / steps;
                let Some((_, cost)) = wave(&profile, frequency) else { continue };
                let ratio =
                    (without - cost) / 2.0 / (cost / (known - (TREND + 2) as f64)).max(f64::MIN_POSITIVE);
                if ratio > best.0 {
                    best = (ratio, Some((halvings, frequency)));
                }
            }
        }
        if last {
            break;
        }
        columns = columns.halved();
    }
    best.1
}

/// A gain to start from: the sinusoid that fits best at this frequency, bands per block.
fn start(profile: &Profile, frequency: f64) -> Option<Gain> {
    /// A gain that follows the logarithm of light is never deeper.
    const DEEPEST: f64 = 0.9;
    let ([a, b], _) = wave(profile, frequency)?;
    let per_block = 2.0 * PI * frequency;
    // The changes are differences of waves in the logarithm of light.
    let log = Complex::new(a, -b) / Complex::new(0.0, 2.0 * (0.5 * per_block).sin());
    // The logarithm of 1 + m sin has a fundamental of 2 (1 − √(1 − m²)) / m.
    let t = 0.5 * log.norm();
    let amount = (2.0 * t / (1.0 + t * t)).min(DEEPEST);
    let omega = per_block / profile.block as f64;
    let gain = Complex::from_polar(amount, log.arg() - 0.5 * omega * (profile.block as f64 - 1.0));
    Some(Gain { omega, harmonics: vec![[gain.re, -gain.im]] })
}

/// The cosine and sine that fit the changes best beside a trend, counted from the first block, and the weighted squares of what is left.
fn wave(profile: &Profile, frequency: f64) -> Option<([f64; 2], f64)> {
    let count = profile.changes.len();
    let terms = |j: usize| {
        let [t0, t1, t2] = trend(j, count);
        let (sin, cos) = (2.0 * PI * frequency * (j as f64 + 0.5)).sin_cos();
        SVector::from([t0, t1, t2, cos, sin])
    };
    let (solution, cost) = least_squares(terms, &profile.changes, &profile.weights)?;
    Some(([solution[TREND], solution[TREND + 1]], cost))
}

/// Powers of the place of a change, −1 to 1 from the first to the last.
fn trend(j: usize, count: usize) -> [f64; TREND] {
    let u = (2.0 * j as f64 + 1.0) / count as f64 - 1.0;
    [1.0, u, u * u]
}

/// The weights of changes beside a trend, without those of outliers, and the weighted squares of what the trend leaves. `changes` stand in the
/// place of the profile's.
fn robust(profile: &Profile, changes: &[f64]) -> (Vec<f64>, f64) {
    const ROUNDS: usize = 4;
    let count = changes.len();
    let mut weights = profile.weights.clone();
    let mut cost = 0.0;
    for _ in 0..ROUNDS {
        let Some((trend_of, _)) = least_squares(|j| SVector::from(trend(j, count)), changes, &weights) else {
            break;
        };
        let left = |j: usize| changes[j] - SVector::from(trend(j, count)).dot(&trend_of);
        let whitened: Vec<f64> = (0..count).map(|j| left(j) * profile.weights[j].sqrt()).collect();
        let known = whitened.iter().zip(&profile.weights).filter(|(_, w)| **w > 0.0);
        let scale = robust_scale(known.map(|(z, _)| z.abs())).max(f64::MIN_POSITIVE);
        let loss = Loss::Huber(HUBER * scale);
        cost = 0.0;
        for (j, z) in whitened.iter().enumerate() {
            let weight = if *z == 0.0 { 1.0 } else { loss.weight(z * z) };
            weights[j] = profile.weights[j] * weight;
            cost += weight * z * z;
        }
    }
    (weights, cost)
}

/// How far the strips agree on the gain: the mean of how much of it each shows, in σ of that mean. `None` where too few show any.
fn agreement(strips: &[Vec<Option<Profile>>], gains: &[Gain]) -> Option<f64> {
    /// Strips that must know something.
    const MIN_STRIPS: usize = STRIPS / 2;
    let mut seen = [Share::default(); STRIPS];
    for (strips, gain) in strips.iter().zip(gains) {
        for (strip, seen) in strips.iter().zip(&mut seen) {
            let Some(strip) = strip else { continue };
            let count = strip.changes.len();
            let logs = gain.logarithms(strip.block, count + 1)?;
            let shape: Vec<f64> = logs.windows(2).map(|l| l[1].0 - l[0].0).collect();
            let terms = |j: usize| {
                let [t0, t1, t2] = trend(j, count);
                SVector::from([t0, t1, t2, shape[j]])
            };
            let trend = |j: usize| SVector::from(trend(j, count));
            let Some((share, cost)) = least_squares(terms, &strip.changes, &strip.weights) else { continue };
            // The part of the shape that is no trend is what the strip knows of it.
            let Some((_, information)) = least_squares(trend, &shape, &strip.weights) else { continue };
            seen.sum += information * share[TREND];
            seen.information += information;
            seen.cost += cost;
            let known = strip.weights.iter().filter(|w| **w > 0.0).count();
            seen.freedom = seen.freedom.max(known.saturating_sub(TREND + 1) as f64);
        }
    }
    let shares: Vec<(f64, f64)> = seen.iter().filter_map(Share::with_weight).collect();
    if shares.len() < MIN_STRIPS {
        return None;
    }
    let weight: f64 = shares.iter().map(|s| s.1).sum();
    let mean = shares.iter().map(|(share, w)| w * share).sum::<f64>() / weight;
    let scatter = shares.iter().map(|(share, w)| w * (share - mean).powi(2)).sum::<f64>();
    // Strips that contradict each other by more than their own σ make that of the mean larger.
    let variance = (scatter / (shares.len() - 1) as f64).max(1.0) / weight;
    Some(mean / variance.sqrt())
}

/// How much of a gain one strip shows, of all channels.
#[derive(Debug, Clone, Copy, Default)]
struct Share {
    sum: f64,
    information: f64,
    cost: f64,
    freedom: f64,
}

impl Share {
    /// The share and 1/σ² of it. Channels show the same picture, and count as one.
    fn with_weight(&self) -> Option<(f64, f64)> {
        let known = self.freedom > 0.0 && self.information > 0.0;
        known.then(|| {
            let variance = self.cost / self.freedom / self.information + BEST_KNOWN.powi(2);
            (self.sum / self.information, 1.0 / variance)
        })
    }
}

/// Weighted least squares: the solution and the weighted squares of what is left.
fn least_squares<const N: usize>(
    terms: impl Fn(usize) -> SVector<f64, N>,
    wanted: &[f64],
    weights: &[f64],
) -> Option<(SVector<f64, N>, f64)> {
    let mut normal = SMatrix::<f64, N, N>::zeros();
    let mut side = SVector::<f64, N>::zeros();
    let mut squares = 0.0;
    for (j, (d, w)) in wanted.iter().zip(weights).enumerate().filter(|(_, (_, w))| **w > 0.0) {
        let terms = terms(j);
        for column in 0..N {
            let t = w * terms[column];
            for row in column..N {
                normal[(row, column)] += t * terms[row];
            }
            side[column] += t * d;
        }
        squares += w * d * d;
    }
    let solution = normal.cholesky()?.solve(&side);
    Some((solution, (squares - side.dot(&solution)).max(0.0)))
}
