//! Camera ray ∩ projector light plane.

use nalgebra::{Matrix3, Point2, Point3, RowVector3, Vector3};
use serde::{Deserialize, Serialize};

use crate::cloud::{CloudPoint, Frame, PointCloud};
use crate::error::{Error, Result};
use crate::geometry::{Camera, Pose};
use crate::matches::{Match, Matches};
use crate::rig::Rig;

/// Which intersections are taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TriangulateConfig {
    /// Smallest angle between the camera's ray and the plane of light, rad; below, the point slides along the ray.
    pub min_angle_rad: f64,
    /// 1σ of the projected position of a slit's centre, projector px (the projector's own pixels and optics).
    pub projector_sigma_px: f64,
    /// How far outside the panel, as a share of its sides, the light of a point may come from before the match must be
    /// wrong.
    pub panel_margin: f64,
}

impl Default for TriangulateConfig {
    fn default() -> Self {
        Self { min_angle_rad: 0.005, projector_sigma_px: 0.05, panel_margin: 0.05 }
    }
}

impl TriangulateConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        let check = |what: &str, value: f64, most: f64| {
            if (0.0..=most).contains(&value) {
                return Ok(());
            }
            Err(Error::invalid(what, format!("0 to {most}"), value))
        };
        check("min_angle_rad", self.min_angle_rad, 1.0)?;
        check("projector_sigma_px", self.projector_sigma_px, 100.0)?;
        check("panel_margin", self.panel_margin, 100.0)
    }
}

/// Matches that became no point, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TriangulateReport {
    /// Points made.
    pub points: usize,
    /// Neither column nor row known, or not finite numbers, or a pixel that the lens's model does not reach.
    pub invalid: usize,
    /// The ray lies (nearly) in the plane of light.
    pub grazing: usize,
    /// They meet behind the camera or the projector.
    pub behind: usize,
    /// The light would come from outside the panel.
    pub outside_panel: usize,
}

/// Why a match is no point.
enum Refused {
    Invalid,
    Grazing,
    Behind,
    OutsidePanel,
}

/// Steps of the fixed-point iteration for the projector's distortion; each gains two or more digits.
const DISTORTION_STEPS: usize = 20;

/// Intersects every match's camera ray with the light of its projector column, row, or both, in the camera's frame.
///
/// The camera's two equations and the projector's one form a 3×3 linear system per point (paper, eq. 17–19); with column
/// and row, 4×3 in the least-squares sense. Lens distortion is undone first; that of the projector by iteration, since it
/// depends on the coordinate that is not known.
///
/// # Errors
/// [`Error::Invalid`] for a rig without a projector or a configuration out of range.
pub fn triangulate(
    rig: &Rig,
    matches: &Matches,
    config: &TriangulateConfig,
) -> Result<(PointCloud, TriangulateReport)> {
    config.validate()?;
    let (Some(projector), Some(stereo)) = (rig.projector, rig.stereo) else {
        return Err(Error::invalid(
            "rig",
            "a calibrated projector (calibrate with --pattern)",
            "a rig that holds the camera alone",
        ));
    };
    let pair = Pair {
        camera: rig.camera.model,
        projector: projector.model,
        pose: stereo.projector_from_camera,
        config: *config,
    };
    let mut report = TriangulateReport::default();
    let mut points = Vec::with_capacity(matches.items.len());
    for m in &matches.items {
        match pair.point(m) {
            Ok(p) => points.push(p),
            Err(Refused::Invalid) => report.invalid += 1,
            Err(Refused::Grazing) => report.grazing += 1,
            Err(Refused::Behind) => report.behind += 1,
            Err(Refused::OutsidePanel) => report.outside_panel += 1,
        }
    }
    report.points = points.len();
    let cloud =
        PointCloud { points, triangles: Vec::new(), frame: Frame::Camera, camera_centre: Point3::origin() };
    Ok((cloud, report))
}

struct Pair {
    camera: Camera,
    projector: Camera,
    pose: Pose,
    config: TriangulateConfig,
}

impl Pair {
    fn point(&self, m: &Match) -> std::result::Result<CloudPoint, Refused> {
        let finite = |x: Option<f64>| x.is_none_or(f64::is_finite);
        if !(m.camera.x.is_finite()
            && m.camera.y.is_finite()
            && finite(m.projector_column)
            && finite(m.projector_row))
            || (m.projector_column.is_none() && m.projector_row.is_none())
        {
            return Err(Refused::Invalid);
        }
        let ray = self.camera.bearing(m.camera).ok_or(Refused::Invalid)?;
        let (mut column, mut row) = (m.projector_column, m.projector_row);
        let mut x = self.solve(&ray, column, row)?;
        if !self.projector.distortion.is_none() {
            for _ in 0..DISTORTION_STEPS {
                // What the lens adds at the present estimate is taken off the coordinates that were observed.
                let shift = self.lens_shift(&x).ok_or(Refused::Behind)?;
                let corrected = |c: Option<f64>, s: f64| c.map(|c| c - s);
                (column, row) = (corrected(m.projector_column, shift.x), corrected(m.projector_row, shift.y));
                let next = self.solve(&ray, column, row)?;
                let done = (next - x).norm() <= 1e-12 * next.coords.norm();
                x = next;
                if done {
                    break;
                }
            }
        }
        let seen_by_projector = self.pose.transform(&x);
        if !(x.z > 0.0 && seen_by_projector.z > 0.0) {
            return Err(Refused::Behind);
        }
        let on_panel = self.projector.project(&seen_by_projector).ok_or(Refused::Behind)?;
        let inside = |v: f64, size: u32| {
            let margin = self.config.panel_margin * f64::from(size);
            (-0.5 - margin..=f64::from(size) - 0.5 + margin).contains(&v)
        };
        if !(inside(on_panel.x, self.projector.width) && inside(on_panel.y, self.projector.height)) {
            return Err(Refused::OutsidePanel);
        }
        let sigma_mm = self.sigma(m, &ray, &x, column, row, seen_by_projector.z);
        if !sigma_mm.is_finite() {
            return Err(Refused::Grazing);
        }
        Ok(CloudPoint {
            position: x,
            pixel: m.camera,
            color: m.color,
            sigma_mm,
            noise_mm: sigma_mm,
            slit: m.slit.unwrap_or(0),
            confidence: m.confidence,
        })
    }

    /// The plane of light of an ideal column or row c: n·X + d = 0 with (n, d) = row `axis` of K\[R|t\] less c times its last.
    fn light_plane(&self, axis: usize, c: f64) -> (Vector3<f64>, f64) {
        let k = self.projector.intrinsics.matrix();
        let mut across = k.row(axis).into_owned();
        across[2] -= c;
        let across: RowVector3<f64> = across;
        ((across * self.pose.rotation.matrix()).transpose(), (across * self.pose.translation)[0])
    }

    fn solve(
        &self,
        ray: &Vector3<f64>,
        column: Option<f64>,
        row: Option<f64>,
    ) -> std::result::Result<Point3<f64>, Refused> {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        let f = self.camera.intrinsics.fx;
        let light = [column.map(|c| self.light_plane(0, c)), row.map(|c| self.light_plane(1, c))];
        let steepest = light
            .iter()
            .flatten()
            .map(|(n, _)| (n.dot(ray) / (n.norm() * ray.norm())).abs())
            .fold(0.0, f64::max);
        if steepest.is_nan() || steepest < self.config.min_angle_rad.sin() {
            return Err(Refused::Grazing);
        }
        if let [Some((n, d)), None] | [None, Some((n, d))] = light {
            let a = Matrix3::new(1.0, 0.0, -ray.x, 0.0, 1.0, -ray.y, n.x, n.y, n.z);
            let x = a.lu().solve(&Vector3::new(0.0, 0.0, -d)).ok_or(Refused::Grazing)?;
            return Ok(Point3::from(x));
        }
        // Rows in pixels (times depth) of either device, so that their squares may be added.
        let camera = [Vector3::new(f, 0.0, -f * ray.x), Vector3::new(0.0, f, -f * ray.y)];
        for (n, d) in camera.into_iter().map(|n| (n, 0.0)).chain(light.into_iter().flatten()) {
            normal += n * n.transpose();
            right -= n * d;
        }
        normal.cholesky().map(|c| Point3::from(c.solve(&right))).ok_or(Refused::Grazing)
    }

    /// How far the projector's lens moves the pixel of a point, px.
    fn lens_shift(&self, x: &Point3<f64>) -> Option<nalgebra::Vector2<f64>> {
        let p = self.pose.transform(x);
        let ideal = nalgebra::Vector2::new(p.x / p.z, p.y / p.z);
        let k = &self.projector.intrinsics;
        let shift = k.pixel(self.projector.distortion.distort(ideal)) - k.pixel(ideal);
        (p.z > 0.0 && shift.x.is_finite() && shift.y.is_finite()).then_some(shift)
    }

    /// 1σ along the ray, mm: the camera position across the stripe and the slit's centre move the depth z of
    /// n·(z·ray) + d = 0.
    fn sigma(
        &self,
        m: &Match,
        ray: &Vector3<f64>,
        x: &Point3<f64>,
        column: Option<f64>,
        row: Option<f64>,
        projector_depth: f64,
    ) -> f64 {
        let one = |axis: usize, c: f64| {
            let (n, _) = self.light_plane(axis, c);
            let step = Point2::new(f64::from(u8::from(axis == 0)), f64::from(u8::from(axis == 1)));
            let moved = self.camera.bearing(m.camera + step.coords * 0.5);
            let slope = moved.map_or(Vector3::zeros(), |r| (r - ray) * 2.0);
            let along = n.dot(ray);
            let by_camera = x.z * n.dot(&slope) / along * m.sigma_px;
            let by_projector = projector_depth / along * self.config.projector_sigma_px;
            (by_camera * by_camera + by_projector * by_projector).sqrt() * ray.norm()
        };
        match (column.map(|c| one(0, c)), row.map(|c| one(1, c))) {
            (Some(a), Some(b)) => (a.powi(-2) + b.powi(-2)).powf(-0.5),
            (a, b) => a.or(b).unwrap_or(f64::NAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Distortion, Intrinsics};
    use crate::reconstruct::test_rig;

    fn distorted() -> Rig {
        let mut rig = test_rig();
        rig.camera.model.distortion = Distortion { k1: -0.12, k2: 0.03, p1: 1e-3, p2: -5e-4, k3: 0.0 };
        rig.camera.model.intrinsics = Intrinsics { fx: 1500.0, fy: 1480.0, skew: 1.5, cx: 700.0, cy: 420.0 };
        let projector = &mut rig.projector.as_mut().unwrap().model;
        projector.distortion = Distortion { k1: 0.05, k2: -0.02, p1: 1e-3, p2: 1e-3, k3: 0.0 };
        projector.intrinsics = Intrinsics { fx: 1700.0, fy: 1690.0, skew: -0.7, cx: 511.5, cy: 768.0 };
        rig
    }

    fn world() -> Vec<Point3<f64>> {
        (0..60)
            .map(|i| {
                let i = f64::from(i);
                Point3::new(
                    (i * 1.7).sin() * 150.0,
                    (i * 0.9).cos() * 40.0 - 30.0,
                    1000.0 + (i * 0.37).sin() * 120.0,
                )
            })
            .collect()
    }

    fn see(rig: &Rig, x: &Point3<f64>) -> Match {
        let p = rig.stereo.unwrap().projector_from_camera.transform(x);
        let on_panel = rig.projector.unwrap().model.project(&p).unwrap();
        Match {
            camera: rig.camera.model.project(x).unwrap(),
            projector_column: Some(on_panel.x),
            projector_row: Some(on_panel.y),
            slit: None,
            confidence: 1.0,
            sigma_px: 0.1,
            color: [0; 3],
        }
    }

    #[test]
    fn points_come_back_from_column_row_or_both_for_any_lens() {
        let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
        for rig in [test_rig(), distorted()] {
            let exact: Vec<Match> = world().iter().map(|x| see(&rig, x)).collect();
            let column = exact.iter().map(|m| Match { projector_row: None, ..*m }).collect();
            let row = exact.iter().map(|m| Match { projector_column: None, ..*m }).collect();
            for items in [exact, column, row] {
                let (cloud, report) = triangulate(&rig, &Matches { items }, &config).unwrap();
                assert_eq!(report.points, 60);
                for (p, x) in cloud.points.iter().zip(world()) {
                    assert!((p.position - x).norm() < 1e-6, "{} for {x}", p.position);
                }
            }
        }
    }

    #[test]
    fn sigma_is_the_scatter_of_noisy_matches() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, Normal};
        let rig = distorted();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
        let x = Point3::new(40.0, -20.0, 950.0);
        let truth = Match { projector_row: None, ..see(&rig, &x) };
        let (camera, centre) = (Normal::new(0.0, 0.1).unwrap(), Normal::new(0.0, 0.05).unwrap());
        let items: Vec<Match> = (0..4000)
            .map(|_| {
                let mut m = truth;
                m.camera.x += camera.sample(&mut rng);
                m.projector_column = m.projector_column.map(|c| c + centre.sample(&mut rng));
                m
            })
            .collect();
        let (cloud, _) = triangulate(&rig, &Matches { items }, &config).unwrap();
        let direction = x.coords.normalize();
        let variance =
            cloud.points.iter().map(|p| (p.position - x).dot(&direction).powi(2)).sum::<f64>() / 4000.0;
        let predicted = cloud.points[0].sigma_mm;
        // 4000 draws know a σ to 1.1 %.
        assert!((variance.sqrt() / predicted - 1.0).abs() < 0.05, "{} for {predicted}", variance.sqrt());
    }

    #[test]
    fn what_cannot_be_is_refused_and_counted() {
        let rig = test_rig();
        let good = Match { projector_row: None, ..see(&rig, &Point3::new(0.0, 0.0, 1000.0)) };
        let none = Match { projector_column: None, ..good };
        let nan = Match { camera: Point2::new(f64::NAN, 0.0), ..good };
        // A column on the other side: the light meets the ray behind the camera.
        let behind = Match { projector_column: good.projector_column.map(|c| c + 600.0), ..good };
        let items = vec![good, none, nan, behind];
        let (_, report) = triangulate(&rig, &Matches { items }, &TriangulateConfig::default()).unwrap();
        assert_eq!((report.points, report.invalid), (1, 2));
        assert_eq!(report.behind + report.outside_panel, 1);
        let mut alone = rig;
        alone.projector = None;
        assert!(triangulate(&alone, &Matches::default(), &TriangulateConfig::default()).is_err());
    }
}
