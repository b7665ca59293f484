//! Gaussian blur of pictures.

/// Gaussians are truncated where they have fallen to 3e-4 of their height.
const REACH: f64 = 4.0;

/// Values beyond the border of a blurred picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Border {
    /// Zero.
    Dark,
    /// The value at the border.
    Repeat,
}

/// Blurs a picture that is `width` wide by a Gaussian of `sigma` pixels.
pub(super) fn blur<const N: usize>(values: &mut [[f64; N]], width: usize, sigma: f64, border: Border) {
    let kernel = gaussian(sigma);
    blur_rows(values, width, &kernel, border);
    blur_columns(values, width, &kernel, border);
}

/// Half of a normalised kernel, its middle first.
fn gaussian(sigma: f64) -> Vec<f64> {
    let reach = (REACH * sigma).ceil() as usize;
    let half: Vec<f64> = (0..=reach).map(|i| libm::exp(-0.5 * (i as f64 / sigma).powi(2))).collect();
    let total = 2.0 * half.iter().sum::<f64>() - half[0];
    half.into_iter().map(|w| w / total).collect()
}

/// Blurs every row of a picture that is `width` wide.
fn blur_rows<const N: usize>(values: &mut [[f64; N]], width: usize, kernel: &[f64], border: Border) {
    let mut line = Vec::with_capacity(width);
    for row in values.chunks_exact_mut(width) {
        line.clear();
        line.extend_from_slice(row);
        for (x, out) in row.iter_mut().enumerate() {
            *out = [0.0; N];
            add(out, kernel[0], line[x]);
            for (i, w) in kernel.iter().enumerate().skip(1) {
                for at in [x.checked_sub(i), Some(x + i)] {
                    if let Some(from) = place(at, width, border) {
                        add(out, *w, line[from]);
                    }
                }
            }
        }
    }
}

/// Blurs every column.
fn blur_columns<const N: usize>(values: &mut [[f64; N]], width: usize, kernel: &[f64], border: Border) {
    let height = values.len() / width;
    let source = values.to_vec();
    for (y, row) in values.chunks_exact_mut(width).enumerate() {
        row.iter_mut().zip(&source[y * width..]).for_each(|(out, s)| *out = s.map(|v| v * kernel[0]));
        for (i, w) in kernel.iter().enumerate().skip(1) {
            for at in [y.checked_sub(i), Some(y + i)] {
                if let Some(from) = place(at, height, border) {
                    row.iter_mut().zip(&source[from * width..]).for_each(|(out, s)| add(out, *w, *s));
                }
            }
        }
    }
}

fn place(at: Option<usize>, length: usize, border: Border) -> Option<usize> {
    match (at.filter(|i| *i < length), border) {
        (Some(i), _) => Some(i),
        (None, Border::Dark) => None,
        (None, Border::Repeat) => Some(if at.is_none() { 0 } else { length - 1 }),
    }
}

fn add<const N: usize>(out: &mut [f64; N], weight: f64, value: [f64; N]) {
    for (o, v) in out.iter_mut().zip(value) {
        *o += weight * v;
    }
}
