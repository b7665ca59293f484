//! Pictures.

use crate::photo::Layout;

/// One picture in every layout of colour: samples, layout, samples per row.
pub(crate) fn layouts(rgb: &[u8], width: usize) -> Vec<(Vec<u8>, Layout, usize)> {
    let pixels = || rgb.as_chunks::<3>().0.iter();
    // A BGR frame with padding behind each row; the other layouts have none.
    let padded = pixels().map(|[r, g, b]| [*b, *g, *r]).collect::<Vec<_>>();
    let padded = padded.chunks(width).flat_map(|row| [row.as_flattened(), &[99, 99]].concat()).collect();
    vec![
        (rgb.to_vec(), Layout::Rgb, 3 * width),
        (padded, Layout::Bgr, 3 * width + 2),
        (pixels().flat_map(|[r, g, b]| [*r, *g, *b, 7]).collect(), Layout::Rgba, 4 * width),
        (pixels().flat_map(|[r, g, b]| [*b, *g, *r, 7]).collect(), Layout::Bgra, 4 * width),
    ]
}
