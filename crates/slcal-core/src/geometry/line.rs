//! Lines of the projective plane, their joins and meets.

use nalgebra::{Matrix2, Point2, SymmetricEigen, Vector2, Vector3};

use super::ProjectivePoint;

/// A homogeneous line (a, b, c): the points with a·x + b·y + c·w = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line(pub Vector3<f64>);

impl Line {
    /// The join of two points, finite or at infinity.
    #[must_use]
    pub fn through(p: ProjectivePoint, q: ProjectivePoint) -> Self {
        Self(p.0.cross(&q.0))
    }

    /// The join of two pixels.
    #[must_use]
    pub fn through_pixels(p: Point2<f64>, q: Point2<f64>) -> Self {
        // Cross product of offsets from the midpoint: no cancellation for close points far from the origin.
        let normal = Vector2::new(p.y - q.y, q.x - p.x);
        let mid = nalgebra::center(&p, &q);
        Self(Vector3::new(normal.x, normal.y, -normal.dot(&mid.coords)))
    }

    /// The meet of two lines; at infinity when they are parallel.
    #[must_use]
    pub fn meet(self, other: Self) -> ProjectivePoint {
        ProjectivePoint(self.0.cross(&other.0))
    }

    /// The line with |(a, b)| = 1, so that [`Line::signed_distance_px`] is in pixels; `None` for the line at infinity.
    #[must_use]
    pub fn normalized(self) -> Option<Self> {
        let n = self.0.xy().norm();
        (n > 0.0 && n.is_finite()).then(|| Self(self.0 / n))
    }

    /// Signed distance of a pixel from a [normalized](Line::normalized) line, px.
    #[must_use]
    pub fn signed_distance_px(&self, p: Point2<f64>) -> f64 {
        self.0.x * p.x + self.0.y * p.y + self.0.z
    }

    /// Unit normal of a normalized line.
    #[must_use]
    pub fn normal(&self) -> Vector2<f64> {
        self.0.xy()
    }

    /// The total-least-squares line through weighted points; `None` for fewer than two distinct points or a
    /// vanishing total weight. The result is normalized.
    #[must_use]
    pub fn fit(points: impl Iterator<Item = (Point2<f64>, f64)> + Clone) -> Option<Self> {
        let (mut sum, mut weight) = (Vector2::zeros(), 0.0);
        for (p, w) in points.clone() {
            sum += p.coords * w;
            weight += w;
        }
        if weight.is_nan() || weight <= 0.0 {
            return None;
        }
        let mean = sum / weight;
        let mut scatter = Matrix2::zeros();
        for (p, w) in points {
            let d = p.coords - mean;
            scatter += d * d.transpose() * w;
        }
        let eigen = SymmetricEigen::try_new(scatter, f64::EPSILON, 64)?;
        let small = eigen.eigenvalues.imin();
        if eigen.eigenvalues[1 - small] <= f64::EPSILON * mean.norm_squared() * weight {
            return None;
        }
        let n = eigen.eigenvectors.column(small).into_owned();
        Some(Self(Vector3::new(n.x, n.y, -n.dot(&mean))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_lines_meet_at_infinity() {
        let a = Line::through_pixels(Point2::new(0.0, 1.0), Point2::new(5.0, 1.0));
        let b = Line::through_pixels(Point2::new(2.0, 7.0), Point2::new(9.0, 7.0));
        let v = a.meet(b);
        assert!(v.pixel().is_none());
        assert_eq!(v.0.y, 0.0);
    }

    #[test]
    fn fit_recovers_a_line_and_ignores_points_of_weight_zero() {
        let line = Line(Vector3::new(0.6, -0.8, 12.0));
        let along = Vector2::new(0.8, 0.6);
        let points = (0..20).map(|i| {
            let p = Point2::from(line.normal() * -12.0 + along * f64::from(i));
            if i == 7 { (p + line.normal() * 50.0, 0.0) } else { (p, 1.0 + f64::from(i)) }
        });
        let fitted = Line::fit(points).unwrap();
        let sign = fitted.0.x.signum();
        assert!((fitted.0 * sign - line.0).norm() < 1e-12);
    }

    #[test]
    fn one_point_is_no_line() {
        assert!(Line::fit([(Point2::new(3.0, 4.0), 1.0); 5].into_iter()).is_none());
        assert!(Line::fit(std::iter::empty()).is_none());
    }
}
