//! Losses of a format: reported where they move no projected point, otherwise refused with the error in pixels.

use nalgebra::Point2;

use super::files::ExchangeFormat;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Distortion};
use crate::rig::{Device, Rig};

/// Differences below this are negligible, px.
const NEGLIGIBLE_PX: f64 = 1e-7;
/// What moves no pixel by more than this, or by more than its own 1σ, is left out without asking, px.
const UNIMPORTANT_PX: f64 = 0.05;
/// Points along each side of the image on which lenses are compared.
const GRID: u32 = 33;

/// The losses of one export.
pub(super) struct Losses {
    format: ExchangeFormat,
    lossy: bool,
    /// One line each.
    pub(super) notes: Vec<String>,
}

/// What a format can represent.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Holds {
    /// The poses of the sheet.
    pub(super) poses: bool,
}

impl Losses {
    pub(super) fn new(format: ExchangeFormat, lossy: bool) -> Self {
        Self { format, lossy, notes: Vec::new() }
    }

    /// Notes the parts of a rig beyond its geometry that the format cannot represent.
    pub(super) fn around(&mut self, rig: &Rig, holds: Holds) {
        let of_pose = rig
            .projector
            .is_some_and(|p| p.from_camera.sigma_t_mm.is_some() || p.from_camera.sigma_r_rad.is_some());
        let views = if holds.poses { "photographs' names, residuals" } else { "poses of the sheet" };
        let left: Vec<&str> = [
            (of_pose || rig.devices().any(|(_, d)| d.sigma.is_some()), "σ"),
            (rig.covariance.is_some(), "covariance"),
            (rig.quality.is_some(), "verdict and warnings"),
            (rig.channel_registration.is_some(), "registration of the channels"),
            (!rig.views.is_empty(), views),
        ]
        .into_iter()
        .filter_map(|(has, name)| has.then_some(name))
        .collect();
        if !left.is_empty() {
            self.notes.push(format!("{} has no place for: {}", self.format.name(), left.join("; ")));
        }
    }

    /// Refuses to write `held` for a device, unless a lossy export is requested or what is left out is within the larger of
    /// [`UNIMPORTANT_PX`] and its own 1σ.
    pub(super) fn lens(&mut self, name: &str, device: &Device, held: &Camera) -> Result<()> {
        let full = &device.model;
        if full == held {
            return Ok(());
        }
        let off_px = farthest_px(full, held);
        let terms = terms(full, held);
        if off_px <= NEGLIGIBLE_PX {
            return Ok(());
        }
        let size = if off_px.is_finite() {
            format!("pixels move by up to {} px", shown(off_px))
        } else {
            "nobody can say how far pixels move".to_owned()
        };
        let own = own_sigma_px(device, held);
        if off_px <= own.max(UNIMPORTANT_PX) {
            let why = if off_px <= UNIMPORTANT_PX {
                String::new()
            } else {
                format!(", within 1σ of it ({} px)", shown(own))
            };
            self.notes
                .push(format!("{}: the {name} is written without {terms}: {size}{why}", self.format.name()));
            return Ok(());
        }
        if !self.lossy {
            return Err(Error::invalid(
                if name == "camera" { ErrorSubject::CameraLens } else { ErrorSubject::ProjectorLens },
                format!("one that {} can hold", self.format.name()),
                format!(
                    "{terms}, which it has no place for: without, {size}; choose another format (opencv and npz hold every lens), \
                     or ask for a lossy export"
                ),
            ));
        }
        self.notes.push(format!("{}: the {name} is written without {terms}: {size}", self.format.name()));
        Ok(())
    }
}

/// A length for messages.
fn shown(px: f64) -> String {
    if px >= 0.01 { format!("{px:.2}") } else { format!("{px:.1e}") }
}

/// The terms of `full` that `held` does not have, with their values.
fn terms(full: &Camera, held: &Camera) -> String {
    let names = ["k1", "k2", "p1", "p2", "k3"];
    let values = full.distortion.to_array().into_iter().zip(held.distortion.to_array());
    let lens =
        names.into_iter().zip(values).filter(|(_, (a, b))| a != b).map(|(n, (a, _))| format!("{n} = {a}"));
    let skew =
        (full.intrinsics.skew != held.intrinsics.skew).then(|| format!("skew = {} px", full.intrinsics.skew));
    lens.chain(skew).collect::<Vec<_>>().join(", ")
}

/// How far the 1σ of those coefficients of a lens that `held` does not have move pixels, px.
fn own_sigma_px(device: &Device, held: &Camera) -> f64 {
    let (Some(sigma), lens) = (device.sigma, device.model.distortion.to_array()) else { return 0.0 };
    let left_out = held.distortion.to_array().into_iter().zip(lens).map(|(a, b)| a != b);
    let moved = left_out.zip(sigma.distortion).enumerate().filter(|(_, (out, _))| *out).map(|(k, (_, s))| {
        let mut other = lens;
        other[k] += s;
        let other = Camera { distortion: Distortion::from_array(other), ..device.model };
        farthest_px(&device.model, &other)
    });
    moved.map(|px| px * px).sum::<f64>().sqrt()
}

/// Largest distance over the image between the projections by two models of one device, px.
fn farthest_px(full: &Camera, held: &Camera) -> f64 {
    let along = |i: u32, side: u32| f64::from(i) / f64::from(GRID - 1) * f64::from(side) - 0.5;
    let mut most: Option<f64> = None;
    for (i, j) in (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j))) {
        let p = Point2::new(along(i, full.width), along(j, full.height));
        let Some(x) = full.undistort(p) else { continue };
        let off = (held.intrinsics.pixel(held.distortion.distort(x)) - p).norm();
        most = Some(most.map_or(off, |m| m.max(off)));
    }
    most.filter(|m| m.is_finite()).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Intrinsics;
    use crate::rig::DeviceSigma;

    fn camera(distortion: Distortion, skew: f64) -> Camera {
        let intrinsics = Intrinsics { fx: 1000.0, fy: 1000.0, skew, cx: 319.5, cy: 239.5 };
        Camera { width: 640, height: 480, intrinsics, distortion }
    }

    #[test]
    fn the_largest_shift_is_that_of_the_corners() {
        // A corner lies 400 px from the centre; the lens takes r to r (1 + k1 r²).
        let lens = camera(Distortion { k1: 0.1, ..Distortion::NONE }, 0.0);
        let mut r: f64 = 0.4;
        for _ in 0..50 {
            r = 0.4 / (1.0 + 0.1 * r * r);
        }
        let expected = (0.4 - r) * 1000.0;
        assert!((farthest_px(&lens, &camera(Distortion::NONE, 0.0)) - expected).abs() < 1e-9);
        // Skew shears by s y/f: 2 · 240/1000.
        let sheared = farthest_px(&camera(Distortion::NONE, 2.0), &camera(Distortion::NONE, 0.0));
        assert!((sheared - 0.48).abs() < 1e-12, "{sheared}");
    }

    #[test]
    fn what_moves_pixels_is_refused_or_told() {
        let full = camera(Distortion { k3: 0.5, ..Distortion::NONE }, 0.0);
        let held = camera(Distortion::NONE, 0.0);
        let mut strict = Losses::new(ExchangeFormat::Kalibr, false);
        let message = strict.lens("camera", &full.into(), &held).unwrap_err().to_string();
        for word in ["camera", "kalibr", "k3 = 0.5", "px", "opencv"] {
            assert!(message.contains(word), "no {word} in {message}");
        }
        let mut lossy = Losses::new(ExchangeFormat::Kalibr, true);
        lossy.lens("camera", &full.into(), &held).unwrap();
        assert!(lossy.notes[0].contains("k3 = 0.5") && lossy.notes[0].contains("px"), "{:?}", lossy.notes);
        let tiny = camera(Distortion { k3: 1e-12, ..Distortion::NONE }, 0.0);
        assert!(strict.lens("camera", &tiny.into(), &held).is_ok() && strict.notes.is_empty());
    }

    #[test]
    fn what_its_own_sigma_exceeds_is_left_out_and_told() {
        // 400 px from the centre k1 moves by 64 px times itself.
        let (small, held) =
            (camera(Distortion { k1: 5e-4, ..Distortion::NONE }, 0.0), camera(Distortion::NONE, 0.0));
        let mut losses = Losses::new(ExchangeFormat::Kalibr, false);
        losses.lens("camera", &small.into(), &held).unwrap();
        assert!(
            losses.notes[0].contains("k1 = 0.0005") && !losses.notes[0].contains("σ"),
            "{:?}",
            losses.notes
        );
        let larger = camera(Distortion { k1: 5e-3, ..Distortion::NONE }, 0.0);
        assert!(losses.lens("camera", &larger.into(), &held).is_err());
        let sigma = |k1: f64| DeviceSigma { distortion: [k1, 0.0, 0.0, 0.0, 0.0], ..DeviceSigma::default() };
        let known = |k1: f64| Device { model: larger, sigma: Some(sigma(k1)) };
        losses.lens("camera", &known(6e-3), &held).unwrap();
        assert!(losses.notes[1].contains("within 1σ"), "{:?}", losses.notes);
        assert!(losses.lens("camera", &known(4e-3), &held).is_err());
    }
}
