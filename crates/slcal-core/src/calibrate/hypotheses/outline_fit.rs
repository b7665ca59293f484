//! How well outlines go with rectangles of given proportions, in closed form up to three unknowns of the lens: for many sizes at
//! once, before any of them is fitted.
//!
//! With H = [h1 h2 h3] from the sheet to pixels, K⁻¹h1 and K⁻¹h2 are perpendicular and of equal length for the right K and the
//! right size (Z. Zhang, "A flexible new technique for camera calibration", PAMI 22 (2000)). A wrong proportion asks for a
//! focal length or a principal point that no camera has.

use nalgebra::{DVector, Matrix3, Vector3};

use super::plausible::usual_focal;
use crate::calibrate::config::CalibrateConfig;
use crate::estimate::assumptions::PrincipalPointRule;
use crate::estimate::planar_pose::camera_from_sheet;
use crate::geometry::{Camera, Homography, RectangleSize};
use crate::observations::{Observations, ViewObservation};
use crate::solve::{Block, INITIAL_DAMPING, Linearised, Loss, Problem, Structure, minimise_from};

/// 1σ of the angle between the sides and of ln of their ratio: distortion and bends move corners by about a per cent.
const TOLERANCE: f64 = 0.01;
/// 1σ of a principal point that is free, as a share of the width.
const FREE: f64 = 0.3;
/// 1σ of what is known exactly; a number above zero keeps the unknowns where they are.
const EXACT: f64 = 1e-6;
/// Focal lengths that the search starts from, in units of the longer side of the image, and its steps.
const STARTS: [f64; 5] = [0.5, 1.2, 3.0, 8.0, 20.0];
const STEPS: usize = 30;
/// Step of differences, and the decrease of χ² that ends the search.
const DIFFERENCE: f64 = 1e-5;
const CONVERGED: f64 = 1e-3;

/// ln f, and the principal point, all in units of the longer side of the image.
type Lens = Vector3<f64>;

/// The outlines of all sheets, and what is known of the lens.
pub(super) struct Outlines {
    /// Images of the unit square.
    squares: Vec<Homography>,
    side: f64,
    /// Height of pixels over their width, fx/fy.
    squeeze: f64,
    mean: Lens,
    sigma: Lens,
}

impl Outlines {
    /// `None` where an outline is no quadrilateral.
    pub(super) fn new(sheet: &Observations, config: &CalibrateConfig) -> Option<Self> {
        let known = config.known_camera.as_ref();
        let square = |v: &ViewObservation| {
            let scale = Matrix3::from_diagonal(&Vector3::new(v.size.width_mm, v.size.height_mm, 1.0));
            Some(Homography(camera_from_sheet(v, known).ok()?.0 * scale))
        };
        let squares = sheet.views.iter().map(square).collect::<Option<_>>()?;
        let side = f64::from(sheet.camera[0].max(sheet.camera[1]));
        let (mean, sigma) = known.map_or_else(|| expected(config, sheet.camera), |c| exactly(c, side));
        let squeeze = known.map_or(1.0, |c| c.intrinsics.fx / c.intrinsics.fy);
        Some(Self { squares, side, squeeze, mean, sigma })
    }

    /// χ² of the outlines as sheets of these sizes, one for each, with the lens that suits them best.
    pub(super) fn chi2(&self, sizes: &[RectangleSize]) -> f64 {
        let ratios: Vec<f64> = sizes.iter().map(|s| (s.width_mm / s.height_mm).ln()).collect();
        let starts = if self.sigma.x > EXACT { &STARTS[..] } else { &[1.0] };
        let from = |start: &f64| {
            let ln_f = if self.sigma.x > EXACT { start.ln() } else { self.mean.x };
            self.lowest(&ratios, Lens::new(ln_f, self.mean.y, self.mean.z))
        };
        starts.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Residuals of the lens against what is known of it, and of each outline.
    fn residuals(&self, ratios: &[f64], lens: &Lens) -> DVector<f64> {
        let known = (lens - self.mean).component_div(&self.sigma);
        let f = lens.x.exp() * self.side;
        let normalised = |h: Vector3<f64>| {
            let [x, y] = [h.x - lens.y * self.side * h.z, (h.y - lens.z * self.side * h.z) * self.squeeze];
            Vector3::new(x / f, y / f, h.z)
        };
        let of_outline = |(square, ratio): (&Homography, &f64)| {
            let [across, down, _] = square.columns().map(normalised);
            let (width, height) = (across.norm(), down.norm());
            [across.dot(&down) / (width * height), (width / height).ln() - ratio].map(|off| off / TOLERANCE)
        };
        let outlines = self.squares.iter().zip(ratios).flat_map(of_outline);
        DVector::from_iterator(3 + 2 * ratios.len(), known.iter().copied().chain(outlines))
    }

    fn lowest(&self, ratios: &[f64], lens: Lens) -> f64 {
        let blocks = vec![Block { len: 1, loss: Loss::Square }; 3 + 2 * ratios.len()];
        let fit = LensFit { outlines: self, ratios, blocks };
        minimise_from(&fit, lens, INITIAL_DAMPING, CONVERGED).map_or(f64::INFINITY, |m| m.cost)
    }
}

/// The lens that suits outlines of given proportions best.
struct LensFit<'a> {
    outlines: &'a Outlines,
    ratios: &'a [f64],
    blocks: Vec<Block>,
}

impl Problem for LensFit<'_> {
    type State = Lens;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        Structure::dense(3)
    }

    fn linearise(&self, lens: &Lens, at: &mut Linearised) -> Option<()> {
        at.residuals = self.outlines.residuals(self.ratios, lens);
        for k in 0..3 {
            let step = DIFFERENCE * self.outlines.sigma[k].min(1.0);
            let mut moved = *lens;
            moved[k] += step;
            let by_step = (self.outlines.residuals(self.ratios, &moved) - &at.residuals) / step;
            at.jacobian.set_column(k, &by_step);
        }
        Some(())
    }

    fn step(&self, lens: &Lens, delta: &DVector<f64>) -> Option<Lens> {
        Some(lens + Vector3::new(delta[0], delta[1], delta[2]))
    }

    fn max_iterations(&self) -> usize {
        STEPS
    }
}

/// What is known of a lens under a configuration.
fn expected(config: &CalibrateConfig, size: [u32; 2]) -> (Lens, Lens) {
    let side = f64::from(size[0].max(size[1]));
    let focal = usual_focal(config, size);
    let middle = config.camera_pp.start(size) / side;
    let share = match config.camera_pp {
        PrincipalPointRule::Centre | PrincipalPointRule::Exact(..) => EXACT,
        PrincipalPointRule::Free => FREE,
        PrincipalPointRule::Prior | PrincipalPointRule::Shift => config.principal_point_sigma,
    };
    (Lens::new((focal.focal_px / side).ln(), middle.x, middle.y), Lens::new(focal.sigma_share, share, share))
}

/// A lens that is known.
fn exactly(camera: &Camera, side: f64) -> (Lens, Lens) {
    let k = &camera.intrinsics;
    (Lens::new((k.fx / side).ln(), k.cx / side, k.cy / side), Lens::repeat(EXACT))
}
