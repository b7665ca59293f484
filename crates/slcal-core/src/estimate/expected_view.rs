//! What a photograph of the sheet in some pose is expected to give.

use nalgebra::{Point2, Vector2};

use super::measurement::{Measurement, Target};
use super::model::Model;
use super::prior::Priors;
use super::problem::BundleAdjustment;
use super::sheet::Sheet;
use super::unknowns::Unknowns;
use crate::geometry::{RectangleSize, Side};

/// Points that stand for a side of an expected view; their σ carries the information of all that would be measured.
pub(crate) const POINTS_PER_SIDE: usize = 8;

/// How the sheet of an expected view is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ExpectedSheet {
    /// Its corners, with this σ per coordinate, px.
    Corners(f64),
    /// [`POINTS_PER_SIDE`] points on each side (top, right, bottom, left), with these σ, px.
    Sides([f64; 4]),
}

/// What a photograph of the sheet is expected to give, whatever the pose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ExpectedView {
    pub(crate) size: RectangleSize,
    pub(crate) sheet: ExpectedSheet,
    /// Projected corners: projector pixel, and σ in the camera's image, px.
    pub(crate) pattern: Vec<(Point2<f64>, f64)>,
}

impl ExpectedView {
    /// Exact measurements of a sheet, as view `view`; `None` when part of the sheet is behind the camera.
    /// Projected corners that miss the sheet's plane are left out.
    fn at(&self, model: &Model, sheet: &Sheet, view: usize) -> Option<Vec<Measurement>> {
        let see = |p: Point2<f64>| model.camera.project(&sheet.lift_fixed(p));
        let corners = self.size.corners();
        let mut all = Vec::new();
        let mut add = |seen, sigma_px, of| all.push(Measurement { view, seen, sigma_px, of });
        match self.sheet {
            ExpectedSheet::Corners(sigma_px) => {
                for (i, c) in corners.into_iter().enumerate() {
                    add(see(c)?, sigma_px, Target::SheetCorner(i));
                }
            }
            ExpectedSheet::Sides(sigmas) => {
                for (side, sigma_px) in Side::ALL.into_iter().zip(sigmas) {
                    let (a, b) = (corners[side as usize], corners[(side as usize + 1) % 4]);
                    for i in 0..POINTS_PER_SIDE {
                        let p = a + (b - a) * ((i as f64 + 0.5) / POINTS_PER_SIDE as f64);
                        add(see(p)?, sigma_px, Target::Edge(side));
                    }
                }
            }
        }
        for &(q, sigma_px) in &self.pattern {
            if let Some(seen) = model.lit(sheet, q).and_then(|p| model.camera.project(&p)) {
                add(seen, sigma_px, Target::Pair(q));
            }
        }
        Some(all)
    }

    /// The problem that photographs of these sheets pose, and the model with these views.
    pub(crate) fn problem(
        &self,
        model: &Model,
        sheets: &[Sheet],
        unknowns: &Unknowns,
        priors: &Priors,
    ) -> Option<(BundleAdjustment, Model)> {
        let mut all = Vec::new();
        for (i, sheet) in sheets.iter().enumerate() {
            all.extend(self.at(model, sheet, i)?);
        }
        let problem = BundleAdjustment::new(all, unknowns.with_views(sheets.len()), priors.clone());
        Some((problem, model.with_views(sheets)))
    }

    /// The same with one σ for everything on the sheet and one for the projected corners, px.
    pub(crate) fn with_noise(mut self, [sheet, pattern]: [f64; 2]) -> Self {
        self.sheet = match self.sheet {
            ExpectedSheet::Corners(_) => ExpectedSheet::Corners(sheet),
            ExpectedSheet::Sides(_) => ExpectedSheet::Sides([sheet; 4]),
        };
        self.pattern.iter_mut().for_each(|(_, sigma)| *sigma = pattern);
        self
    }

    /// Whether the whole pattern falls on the sheet.
    pub(crate) fn holds_pattern(&self, model: &Model, sheet: &Sheet) -> bool {
        let back = sheet.pose.inverse();
        let on_sheet = |q| {
            let p = back.transform(&model.lit(sheet, q)?);
            Some((0.0..=self.size.width_mm).contains(&p.x) && (0.0..=self.size.height_mm).contains(&p.y))
        };
        self.pattern.iter().all(|&(q, _)| on_sheet(q).unwrap_or(false))
    }

    /// The middle of the projected corners on the panel.
    pub(crate) fn pattern_centre(&self) -> Point2<f64> {
        let sum: Vector2<f64> = self.pattern.iter().map(|(q, _)| q.coords).sum();
        Point2::from(sum / self.pattern.len() as f64)
    }

    /// Brings the projected corners nearer together until `fits`, or until nothing is left of them.
    pub(crate) fn shrink_pattern(&mut self, fits: impl Fn(&Self) -> bool) {
        while !fits(self) {
            let centre = self.pattern_centre();
            self.pattern.iter_mut().for_each(|(q, _)| *q = centre + (*q - centre) * 0.9);
            if self.pattern.iter().all(|(q, _)| (q - centre).norm() <= 1.0) {
                break;
            }
        }
    }
}
