//! The measurements of photographs.

use nalgebra::Point2;

use crate::geometry::Side;
use crate::observations::{Observations, SheetObservation, UNKNOWN_SIGMA_PX};

/// What a measurement is of. Edge points are measured across the side alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Edge,
    Pair,
    SheetCorner,
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measurement {
    pub(crate) view: usize,
    pub(crate) seen: Point2<f64>,
    pub(crate) sigma_px: f64,
    pub(crate) of: Target,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Target {
    Edge(Side),
    /// A corner of the sheet: TL, TR, BR, BL.
    SheetCorner(usize),
    /// A projector pixel.
    Pair(Point2<f64>),
}

impl Measurement {
    pub(crate) fn kind(&self) -> Kind {
        match self.of {
            Target::Edge(_) => Kind::Edge,
            Target::SheetCorner(_) => Kind::SheetCorner,
            Target::Pair(_) => Kind::Pair,
        }
    }

    /// Number of its residuals.
    pub(crate) fn rows(&self) -> usize {
        if self.kind() == Kind::Edge { 1 } else { 2 }
    }
}

/// The measurements of all views in a fixed order.
pub(crate) fn measurements(observations: &Observations) -> Vec<Measurement> {
    let mut all = Vec::new();
    for (view, o) in observations.views.iter().enumerate() {
        let mut add = |seen, sigma_px: Option<f64>, of| {
            let sigma_px = sigma_px.unwrap_or(UNKNOWN_SIGMA_PX);
            all.push(Measurement { view, seen, sigma_px, of });
        };
        match &o.sheet {
            SheetObservation::Edges(sides) => {
                for (side, points) in Side::ALL.into_iter().zip(sides) {
                    for p in points {
                        add(p.position, p.sigma_px, Target::Edge(side));
                    }
                }
            }
            SheetObservation::Corners { corners, sigma_px } => {
                for (corner, &seen) in corners.iter().enumerate() {
                    add(seen, *sigma_px, Target::SheetCorner(corner));
                }
            }
        }
        if observations.projector.is_some() {
            o.pairs.iter().for_each(|p| add(p.camera, p.sigma_px, Target::Pair(p.projector)));
        }
    }
    all
}
