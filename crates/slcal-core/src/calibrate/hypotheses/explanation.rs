//! Mistakes that would explain photographs which do not fit what was assumed, and the problem that each of them poses.

use nalgebra::Vector2;

use crate::estimate::{BundleAdjustment, Lens, Model, Sheet};
use crate::parameter::LensParameter;

/// 1σ of a principal point that a mistake moved, in widths, and of the logarithm of a ratio.
const ANYWHERE: f64 = 0.5;
const ANY_RATIO: f64 = 0.5;

/// What may have happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Explanation {
    /// The projector's lens is shifted along this axis, across the one along which it usually is.
    SidewaysShift(LensParameter),
    /// The projector's pixels, or its picture, are stretched.
    ProjectorAspect,
    /// The photographs are stretched.
    CameraAspect,
    /// The photographs were cropped off centre.
    Crop,
    /// The sheet has other proportions.
    Proportion,
    /// The image of one photograph is displaced against those of the others.
    Displaced(usize),
    /// One photograph shows a larger or smaller sheet than the others.
    OtherSheet(usize),
}

impl Explanation {
    /// Those that can be told apart, with the photographs that may be the odd ones and the axis along which a projector's lens is
    /// not shifted.
    pub(super) fn all(odd: &[usize], sideways: Option<LensParameter>) -> Vec<Self> {
        let of_projector = |axis| [Self::SidewaysShift(axis), Self::ProjectorAspect];
        let mut all: Vec<_> = sideways.into_iter().flat_map(of_projector).collect();
        all.extend([Self::CameraAspect, Self::Crop, Self::Proportion]);
        all.extend(odd.iter().map(|view| Self::Displaced(*view)));
        all.extend(odd.iter().map(|view| Self::OtherSheet(*view)));
        all
    }

    /// Number of quantities that it adds.
    pub(super) fn parameters(self) -> usize {
        if matches!(self, Self::Crop | Self::Displaced(_)) { 2 } else { 1 }
    }

    /// The lens parameters whose priors it does away with; empty where it changes something else.
    pub(super) fn frees(self) -> Vec<(Lens, LensParameter)> {
        match self {
            Self::SidewaysShift(axis) => vec![(Lens::Projector, axis)],
            Self::ProjectorAspect => vec![(Lens::Projector, LensParameter::Aspect)],
            Self::CameraAspect => vec![(Lens::Camera, LensParameter::Aspect)],
            Self::Crop => vec![(Lens::Camera, LensParameter::Cx), (Lens::Camera, LensParameter::Cy)],
            Self::Proportion | Self::Displaced(_) | Self::OtherSheet(_) => Vec::new(),
        }
    }

    /// The problem without the priors that it does away with; `None` where the model holds those parameters fixed.
    pub(super) fn freed(self, mut problem: BundleAdjustment, model: &Model) -> Option<BundleAdjustment> {
        for (lens, parameter) in self.frees() {
            // The camera alone has nothing of the projector.
            let Some(device) = model.lens(lens) else { continue };
            let width = f64::from(device.width);
            let wide = if parameter == LensParameter::Aspect { ANY_RATIO } else { ANYWHERE * width };
            let mut priors = problem.priors.lenses.iter_mut();
            let prior = priors.find(|p| (p.lens, p.parameter) == (lens, parameter))?;
            prior.sigma = prior.sigma.max(wide);
        }
        Some(problem)
    }

    /// Problem and model changed by amounts of what is no parameter of a lens: ln of the proportion or of a size, px of a displacement.
    pub(super) fn changed(
        self,
        problem: &BundleAdjustment,
        model: &Model,
        amounts: Vector2<f64>,
    ) -> (BundleAdjustment, Model) {
        let (mut problem, mut model) = (problem.clone(), model.clone());
        match self {
            Self::Proportion => change_proportion(&mut model.views, amounts.x),
            Self::OtherSheet(view) => {
                let size = &mut model.views[view].size;
                size.width_mm *= amounts.x.exp();
                size.height_mm *= amounts.x.exp();
            }
            Self::Displaced(view) => {
                problem.measurements.iter_mut().filter(|m| m.view == view).for_each(|m| m.seen -= amounts);
            }
            _ => {}
        }
        (problem, model)
    }
}

/// Changes the proportion of the sheets by a factor e^`change`, area kept. A sheet that lies the other way round than the first
/// one changes its height by what that changes its width.
pub(super) fn change_proportion(views: &mut [Sheet], change: f64) {
    let across = |sheet: &Sheet| sheet.size.width_mm > sheet.size.height_mm;
    let first = views.first().is_some_and(across);
    for view in views {
        let change = if across(view) == first { change } else { -change };
        let factor = (change / 2.0).exp();
        view.size.width_mm *= factor;
        view.size.height_mm /= factor;
    }
}
