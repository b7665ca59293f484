//! Explanations in the user's terms.

use super::explain::{Explained, Explanations};
use super::explanation::Explanation;
use crate::estimate::{Lens, Solution};
use crate::parameter::LensParameter;
use crate::rig::Warning;

/// What the photographs say.
pub(crate) enum Told {
    /// The mistakes are made good by what was estimated.
    MadeGood(Vec<Warning>),
    /// The result is doubtful.
    Doubt(Warning),
    /// Nothing may be built on the result.
    Contradiction(Warning),
}

/// What is told of explanations, and the solution where they make the mistakes good.
pub(crate) fn told(found: Explanations) -> Option<(Option<Solution>, Told)> {
    let Explanations { mut mistakes, alternatives, solution } = found;
    // Values and σ are those under all of them.
    for mistake in &mut mistakes {
        mistake.solution.clone_from(&solution);
    }
    let last = mistakes.last()?;
    if !alternatives.is_empty() {
        let mut warning = last.warning();
        let others: Vec<String> = alternatives.iter().map(Explained::finding).collect();
        warning.message = format!("{}; or {}", warning.message, others.join("; or "));
        return Some((None, Told::Doubt(warning)));
    }
    Some(match last.by {
        Explanation::Displaced(_) => (None, Told::Contradiction(last.warning())),
        Explanation::Proportion | Explanation::OtherSheet(_) => (None, Told::Doubt(last.warning())),
        _ => (Some(solution), Told::MadeGood(mistakes.iter().map(Explained::warning).collect())),
    })
}

impl Explained {
    fn warning(&self) -> Warning {
        Warning::new(self.code(), self.finding(), self.advice())
    }

    fn code(&self) -> &'static str {
        match self.by {
            Explanation::SidewaysShift(_) => "projector-sideways-shift",
            Explanation::ProjectorAspect => "projector-pixel-aspect",
            Explanation::CameraAspect => "camera-pixel-aspect",
            Explanation::Crop => "cropped",
            Explanation::Proportion => "aspect-doubtful",
            Explanation::Displaced(_) => "photograph-offset",
            Explanation::OtherSheet(_) => "view-contradicts",
        }
    }

    /// Value and 1σ of a lens parameter.
    fn value(&self, lens: Lens, parameter: LensParameter) -> (f64, f64) {
        let prior = self.solution.problem.priors.lenses.iter();
        let prior = prior.into_iter().find(|p| (p.lens, p.parameter) == (lens, parameter));
        let value = prior.and_then(|p| p.value(self.solution.model())).unwrap_or(0.0);
        (value, self.solution.sigma(lens, parameter).unwrap_or(0.0))
    }

    /// How far a principal point lies from the image's middle, and 1σ, px.
    fn off_centre(&self, lens: Lens, parameter: LensParameter) -> (f64, f64) {
        let (value, sigma) = self.value(lens, parameter);
        let size = self.solution.model().lens(lens).map_or([0; 2], |c| [c.width, c.height]);
        let extent = f64::from(size[usize::from(parameter == LensParameter::Cy)]);
        (value - (extent - 1.0) / 2.0, sigma)
    }

    fn finding(&self) -> String {
        let model = self.solution.model();
        match self.by {
            Explanation::SidewaysShift(axis) => {
                let (off, sigma) = self.off_centre(Lens::Projector, axis);
                let extent =
                    model.projector.map_or(1, |p| if axis == LensParameter::Cx { p.width } else { p.height });
                format!(
                    "the projector's lens is shifted sideways by {off:.0} ± {:.0} px, {:.0} % of the width",
                    sigma.max(1.0),
                    100.0 * off / f64::from(extent)
                )
            }
            Explanation::ProjectorAspect => {
                let (ln, sigma) = self.value(Lens::Projector, LensParameter::Aspect);
                format!(
                    "the projector's pixels are not square: they are {} times as wide as high",
                    with_sigma(ln.exp(), ln.exp() * sigma)
                )
            }
            Explanation::CameraAspect => {
                let (ln, sigma) = self.value(Lens::Camera, LensParameter::Aspect);
                format!(
                    "the photographs are stretched: fy/fx of the camera is {}",
                    with_sigma(ln.exp(), ln.exp() * sigma)
                )
            }
            Explanation::Crop => {
                let [x, y] = [LensParameter::Cx, LensParameter::Cy].map(|p| self.off_centre(Lens::Camera, p));
                format!(
                    "the photographs were cropped off centre: the lens's axis lies {:.0} ± {:.0} px {} and {:.0} ± {:.0} px {} the \
                     middle",
                    x.0.abs(),
                    x.1,
                    if x.0 < 0.0 { "left of" } else { "right of" },
                    y.0.abs(),
                    y.1,
                    if y.0 < 0.0 { "above" } else { "below" }
                )
            }
            Explanation::Proportion => {
                let size = model.views[0].size;
                let given = size.width_mm / size.height_mm * (-self.amounts.x).exp();
                format!(
                    "width to height of the sheet is {:.4} as it is seen, {given:.4} as it was given",
                    size.width_mm / size.height_mm
                )
            }
            Explanation::OtherSheet(view) => {
                let who = if model.views.len() == 2 {
                    "photographs 1 and 2 contradict each other".to_owned()
                } else {
                    format!("photograph {} contradicts the others", view + 1)
                };
                format!(
                    "{who}: they fit if the sheet of photograph {} is {:.3} times as large as it was given",
                    view + 1,
                    self.amounts.x.exp()
                )
            }
            Explanation::Displaced(view) => format!(
                "the image of photograph {} is displaced against {} by {:.1} px to the {} and {:.1} px {}; without that the \
                 residuals are {:.0} times smaller",
                view + 1,
                if model.views.len() == 2 { "that of photograph 1" } else { "those of the others" },
                self.amounts.x.abs(),
                if self.amounts.x < 0.0 { "left" } else { "right" },
                self.amounts.y.abs(),
                if self.amounts.y < 0.0 { "up" } else { "down" },
                (self.before / self.chi2.max(1.0)).sqrt()
            ),
        }
    }

    fn advice(&self) -> String {
        match self.by {
            Explanation::SidewaysShift(_) => "the result contains the shift and holds as it is; if the lens cannot be shifted, the picture \
                                           was moved on its way to the panel: switch digital shift and keystone correction off, \
                                           and take the photographs again"
                .to_owned(),
            Explanation::ProjectorAspect => "the result contains the ratio and holds for pictures that are shown in the same way; if \
                                             the projector has square pixels, show the pattern in the panel's own resolution, \
                                             and take the photographs again"
                .to_owned(),
            Explanation::CameraAspect => "the result contains the ratio and holds for photographs that are stretched in the same \
                                          way; photographs as the camera writes them are safer"
                .to_owned(),
            Explanation::Crop => "the result contains the crop and holds for photographs that are cropped in the same way; \
                                  photographs as the camera writes them are safer"
                .to_owned(),
            Explanation::Proportion => {
                let size = self.solution.model().views[0].size;
                let change = self.amounts.x;
                format!(
                    "measure the sheet again: {:.1}x{:.1} mm or {:.1}x{:.1} mm would fit; if its size is right, the principal point \
                     that was given or the lens's distortion is not",
                    size.width_mm * (change / 2.0).exp(),
                    size.height_mm * (change / 2.0).exp(),
                    size.width_mm * (-change / 2.0).exp(),
                    size.height_mm * (-change / 2.0).exp()
                )
            }
            Explanation::OtherSheet(_) => "check that all photographs show the same sheet, and that neither camera nor projector was moved, \
                                           zoomed or refocused in between; or leave that photograph out"
                .to_owned(),
            Explanation::Displaced(_) => "switch the stabiliser of camera and lens off, crop or scale no photograph, and take the \
                                          photographs again; or calibrate from one of them"
                .to_owned(),
        }
    }
}

/// Both with as many digits as σ supports, four decimals at least.
pub(super) fn with_sigma(value: f64, sigma: f64) -> String {
    let decimals = (1.0 - sigma.max(1e-9).log10().floor()).clamp(4.0, 9.0) as usize;
    format!("{value:.decimals$} ± {sigma:.decimals$}")
}
