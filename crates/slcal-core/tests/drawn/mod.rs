//! Random photographs of a sheet under a projector, drawn without bias: every edge pixel by a low-discrepancy set of
//! points shifted at random, blur by a symmetric kernel, noise on linear light.

use nalgebra::{Matrix3, Point2, Rotation3, Vector2, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use slcal_core::geometry::Homography;
use slcal_core::pattern::{CheckerPattern, SquareColor};
use slcal_core::photo::Encoding;

/// A scene with its truth.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) camera: [usize; 2],
    pub(crate) camera_focal_px: f64,
    pub(crate) camera_pp: Point2<f64>,
    pub(crate) projector_focal_px: f64,
    pub(crate) projector_pp: Point2<f64>,
    pub(crate) baseline_mm: f64,
    pub(crate) size_mm: [f64; 2],
    pub(crate) tilt_deg: f64,
    pub(crate) camera_from_sheet: Homography,
    pub(crate) camera_from_projector: Homography,
    /// σ of the lens's and the projector's blur together, px.
    pub(crate) blur_px: f64,
    /// Ambient light, and light added by the projector, on the sheet.
    pub(crate) light: [f64; 2],
    pub(crate) wall: f64,
    /// σ of a pixel in linear light: that of black, and what a full well adds.
    pub(crate) noise: [f64; 2],
    pub(crate) sixteen_bit: bool,
}

/// The blur is applied on a grid this much finer than the pixels: a lens blurs before the pixels integrate, and a blur of
/// whole pixels would be skewed for edges along the grid.
const FINE: usize = 3;

fn intrinsics(f: f64, pp: Point2<f64>) -> Matrix3<f64> {
    Matrix3::new(f, 0.0, pp.x, 0.0, f, pp.y, 0.0, 0.0, 1.0)
}

impl Drawn {
    /// A scene in which the whole board falls on a whole sheet, tilted by 14° to 38° in any direction.
    pub(crate) fn random(rng: &mut ChaCha8Rng, widths: &[usize], pattern: &CheckerPattern) -> Self {
        loop {
            if let Some(scene) = Self::attempt(rng, widths, pattern) {
                return scene;
            }
        }
    }

    fn attempt(rng: &mut ChaCha8Rng, widths: &[usize], pattern: &CheckerPattern) -> Option<Self> {
        let normal = |rng: &mut ChaCha8Rng, sigma: f64| Normal::new(0.0, sigma).unwrap().sample(rng);
        let w = widths[rng.random_range(0..widths.len())];
        let camera = [w, w * 3 / 4];
        let wf = w as f64;
        let f = wf * rng.random_range(0.8..1.7);
        let centre = |n: usize| (n as f64 - 1.0) / 2.0;
        let pp = Point2::new(centre(w) + normal(rng, 0.01 * wf), centre(camera[1]) + normal(rng, 0.01 * wf));
        let size_mm = [[594.0, 420.0], [420.0, 297.0], [841.0, 594.0]][rng.random_range(0..3)];
        let tilt = rng.random_range(14.0_f64..38.0);
        let direction = rng.random_range(0.0..std::f64::consts::TAU);
        let axis = Vector3::new(direction.sin(), direction.cos(), 0.0) * tilt.to_radians();
        let rotation = Rotation3::new(axis) * Rotation3::new(Vector3::z() * normal(rng, 0.15));
        let distance = size_mm[0] * f / wf / rng.random_range(0.45..0.75);
        let middle = Vector3::new(normal(rng, 0.04) * distance, normal(rng, 0.04) * distance, distance);
        let start = middle - rotation * Vector3::new(size_mm[0] / 2.0, size_mm[1] / 2.0, 0.0);
        let plane = |k: Matrix3<f64>, r: Matrix3<f64>, t: Vector3<f64>| {
            Homography(k * Matrix3::from_columns(&[r.column(0).into_owned(), r.column(1).into_owned(), t]))
        };
        let camera_from_sheet = plane(intrinsics(f, pp), *rotation.matrix(), start);
        let margin = 8.0;
        let within =
            |p: Point2<f64>, [w, h]: [f64; 2], m: f64| p.x > m && p.y > m && p.x < w - m && p.y < h - m;
        let corners = corners(size_mm);
        if !corners
            .iter()
            .all(|c| camera_from_sheet.map(*c).is_some_and(|p| within(p, camera.map(|n| n as f64), margin)))
        {
            return None;
        }

        let fp = 1024.0 * rng.random_range(1.2_f64..1.8);
        let shift = if rng.random_bool(0.5) { rng.random_range(0.0_f64..400.0) } else { 0.0 };
        let projector_pp = Point2::new(511.5, 383.5 + shift);
        let eye = Vector3::new(
            rng.random_range(-0.35..0.35),
            rng.random_range(-0.1..0.35),
            rng.random_range(-0.1..0.1),
        ) * distance;
        if eye.norm() < 0.12 * distance {
            return None;
        }
        // The ray of the panel's centre meets the sheet's.
        let z = (middle - eye).normalize();
        let x = Vector3::y().cross(&z).normalize();
        let aimed = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
        let lift = Rotation3::new(Vector3::x() * (shift / fp).atan());
        let projector_from_camera = lift.matrix() * aimed;
        let projector_from_sheet = plane(
            intrinsics(fp, projector_pp),
            projector_from_camera * rotation.matrix(),
            projector_from_camera * (start - eye),
        );
        let sheet_from_projector = projector_from_sheet.inverse()?;
        let [c, r] = pattern.squares.map(|n| f64::from(n) * pattern.square_px);
        let outer =
            [(0.0, 0.0), (c, 0.0), (c, r), (0.0, r)].map(|(x, y)| pattern.origin_px + Vector2::new(x, y));
        let centre_ok = projector_from_sheet.map(Point2::new(size_mm[0] / 2.0, size_mm[1] / 2.0))?;
        if (centre_ok - Point2::new(511.5, 383.5)).norm() > 2.0
            || !outer.iter().all(|q| sheet_from_projector.map(*q).is_some_and(|p| within(p, size_mm, 5.0)))
        {
            return None;
        }
        let scale = (wf / 1280.0).max(0.5);
        Some(Self {
            camera,
            camera_focal_px: f,
            camera_pp: pp,
            projector_focal_px: fp,
            projector_pp,
            baseline_mm: eye.norm(),
            size_mm,
            tilt_deg: tilt,
            camera_from_sheet,
            camera_from_projector: camera_from_sheet.compose(&sheet_from_projector),
            blur_px: scale * rng.random_range(0.25..1.3),
            light: [rng.random_range(0.005..0.12), rng.random_range(0.25..0.7)],
            wall: rng.random_range(0.02..0.3),
            noise: [rng.random_range(0.0..0.004), rng.random_range(0.0..0.02)],
            sixteen_bit: rng.random_bool(0.3),
        })
    }

    pub(crate) fn sheet_corners(&self) -> [Point2<f64>; 4] {
        corners(self.size_mm).map(|c| self.camera_from_sheet.map(c).unwrap())
    }

    /// Linear light before blur on the fine grid, row-major.
    fn ideal(&self, pattern: &CheckerPattern, rng: &mut ChaCha8Rng) -> Vec<f64> {
        /// Points per fine pixel on an edge; shifted at random, their mean has no bias.
        const POINTS: u32 = 40;
        /// The plastic number's powers: the R2 sequence of M. Roberts.
        const STEP: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];
        let sheet_from_camera = self.camera_from_sheet.inverse().unwrap();
        let projector_from_camera = self.camera_from_projector.inverse().unwrap();
        let region = |p: Point2<f64>| -> u8 {
            let on_sheet = sheet_from_camera
                .map(p)
                .is_some_and(|s| s.x > 0.0 && s.y > 0.0 && s.x < self.size_mm[0] && s.y < self.size_mm[1]);
            if on_sheet {
                1 + u8::from(projector_from_camera.map(p).is_some_and(|q| shown(pattern, q)))
            } else {
                0
            }
        };
        let levels = [self.wall * self.light[0], self.light[0], self.light[0] + self.light[1]];
        let width = FINE * self.camera[0];
        let mut image = vec![0.0; width * FINE * self.camera[1]];
        for y in 0..self.camera[1] {
            for x in 0..self.camera[0] {
                let at = |dx: f64, dy: f64| region(Point2::new(x as f64 + dx, y as f64 + dy));
                let first = at(0.0, 0.0);
                let even = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)]
                    .iter()
                    .all(|o| at(o.0, o.1) == first);
                // Vignetting, smooth over the whole frame.
                let r =
                    (Vector2::new(x as f64, y as f64) - self.camera_pp.coords).norm() / self.camera[0] as f64;
                let fall = 1.0 - 0.4 * r * r;
                for (i, j) in (0..FINE * FINE).map(|k| (k % FINE, k / FINE)) {
                    let mean = if even {
                        levels[usize::from(first)]
                    } else {
                        let origin: [f64; 2] = [rng.random(), rng.random()];
                        let offset = |n: u32, axis: usize, part: usize| {
                            ((origin[axis] + f64::from(n) * STEP[axis]).fract() + part as f64) / FINE as f64
                                - 0.5
                        };
                        let sum: f64 = (0..POINTS)
                            .map(|n| levels[usize::from(at(offset(n, 0, i), offset(n, 1, j)))])
                            .sum();
                        sum / f64::from(POINTS)
                    };
                    image[(FINE * y + j) * width + FINE * x + i] = mean * fall;
                }
            }
        }
        image
    }

    /// Code values of a grey photograph, 0–1 in steps of its bit depth.
    pub(crate) fn photograph(&self, pattern: &CheckerPattern, rng: &mut ChaCha8Rng) -> Vec<u16> {
        let fine = blurred(&self.ideal(pattern, rng), FINE * self.camera[0], FINE as f64 * self.blur_px);
        let mut image = reduced(&fine, self.camera);
        let unit = Normal::new(0.0, 1.0).unwrap();
        for v in &mut image {
            let sigma = (self.noise[0].powi(2) + self.noise[1].powi(2) * *v).sqrt();
            *v += sigma * unit.sample(rng);
        }
        let top = if self.sixteen_bit { 65535.0 } else { 255.0 };
        image
            .iter()
            .map(|v| ((Encoding::Srgb.from_linear(*v) * top).round() * (65535.0 / top)) as u16)
            .collect()
    }
}

fn corners([w, h]: [f64; 2]) -> [Point2<f64>; 4] {
    [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(x, y)| Point2::new(x, y))
}

/// Whether the projector lights this pixel of its panel.
fn shown(pattern: &CheckerPattern, q: Point2<f64>) -> bool {
    let [w, h] = pattern.projector.map(f64::from);
    if !(q.x > -0.5 && q.y > -0.5 && q.x < w - 0.5 && q.y < h - 0.5) {
        return false;
    }
    let s = ((q - pattern.origin_px) / pattern.square_px).map(f64::floor);
    let [columns, rows] = pattern.squares.map(f64::from);
    if s.x >= 0.0 && s.y >= 0.0 && s.x < columns && s.y < rows {
        ((s.x + s.y) % 2.0 == 0.0) == (pattern.first_square == SquareColor::White)
    } else {
        pattern.background == SquareColor::White
    }
}

/// The mean over blocks of `FINE`×`FINE` pixels.
fn reduced(fine: &[f64], [w, h]: [usize; 2]) -> Vec<f64> {
    let block = |x: usize, y: usize| {
        let row = |j: usize| &fine[(FINE * y + j) * FINE * w + FINE * x..][..FINE];
        (0..FINE).map(|j| row(j).iter().sum::<f64>()).sum::<f64>() / (FINE * FINE) as f64
    };
    (0..w * h).map(|i| block(i % w, i / w)).collect()
}

/// Gaussian blur with the border repeated.
fn blurred(image: &[f64], width: usize, sigma: f64) -> Vec<f64> {
    let reach = (5.0 * sigma).ceil() as isize;
    let kernel: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let sum: f64 = kernel.iter().sum();
    let height = image.len() / width;
    let pass = |from: &[f64], n: usize, at: &dyn Fn(usize, usize) -> usize, lines: usize| {
        let mut out = vec![0.0; from.len()];
        for l in 0..lines {
            for i in 0..n {
                let near = kernel.iter().zip(-reach..).map(|(k, d)| {
                    let j = (i as isize + d).clamp(0, n as isize - 1) as usize;
                    k * from[at(l, j)]
                });
                out[at(l, i)] = near.sum::<f64>() / sum;
            }
        }
        out
    };
    let rows = pass(image, width, &|l, i| l * width + i, height);
    pass(&rows, height, &|l, i| i * width + l, width)
}
