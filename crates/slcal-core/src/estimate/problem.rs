//! Bundle adjustment: residuals and Jacobian of all views, stacked and divided by their σ. A row depends on the devices and
//! on the pose of its own view alone, so that the cost grows linearly with the number of views.

use nalgebra::{DVector, Vector2};

use super::assumptions::Lens;
use super::measurement::{Kind, Measurement, Target};
use super::model::Model;
use super::prior::Priors;
use super::residual::{self, BEND, POSE, Residual};
use super::robust::RobustProblem;
use super::side::SideInImage;
use super::unknowns::Unknowns;
use crate::geometry::{SheetBend, Side};
use crate::parameter::LensParameter;
use crate::solve::{Block, Linearised, Loss, Problem, Structure};

/// Well-posed calibrations take 5 to 20 steps, nearly singular ones 100.
const MOST_STEPS: usize = 300;

/// Measurements of some views and what is known beforehand.
#[derive(Debug, Clone)]
pub(crate) struct BundleAdjustment {
    /// Ordered by view.
    pub(crate) measurements: Vec<Measurement>,
    pub(crate) unknowns: Unknowns,
    pub(crate) priors: Priors,
    /// Of the measurements, then of the bends' priors, then of the lenses'.
    pub(crate) blocks: Vec<Block>,
    /// Most steps of a minimisation.
    most_steps: usize,
    rows_of_views: Vec<usize>,
}

impl BundleAdjustment {
    pub(crate) fn new(mut measurements: Vec<Measurement>, unknowns: Unknowns, priors: Priors) -> Self {
        measurements.sort_by_key(|m| m.view);
        let mut rows_of_views = vec![0; unknowns.views()];
        for m in &measurements {
            rows_of_views[m.view] += m.rows();
        }
        let known = priors.bends.len() * BEND + priors.lenses.len();
        let rows = measurements.iter().map(Measurement::rows).chain(std::iter::repeat_n(1, known));
        let blocks = rows.map(|len| Block { len, loss: Loss::Square }).collect();
        Self { measurements, unknowns, priors, blocks, most_steps: MOST_STEPS, rows_of_views }
    }

    /// The same, minimised in so many steps at most.
    pub(crate) fn within(self, most_steps: usize) -> Self {
        Self { most_steps, ..self }
    }

    /// The same with the σ of edge points and the widths of the priors on bends (of order 2, and of 3 and 4) multiplied.
    pub(crate) fn weighted(&self, edges: f64, bends: [f64; 2]) -> Option<Self> {
        let mut other = self.clone();
        for m in other.measurements.iter_mut().filter(|m| m.kind() == Kind::Edge) {
            m.sigma_px *= edges;
        }
        for (k, sigma) in other.priors.bends.iter_mut().flat_map(|b| b.iter_mut().enumerate()) {
            *sigma *= bends[usize::from(SheetBend::order(k) > 2)];
        }
        (edges * bends[0] * bends[1]).is_finite().then_some(other)
    }

    /// Number of residuals, those of the priors included.
    pub(crate) fn rows(&self) -> usize {
        self.blocks.iter().map(|b| b.len).sum()
    }

    /// One weight for each row: that of its measurement, and one for what is known beforehand.
    pub(crate) fn row_weights(&self, of_measurements: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut weights = Vec::with_capacity(self.rows());
        for (m, weight) in self.measurements.iter().zip(of_measurements) {
            weights.resize(weights.len() + m.rows(), weight);
        }
        weights.resize(self.rows(), 1.0);
        weights
    }

    /// The residual of each measurement, `None` where the model is not defined.
    fn each<'a>(&'a self, model: &'a Model) -> impl Iterator<Item = (&'a Measurement, Option<Residual>)> {
        let camera = &model.camera;
        let mut last: Option<(usize, Side, Option<SideInImage>)> = None;
        let mut residual = move |m: &Measurement| {
            let sheet = model.views.get(m.view)?;
            match m.of {
                Target::Edge(side) => {
                    if last.as_ref().is_none_or(|l| (l.0, l.1) != (m.view, side)) {
                        last = Some((m.view, side, SideInImage::new(camera, sheet, side)));
                    }
                    last.as_ref()?.2.as_ref()?.residual(m.seen)
                }
                Target::SheetCorner(i) => {
                    residual::sheet_corner(camera, sheet, sheet.size.corners()[i], m.seen)
                }
                Target::Pair(q) => {
                    let projector = model.projector.as_ref()?;
                    let between = &model.projector_from_camera;
                    residual::projected_corner(camera, projector, between, sheet, q, m.seen)
                }
            }
        };
        self.measurements.iter().map(move |m| (m, residual(m)))
    }

    /// Lines do not distinguish front from behind: the sheet's corners do.
    fn in_front(model: &Model) -> bool {
        model.views.iter().all(|sheet| sheet.size.corners().into_iter().all(|c| sheet.lift(c).z > 0.0))
    }

    /// How far every measurement is from the model, as camera px from where it was seen to where it is expected.
    pub(crate) fn misses_px(&self, model: &Model) -> Option<Vec<Vector2<f64>>> {
        self.each(model).map(|(_, r)| Some(r?.miss)).collect()
    }

    /// Residuals and derivatives at a model; `None` where it is not defined.
    pub(crate) fn at(&self, model: &Model) -> Option<Linearised> {
        let mut at = Linearised::zeros(self);
        self.linearise(model, &mut at)?;
        Some(at)
    }

    fn put(&self, to: &mut Linearised, at: usize, rows: usize, r: &Residual, weight: f64) {
        let width = self.unknowns.width();
        for k in 0..rows {
            to.residuals[at + k] = r.value[k] * weight;
            let mut row = to.jacobian.row_mut(at + k);
            for (lens, by_lens) in Lens::ALL.into_iter().zip(&r.lenses) {
                for parameter in LensParameter::ALL {
                    if let Some(c) = self.unknowns.lens(lens, parameter) {
                        row[width + c] = by_lens[(k, parameter as usize)] * weight;
                    }
                }
            }
            for i in 0..POSE {
                row[i] = r.view[(k, i)] * weight;
                if let Some(c) = self.unknowns.projector_from_camera() {
                    row[width + c + i] = r.projector_from_camera[(k, i)] * weight;
                }
            }
            for i in 0..width - POSE {
                row[POSE + i] = r.bend[(k, i)] * weight;
            }
        }
    }
}

impl Problem for BundleAdjustment {
    type State = Model;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        let more = if self.priors.bends.is_empty() { 0 } else { BEND };
        Structure {
            shared: self.unknowns.shared,
            width: self.unknowns.width(),
            groups: &self.rows_of_views,
            more,
        }
    }

    fn linearise(&self, model: &Model, to: &mut Linearised) -> Option<()> {
        if !Self::in_front(model) {
            return None;
        }
        to.jacobian.fill(0.0);
        let mut at = 0;
        for (m, residual) in self.each(model) {
            self.put(to, at, m.rows(), &residual?, 1.0 / m.sigma_px);
            at += m.rows();
        }
        for (sigmas, sheet) in self.priors.bends.iter().zip(&model.views) {
            for (k, (sigma, c)) in sigmas.iter().zip(sheet.bend.0).enumerate() {
                to.residuals[at] = c / sigma;
                to.jacobian[(at, POSE + k)] = 1.0 / sigma;
                at += 1;
            }
        }
        for p in &self.priors.lenses {
            to.residuals[at] = p.residual(model)?;
            if let Some(c) = self.unknowns.lens(p.lens, p.parameter) {
                to.jacobian[(at, self.unknowns.width() + c)] = 1.0 / p.sigma;
            }
            at += 1;
        }
        Some(())
    }

    fn step(&self, model: &Model, delta: &DVector<f64>) -> Option<Model> {
        model.moved(&self.unknowns, delta)
    }

    fn max_iterations(&self) -> usize {
        self.most_steps
    }
}

impl RobustProblem for BundleAdjustment {
    fn measured(&mut self) -> (&[Measurement], &mut [Block]) {
        (&self.measurements, &mut self.blocks)
    }

    fn norms_px(&self, model: &Model) -> Option<Vec<f64>> {
        self.each(model).map(|(_, r)| Some(r?.value.norm())).collect()
    }

    fn renormalise(model: &mut Model) {
        model.renormalise();
    }
}
