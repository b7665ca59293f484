//! The joint least-squares problem of all views: residuals and Jacobian, stacked and divided by their σ. A row depends on
//! the devices and on the pose of its own view alone, so that the cost grows linearly with the number of views.

pub(crate) mod model;
pub(crate) mod refine;
pub(crate) mod residual;

use nalgebra::{DVector, Point2, Vector2};

use self::model::{Layout, Model, Prior, lens_values};
use self::residual::{LENS, POSE, PointResidual};
use crate::geometry::{RectangleSize, Side};
use crate::observations::{Observations, SheetObservation};
use crate::solve::{Block, Linearised, Loss, Problem, Structure};

/// What a residual block measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Edge,
    SheetCorner,
    Pair,
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
    /// A corner of the sheet, mm.
    SheetCorner(Point2<f64>),
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
}

/// The measurements of all views in a fixed order.
pub(crate) fn measurements(observations: &Observations) -> Vec<Measurement> {
    let mut all = Vec::new();
    for (view, o) in observations.views.iter().enumerate() {
        match &o.sheet {
            SheetObservation::Edges(sides) => {
                for (side, points) in Side::ALL.into_iter().zip(sides) {
                    all.extend(points.iter().map(|p| Measurement {
                        view,
                        seen: p.position,
                        sigma_px: p.sigma_px,
                        of: Target::Edge(side),
                    }));
                }
            }
            SheetObservation::Corners { corners, sigma_px } => {
                all.extend(corners.iter().zip(o.size.corners()).map(|(&seen, corner)| Measurement {
                    view,
                    seen,
                    sigma_px: *sigma_px,
                    of: Target::SheetCorner(corner),
                }));
            }
        }
        if observations.projector.is_some() {
            all.extend(o.pairs.iter().map(|p| Measurement {
                view,
                seen: p.camera,
                sigma_px: p.sigma_px,
                of: Target::Pair(p.projector),
            }));
        }
    }
    all
}

/// The joint problem.
#[derive(Clone)]
pub(crate) struct Joint {
    pub(crate) sizes: Vec<RectangleSize>,
    pub(crate) measurements: Vec<Measurement>,
    pub(crate) layout: Layout,
    pub(crate) priors: Vec<Prior>,
    pub(crate) blocks: Vec<Block>,
    /// Residuals of each view.
    rows_of_views: Vec<usize>,
}

/// A residual with its derivatives, of either dimension; it lives for one row, on the stack.
#[allow(clippy::large_enum_variant)]
enum Row {
    Edge(residual::EdgeResidual),
    Point(PointResidual),
}

impl Joint {
    pub(crate) fn new(
        sizes: Vec<RectangleSize>,
        mut measurements: Vec<Measurement>,
        layout: Layout,
        priors: Vec<Prior>,
    ) -> Self {
        measurements.sort_by_key(|m| m.view);
        let mut blocks: Vec<Block> = measurements
            .iter()
            .map(|m| Block { len: if m.kind() == Kind::Edge { 1 } else { 2 }, loss: Loss::Square })
            .collect();
        let mut rows_of_views = vec![0; sizes.len()];
        for (m, block) in measurements.iter().zip(&blocks) {
            rows_of_views[m.view] += block.len;
        }
        blocks.resize(blocks.len() + priors.len(), Block { len: 1, loss: Loss::Square });
        Self { sizes, measurements, layout, priors, blocks, rows_of_views }
    }

    /// Number of residuals, those of the priors included.
    pub(crate) fn rows(&self) -> usize {
        self.blocks.iter().map(|b| b.len).sum()
    }

    /// Sets the loss of all measurements of a kind.
    pub(crate) fn set_loss(&mut self, kind: Kind, loss: Loss) {
        for (block, m) in self.blocks.iter_mut().zip(&self.measurements) {
            if m.kind() == kind {
                block.loss = loss;
            }
        }
    }

    fn row(&self, model: &Model, m: &Measurement) -> Option<Row> {
        let pose = &model.views[m.view];
        match m.of {
            Target::Edge(side) => {
                residual::edge(&model.camera, pose, self.sizes[m.view], side, m.seen).map(Row::Edge)
            }
            Target::SheetCorner(corner) => {
                residual::sheet_corner(&model.camera, pose, corner, m.seen).map(Row::Point)
            }
            Target::Pair(q) => residual::projected_corner(
                &model.camera,
                model.projector.as_ref()?,
                &model.projector_from_camera,
                pose,
                q,
                m.seen,
            )
            .map(Row::Point),
        }
    }

    /// Lines do not tell in front from behind: the sheet's corners do.
    fn in_front(&self, model: &Model) -> bool {
        model.views.iter().zip(&self.sizes).all(|(pose, size)| {
            let depth = |c: Point2<f64>| pose.transform(&nalgebra::Point3::new(c.x, c.y, 0.0)).z;
            size.corners().into_iter().all(|c| depth(c) > 0.0)
        })
    }

    /// How far every measurement is from the model, as camera px from where it was seen to where it is expected.
    pub(crate) fn misses_px(&self, model: &Model) -> Option<Vec<Vector2<f64>>> {
        let miss = |m: &Measurement| {
            Some(match self.row(model, m)? {
                Row::Edge(e) => e.normal * -e.value,
                Row::Point(p) => p.value,
            })
        };
        self.measurements.iter().map(miss).collect()
    }

    /// Residual norms in pixels per measurement.
    pub(crate) fn norms_px(&self, model: &Model) -> Option<Vec<f64>> {
        self.measurements
            .iter()
            .map(|m| match self.row(model, m)? {
                Row::Edge(e) => Some(e.value.abs()),
                Row::Point(p) => Some(p.value.norm()),
            })
            .collect()
    }

    /// Residuals and derivatives at a model; `None` where it is not defined.
    pub(crate) fn at(&self, model: &Model) -> Option<Linearised> {
        let mut at = Linearised::zeros(self);
        self.linearise(model, &mut at)?;
        Some(at)
    }

    fn put_point(&self, to: &mut Linearised, at: usize, p: &PointResidual, weight: f64) {
        for k in 0..2 {
            to.residuals[at + k] = p.value[k] * weight;
            let mut row = to.jacobian.row_mut(at + k);
            for i in 0..LENS {
                if let Some(c) = self.layout.camera[i] {
                    row[POSE + c] = p.camera[(k, i)] * weight;
                }
                if let Some(c) = self.layout.projector[i] {
                    row[POSE + c] = p.projector[(k, i)] * weight;
                }
            }
            for i in 0..POSE {
                row[i] = p.view[(k, i)] * weight;
                if let Some(c) = self.layout.stereo {
                    row[POSE + c + i] = p.stereo[(k, i)] * weight;
                }
            }
        }
    }

    fn put_edge(&self, to: &mut Linearised, at: usize, e: &residual::EdgeResidual, weight: f64) {
        to.residuals[at] = e.value * weight;
        let mut row = to.jacobian.row_mut(at);
        for i in 0..LENS {
            if let Some(c) = self.layout.camera[i] {
                row[POSE + c] = e.camera[i] * weight;
            }
        }
        for i in 0..POSE {
            row[i] = e.view[i] * weight;
        }
    }
}

impl Problem for Joint {
    type State = Model;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        Structure { shared: self.layout.views, width: POSE, groups: &self.rows_of_views }
    }

    fn linearise(&self, model: &Model, to: &mut Linearised) -> Option<()> {
        if !self.in_front(model) {
            return None;
        }
        to.jacobian.fill(0.0);
        let mut at = 0;
        for m in &self.measurements {
            let weight = 1.0 / m.sigma_px;
            match self.row(model, m)? {
                Row::Edge(e) => {
                    self.put_edge(to, at, &e, weight);
                    at += 1;
                }
                Row::Point(p) => {
                    self.put_point(to, at, &p, weight);
                    at += 2;
                }
            }
        }
        for p in &self.priors {
            let (device, places) = if p.of_projector {
                (model.projector.as_ref()?, &self.layout.projector)
            } else {
                (&model.camera, &self.layout.camera)
            };
            to.residuals[at] = (lens_values(device)[p.index] - p.mean) / p.sigma;
            if let Some(c) = places[p.index] {
                to.jacobian[(at, POSE + c)] = 1.0 / p.sigma;
            }
            at += 1;
        }
        Some(())
    }

    fn step(&self, model: &Model, delta: &DVector<f64>) -> Option<Model> {
        model.moved(&self.layout, delta)
    }
}

#[cfg(test)]
mod tests;
