//! Pairs against a map of closed form, with errors that are known.

use nalgebra::{Matrix3, Point2};

use super::*;
use crate::dense_matches::DenseMatches;
use crate::error::Error;
use crate::for_tests::Noise;
use crate::geometry::Homography;
use crate::observations::{CornerPair, SheetObservation};

const WIDTH: usize = 480;
const HEIGHT: usize = 360;
const CORNERS: [(f64, f64); 4] = [(40.0, 30.0), (440.0, 60.0), (420.0, 320.0), (60.0, 330.0)];

fn sheet() -> SheetObservation {
    SheetObservation::Corners { corners: CORNERS.map(|(x, y)| Point2::new(x, y)), sigma_px: Some(0.1) }
}

/// A tilted sheet seen through a lens with radial distortion.
fn truth(camera: Point2<f64>) -> Point2<f64> {
    let h = Homography(Matrix3::new(1.5, 0.1, 80.0, -0.15, 1.7, 60.0, 4e-4, -2e-4, 1.0));
    let from_middle = (camera - Point2::new(239.5, 179.5)) / 500.0;
    h.map(camera + from_middle * (500.0 * 0.06 * from_middle.norm_squared())).unwrap()
}

/// Matches with these errors of column and row, in panel px.
fn matches(sigma: f32, mut error: impl FnMut(usize, usize) -> [f64; 2]) -> DenseMatches {
    let mut all = DenseMatches { width: WIDTH, height: HEIGHT, ..DenseMatches::default() };
    for i in 0..WIDTH * HEIGHT {
        let (u, v) = (i % WIDTH, i / WIDTH);
        let (at, e) = (truth(Point2::new(u as f64, v as f64)), error(u, v));
        all.column.push((at.x + e[0]) as f32);
        all.row.push((at.y + e[1]) as f32);
    }
    all.sigma_column = vec![sigma; WIDTH * HEIGHT];
    all.sigma_row = all.sigma_column.clone();
    all.confidence = vec![1.0; WIDTH * HEIGHT];
    all
}

/// Root mean square of the errors in the camera's image over σ.
fn error_over_sigma(pairs: &[CornerPair]) -> f64 {
    let square = |p: &CornerPair| {
        let step = 0.5;
        let along = |x: f64, y: f64| {
            let d = nalgebra::Vector2::new(x, y) * step;
            (truth(p.camera + d) - truth(p.camera - d)) / (2.0 * step)
        };
        let panel_by_camera = nalgebra::Matrix2::from_columns(&[along(1.0, 0.0), along(0.0, 1.0)]);
        let off = panel_by_camera.try_inverse().unwrap() * (truth(p.camera) - p.projector);
        off.norm_squared() / (2.0 * p.sigma_px.unwrap().powi(2))
    };
    (pairs.iter().map(square).sum::<f64>() / pairs.len() as f64).sqrt()
}

#[test]
fn sigma_is_that_of_the_errors_independent_or_alike() {
    let mut noise = Noise::new(3);
    let independent = matches(0.3, |_, _| [0.3 * noise.normal(), 0.3 * noise.normal()]);
    let found = sheet_pairs(&independent, &sheet()).unwrap();
    assert_eq!(found.pairs.len(), found.cells);
    assert!((150..400).contains(&found.cells), "{}", found.cells);
    let ratio = error_over_sigma(&found.pairs);
    assert!((0.85..1.15).contains(&ratio), "independent: {ratio}");
    let of_independent = found.pairs[100].sigma_px.unwrap();

    // What the decoder does not know: a scale of σ of its own, and errors that pixels of a row of a cell share.
    let mut common = Noise::new(5);
    let rows: Vec<[f64; 2]> =
        (0..HEIGHT * 32).map(|_| [0.2 * common.normal(), 0.2 * common.normal()]).collect();
    let alike = matches(0.1, |u, v| {
        let shared = rows[v * 32 + u / 15];
        [shared[0] + 0.1 * noise.normal(), shared[1] + 0.1 * noise.normal()]
    });
    let found = sheet_pairs(&alike, &sheet()).unwrap();
    let ratio = error_over_sigma(&found.pairs);
    assert!((0.8..1.25).contains(&ratio), "alike: {ratio}");
    assert!(found.pairs[100].sigma_px.unwrap() > 1.5 * of_independent);
}

#[test]
fn outliers_and_what_lies_on_the_sheet_do_not_matter() {
    let mut noise = Noise::new(7);
    let mut some = matches(0.1, |_, _| {
        let wrong = noise.uniform() < 0.1;
        let scale = if wrong { 60.0 } else { 0.1 };
        [scale * noise.normal(), scale * noise.normal()]
    });
    for v in 100..160 {
        for u in 150..230 {
            some.column[v * WIDTH + u] = f32::NAN;
        }
    }
    let found = sheet_pairs(&some, &sheet()).unwrap();
    assert!(found.pairs.len() < found.cells && found.pairs.len() > found.cells * 8 / 10);
    let hidden =
        |p: &CornerPair| (155.0..225.0).contains(&p.camera.x) && (105.0..155.0).contains(&p.camera.y);
    assert!(!found.pairs.iter().any(hidden));
    let ratio = error_over_sigma(&found.pairs);
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn positions_without_noise_are_exact_but_for_the_curvature() {
    let found = sheet_pairs(&matches(1e-4, |_, _| [0.0; 2]), &sheet()).unwrap();
    let ratio = error_over_sigma(&found.pairs);
    assert!(ratio < 1.2, "{ratio}");
    assert!(found.pairs.iter().all(|p| p.sigma_px.unwrap() < 0.01));
}

#[test]
fn columns_alone_and_a_dark_sheet_are_refused() {
    let mut columns = matches(0.1, |_, _| [0.0; 2]);
    columns.row.clear();
    columns.sigma_row.clear();
    let message = sheet_pairs(&columns, &sheet()).unwrap_err().to_string();
    assert!(message.contains("columns and rows") && message.contains("columns alone"), "{message}");
    let mut dark = matches(0.1, |_, _| [0.0; 2]);
    dark.column.fill(f32::NAN);
    let error = sheet_pairs(&dark, &sheet()).unwrap_err();
    assert!(matches!(error, Error::NotFound { .. }), "{error}");
    let corners = CORNERS.map(|(x, y)| Point2::new(0.05 * x, 0.05 * y));
    let speck = SheetObservation::Corners { corners, sigma_px: None };
    assert!(sheet_pairs(&matches(0.1, |_, _| [0.0; 2]), &speck).is_err());
}
