//! Many draws of noise (and of truth) through the public estimator, for the tests that ask whether σ is true.

use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::scene::{observe, pose, rig, rng, with_edges};
use crate::calibrate::{CalibrateConfig, Flatness, calibrate_observations};
use crate::estimate::covariance::posterior;
use crate::estimate::{BundleAdjustment, Model, Priors, Unknowns, measurements};
use crate::geometry::{Camera, Distortion, SheetBend};
use crate::observations::Observations;
use crate::rig::{Device, Rig};

/// What is drawn anew for every draw besides the noise.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Drawn {
    /// 1σ of the principal points (both of the camera, cx of the projector) as a share of the width.
    pub(crate) pp_share: f64,
    /// 1σ of k1, and of k2.
    pub(crate) k: [f64; 2],
    /// Everything that is uncertain by default, besides.
    pub(crate) ordinary: bool,
}

impl Drawn {
    /// All that is assumed by default.
    pub(crate) const ORDINARY: Self = Self { pp_share: 0.02, k: [0.0; 2], ordinary: true };
}

/// 1σ of k1, k2, p1, p2, k3 of ordinary cameras and projectors.
pub(crate) const ORDINARY: [[f64; 5]; 2] = [[0.2, 0.2, 7e-4, 7e-4, 0.1], [0.02, 0.02, 3e-4, 3e-4, 0.01]];

/// Draws the coefficients of an ordinary lens and its pixels' aspect; lenses that fold are drawn again.
pub(crate) fn draw_lens(lens: &mut Camera, sigmas: [f64; 5], draw: &mut impl FnMut(f64) -> f64) {
    lens.intrinsics.fy = lens.intrinsics.fx * draw(0.002).exp();
    loop {
        lens.distortion = Distortion::from_array(sigmas.map(&mut *draw));
        let part = |k: u32, length: u32| f64::from(k) / 10.0 * f64::from(length);
        let grid = (0..=10).flat_map(|i| (0..=10).map(move |j| (i, j)));
        let mut seen = grid.map(|(i, j)| Point2::new(part(i, lens.width), part(j, lens.height)));
        if seen.all(|p| lens.bearing(p).is_some()) {
            return;
        }
    }
}

/// One kind of photograph.
#[derive(Debug, Clone)]
pub(crate) struct Scenario {
    /// Tilts about the camera's X and Y axes, degrees, one pair per view.
    pub(crate) tilts: Vec<(f64, f64)>,
    pub(crate) projector: bool,
    /// Edge points per side; `None` for corners.
    pub(crate) edges: Option<usize>,
    /// 1σ of corners or edge points, and of projected corners, px.
    pub(crate) noise_px: [f64; 2],
    pub(crate) drawn: Drawn,
    /// Vertical principal point of the projector, px, and its centre in the camera frame, mm; `None` for that of `rig`.
    pub(crate) projector_at: Option<(f64, [f64; 3])>,
}

impl Scenario {
    /// Corners at 0.2 px and projected corners at 0.1 px.
    pub(crate) fn corners(tilts: &[(f64, f64)]) -> Self {
        Self {
            tilts: tilts.to_vec(),
            projector: true,
            edges: None,
            noise_px: [0.2, 0.1],
            drawn: Drawn::default(),
            projector_at: None,
        }
    }

    /// 40 edge points per side at 0.1 px, projected corners at 0.1 px.
    pub(crate) fn edges(tilts: &[(f64, f64)]) -> Self {
        Self { edges: Some(40), noise_px: [0.1, 0.1], ..Self::corners(tilts) }
    }

    /// The mean of the truths.
    pub(crate) fn centre(&self) -> Model {
        let cy = self.projector_at.map_or(768.0, |at| at.0);
        let mut truth = rig(cy, self.tilts.iter().map(|&(x, y)| pose(x, y)).collect());
        if let Some((_, centre)) = self.projector_at {
            let rotation = truth.projector_from_camera.rotation;
            truth.projector_from_camera.translation = -(rotation * nalgebra::Vector3::from(centre));
        }
        if !self.projector {
            truth.projector = None;
        }
        truth
    }

    fn truth(&self, rng: &mut ChaCha8Rng) -> Model {
        let mut truth = self.centre();
        let mut draw = |sigma: f64| Normal::new(0.0, sigma).unwrap().sample(rng);
        let c = &mut truth.camera;
        let spread = self.drawn.pp_share * f64::from(c.width);
        c.intrinsics.cx += draw(spread);
        c.intrinsics.cy += draw(spread);
        c.distortion.k1 += draw(self.drawn.k[0]);
        c.distortion.k2 += draw(self.drawn.k[1]);
        if let Some(p) = &mut truth.projector {
            p.intrinsics.cx += draw(self.drawn.pp_share * f64::from(p.width));
        }
        if self.drawn.ordinary {
            let lenses = [Some(&mut truth.camera), truth.projector.as_mut()];
            for (lens, sigmas) in lenses.into_iter().flatten().zip(ORDINARY) {
                draw_lens(lens, sigmas, &mut draw);
            }
            for view in &mut truth.views {
                view.bend = SheetBend(Flatness::Paper.sigmas_mm(view.size).map(&mut draw));
            }
        }
        truth
    }

    fn observed(&self, truth: &Model, noise_px: [f64; 2], rng: &mut ChaCha8Rng) -> Observations {
        let o = observe(truth, noise_px[0], noise_px[1], rng);
        match self.edges {
            Some(n) => with_edges(o, truth, n, noise_px[0], rng),
            None => o,
        }
    }

    /// Truth and noisy observations of draw `k`.
    pub(crate) fn draw(&self, k: u64) -> (Model, Observations) {
        let mut rng = rng(k);
        let truth = self.truth(&mut rng);
        let o = self.observed(&truth, self.noise_px, &mut rng);
        (truth, o)
    }

    /// Names of the unknowns and the Cramér–Rao bound of their σ at the mean truth, priors counted; ln f for focal lengths.
    pub(crate) fn bound(&self, config: &CalibrateConfig) -> Vec<(String, f64)> {
        let truth = self.centre();
        let mut o = self.observed(&truth, [1e-9, 1e-9], &mut rng(0));
        for view in &mut o.views {
            view.map_sigma(|_| Some(self.noise_px[0]), |_| Some(self.noise_px[1]));
        }
        let assumptions = config.assumptions();
        let unknowns = Unknowns::new(&assumptions, self.projector, self.tilts.len());
        let priors = Priors::new(&assumptions, &unknowns, &truth);
        let problem = BundleAdjustment::new(measurements(&o), unknowns, priors);
        let kept = vec![true; problem.measurements.len()];
        let c = posterior(&problem, &truth, &kept, [1.0; 2]).unwrap();
        let parameters = problem.unknowns.parameters().into_iter().enumerate();
        parameters.map(|(i, p)| (p.to_string(), c[(i, i)].sqrt())).collect()
    }
}

/// Error and reported σ of one quantity in one draw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Off {
    pub(crate) name: &'static str,
    /// Focal lengths relative, lengths in mm or px.
    pub(crate) error: f64,
    pub(crate) sigma: f64,
}

/// Errors of everything whose error bars are promised; what was held fixed is left out.
pub(crate) fn errors(found: &Rig, truth: &Model) -> Vec<Off> {
    let mut all = Vec::new();
    let mut lens = |names: [&'static str; 5], d: &Device, t: &Camera| {
        let (s, k, e) = (d.sigma.unwrap(), d.model.intrinsics, t.intrinsics);
        let coefficient = |i: usize| d.model.distortion.to_array()[i] - t.distortion.to_array()[i];
        let values = [
            ((k.fx - e.fx) / e.fx, s.focal_px / k.fx),
            (k.cx - e.cx, s.cx_px),
            (k.cy - e.cy, s.cy_px),
            (coefficient(0), s.distortion[0]),
            (coefficient(1), s.distortion[1]),
        ];
        for (name, (error, sigma)) in names.into_iter().zip(values) {
            if sigma > 0.0 {
                all.push(Off { name, error, sigma });
            }
        }
    };
    lens(["f_cam", "cx_cam", "cy_cam", "k1", "k2"], &found.camera, &truth.camera);
    if let (Some(d), Some(t)) = (&found.projector, &truth.projector) {
        lens(["f_proj", "cx_proj", "cy_proj", "", ""], &d.device, t);
        let error = found.baseline_mm().unwrap() - truth.projector_from_camera.translation.norm();
        all.push(Off { name: "baseline", error, sigma: found.baseline_sigma_mm().unwrap() });
    }
    all
}

/// How one quantity fared over all draws.
#[derive(Debug, Clone)]
pub(crate) struct Tally {
    pub(crate) name: &'static str,
    pub(crate) draws: usize,
    /// Share of draws whose 95 % interval holds the truth.
    pub(crate) held: f64,
    pub(crate) bias: f64,
    pub(crate) rms: f64,
    pub(crate) mean_sigma: f64,
}

/// What came of all draws.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) failed: usize,
    pub(crate) first_error: Option<String>,
    pub(crate) tallies: Vec<Tally>,
}

impl Outcome {
    pub(crate) fn of(&self, name: &str) -> &Tally {
        self.tallies.iter().find(|t| t.name == name).unwrap()
    }
}

/// Calibrates `draws` draws on two threads; draw k is the same whatever the number of threads.
pub(crate) fn run(scenario: &Scenario, config: &CalibrateConfig, draws: usize, seed: u64) -> Outcome {
    let one = |k: usize| {
        let (truth, o) = scenario.draw(seed.wrapping_mul(1_000_003) + k as u64);
        calibrate_observations(&o, config).map(|c| errors(&c.rig, &truth)).map_err(|e| e.to_string())
    };
    let results: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> =
            (0..2).map(|w| scope.spawn(move || (w..draws).step_by(2).map(one).collect::<Vec<_>>())).collect();
        workers.into_iter().flat_map(|w| w.join().unwrap()).collect()
    });
    let first_error = results.iter().find_map(|r| r.as_ref().err().cloned());
    let good: Vec<&Vec<Off>> = results.iter().filter_map(|r| r.as_ref().ok()).collect();
    let names = ["f_cam", "cx_cam", "cy_cam", "k1", "k2", "f_proj", "cx_proj", "cy_proj", "baseline"];
    let tallies = names.into_iter().filter_map(|name| {
        let all: Vec<&Off> = good.iter().flat_map(|v| v.iter()).filter(|o| o.name == name).collect();
        let n = all.len() as f64;
        let mean = |f: &dyn Fn(&Off) -> f64| all.iter().map(|o| f(o)).sum::<f64>() / n;
        (!all.is_empty()).then(|| Tally {
            name,
            draws: all.len(),
            held: mean(&|o| f64::from(u8::from(o.error.abs() < 1.96 * o.sigma))),
            bias: mean(&|o| o.error),
            rms: mean(&|o| o.error * o.error).sqrt(),
            mean_sigma: mean(&|o| o.sigma * o.sigma).sqrt(),
        })
    });
    Outcome { failed: draws - good.len(), first_error, tallies: tallies.collect() }
}
