//! Where stripes are as fine as the blur, borders of the code come in disorder, and cells are off by one or two. Along a line positions
//! rise or fall, so that the mean of a pixel's neighbourhood on a surface is its middle, however steep it is.

use super::code_borders::are_linked;

/// A position farther from the mean of its neighbourhood is wrong, cells.
const MOST_STRAY: f32 = 0.75;
/// Pixels on either side that make up a neighbourhood.
const NEIGHBOURS: usize = 3;
/// One over the pixels of a neighbourhood, by those on either side.
const MEAN: [f32; NEIGHBOURS + 1] = [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0];
/// 1σ of the mean of a neighbourhood whose borders are in disorder, cells.
const DISORDER: f32 = 0.5;

/// Replaces a position that is far from the mean of its neighbourhood.
#[inline]
fn settle(cell_px: f32, to: &mut f32, sigma: &mut f32, mean: f32) {
    let is_stray = (*to - mean).abs() > MOST_STRAY * cell_px || *sigma >= cell_px;
    *to = if is_stray { mean } else { *to };
    *sigma = if is_stray { DISORDER * cell_px } else { *sigma };
}

/// Settles the positions of a row of the image, along it. `before` is a buffer.
pub(super) fn settle_row(
    cell_px: f32,
    cells: &[u16],
    to: &mut [f32],
    to_sigma: &mut [f32],
    before: &mut Vec<f32>,
) {
    before.clear();
    before.extend_from_slice(to);
    let mut start = 0;
    while start < cells.len() {
        let mut end = start + 1;
        while end < cells.len() && are_linked(cells[end - 1], cells[end]) {
            end += 1;
        }
        let run = start..end;
        settle_run(cell_px, &before[run.clone()], &mut to[run.clone()], &mut to_sigma[run]);
        start = end;
    }
}

fn settle_run(cell_px: f32, near: &[f32], to: &mut [f32], to_sigma: &mut [f32]) {
    let n = near.len();
    let whole = 2 * NEIGHBOURS + 1;
    let inner = if n < whole { n..n } else { NEIGHBOURS..n - NEIGHBOURS };
    for i in (0..inner.start).chain(inner.end..n) {
        let reach = NEIGHBOURS.min(i).min(n - 1 - i);
        let near = &near[i - reach..=i + reach];
        settle(cell_px, &mut to[i], &mut to_sigma[i], near.iter().sum::<f32>() / near.len() as f32);
    }
    let inner = to[inner.clone()].iter_mut().zip(&mut to_sigma[inner]);
    for ((to, sigma), near) in inner.zip(near.windows(whole)) {
        settle(cell_px, to, sigma, near.iter().sum::<f32>() * (1.0 / whole as f32));
    }
}

/// Settles the positions of all pixels along the columns of the image. `cells` gives those of a row.
pub(super) fn settle_columns<'a>(
    cell_px: f32,
    width: usize,
    cells: impl Fn(usize) -> &'a [u16],
    to: &mut [f32],
    to_sigma: &mut [f32],
) {
    let height = to.len() / width;
    // For each column, how many pixels above are on the same surface, and whether the next ones below are.
    let mut above = vec![0_u8; width];
    let mut linked: [Vec<bool>; NEIGHBOURS] = std::array::from_fn(|_| vec![false; width]);
    let link = |y: usize, out: &mut [bool]| {
        if y + 1 >= height {
            out.fill(false);
            return;
        }
        for (out, (a, b)) in out.iter_mut().zip(cells(y).iter().zip(cells(y + 1))) {
            *out = are_linked(*a, *b);
        }
    };
    for (k, linked) in linked.iter_mut().enumerate() {
        link(k, linked);
    }
    // What stood in the rows above before they were settled, the farthest first.
    let mut before: [Vec<f32>; NEIGHBOURS] = std::array::from_fn(|_| vec![f32::NAN; width]);
    let (beyond, mut spare) = (vec![f32::NAN; width], vec![0.0; width]);
    for y in 0..height {
        let (own, rows) = to[y * width..].split_at_mut(width);
        let mut below = rows.chunks_exact(width);
        let below: [&[f32]; NEIGHBOURS] = std::array::from_fn(|_| below.next().unwrap_or(&beyond));
        let oldest = std::mem::take(&mut before[0]);
        let near = [(&before[2], below[0]), (&before[1], below[1]), (&oldest, below[2])];
        let mut kept = std::mem::take(&mut spare);
        kept.clear();
        kept.extend_from_slice(own);
        for (x, (to, sigma)) in own.iter_mut().zip(&mut to_sigma[y * width..]).enumerate() {
            let below = usize::from(linked[0][x])
                + usize::from(linked[0][x] & linked[1][x])
                + usize::from(linked[0][x] & linked[1][x] & linked[2][x]);
            let reach = below.min(above[x].into());
            let mut sum = *to;
            for (k, (up, down)) in near.iter().enumerate() {
                sum += if k < reach { up[x] + down[x] } else { 0.0 };
            }
            settle(cell_px, to, sigma, sum * MEAN[reach]);
            above[x] = if linked[0][x] { (above[x] + 1).min(NEIGHBOURS as u8) } else { 0 };
        }
        spare = oldest;
        before[0] = kept;
        before.rotate_left(1);
        linked.rotate_left(1);
        link(y + NEIGHBOURS, &mut linked[NEIGHBOURS - 1]);
    }
}
