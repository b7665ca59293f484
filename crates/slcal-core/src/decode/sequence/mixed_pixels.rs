//! Pixels on the outline of a surface, which see two surfaces: their light is that of two places on the panel.

use crate::dense_matches::DenseMatches;

/// A pixel beside a jump sees both sides when its contrast is below this share of that of both.
const LEAST_SHARE: f32 = 0.85;

/// Drops pixels beside a jump of the position by more than `jump_px` on the panel whose contrast is clearly less than on either side of it.
/// Returns how many.
pub(super) fn drop_mixed(matches: &mut DenseMatches, jump_px: f32) -> usize {
    let (width, height) = (matches.width, matches.height);
    let of = if matches.column.is_empty() { &matches.row } else { &matches.column };
    let confidence = &matches.confidence;
    let is_jump = |a: f32, b: f32| (a - b).abs() > jump_px;
    // The pixel beside it may see both surfaces, too, and have no position.
    let beside = |near: usize, far: usize| if of[near].is_finite() { of[near] } else { of[far] };
    let known = |pixel: usize| if of[pixel].is_finite() { confidence[pixel] } else { f32::NAN };
    let is_weak = |pixel: usize, step: usize| {
        let before = known(pixel - 2 * step).max(known(pixel - 3 * step));
        let behind = known(pixel + 2 * step).max(known(pixel + 3 * step));
        // Where one side has no light, nothing is known of a second surface.
        confidence[pixel] < LEAST_SHARE * before && confidence[pixel] < LEAST_SHARE * behind
    };
    let mut mixed = Vec::new();
    for y in 0..height {
        let inside = (3..height.saturating_sub(3)).contains(&y);
        for x in 0..width {
            let pixel = y * width + x;
            let own = of[pixel];
            if !own.is_finite() {
                continue;
            }
            let along = x >= 3
                && x + 3 < width
                && (is_jump(beside(pixel - 1, pixel - 2), own) || is_jump(own, beside(pixel + 1, pixel + 2)))
                && is_weak(pixel, 1);
            let across = inside
                && (is_jump(beside(pixel - width, pixel - 2 * width), own)
                    || is_jump(own, beside(pixel + width, pixel + 2 * width)))
                && is_weak(pixel, width);
            if along || across {
                mixed.push(pixel);
            }
        }
    }
    let DenseMatches { column, sigma_column, row, sigma_row, .. } = matches;
    for plane in [column, sigma_column, row, sigma_row] {
        if !plane.is_empty() {
            for &pixel in &mixed {
                plane[pixel] = f32::NAN;
            }
        }
    }
    mixed.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two surfaces with a pixel between them that sees both, along rows or along columns.
    fn matches(along_rows: bool, contrast: f32) -> DenseMatches {
        let (width, height) = (20, 20);
        let of = |pixel: usize| if along_rows { pixel % width } else { pixel / width };
        let column =
            (0..width * height).map(|i| of(i) as f32 + if of(i) > 9 { 100.0 } else { 0.0 }).collect();
        let confidence = (0..width * height).map(|i| if of(i) == 9 { contrast } else { 0.95 }).collect();
        let sigma_column = vec![0.1; width * height];
        DenseMatches { width, height, column, sigma_column, confidence, ..DenseMatches::default() }
    }

    #[test]
    fn what_sees_two_surfaces_is_dropped_and_what_sees_one_stays() {
        for along_rows in [true, false] {
            let mut found = matches(along_rows, 0.7);
            assert_eq!(drop_mixed(&mut found, 8.0), 20);
            let gaps = found.column.iter().enumerate().filter(|(_, c)| c.is_nan());
            assert!(gaps.map(|(i, _)| if along_rows { i % 20 } else { i / 20 }).all(|at| at == 9));
            assert_eq!(found.sigma_column.iter().filter(|s| s.is_nan()).count(), 20);
            assert_eq!(drop_mixed(&mut matches(along_rows, 0.9), 8.0), 0);
            // Of a dim line on one surface nothing is dropped.
            let mut one = matches(along_rows, 0.5);
            one.column.iter_mut().for_each(|c| *c %= 100.0);
            assert_eq!(drop_mixed(&mut one, 8.0), 0);
        }
    }
}
