//! A cloud in a line, and as a table for notebooks.

use pyo3::prelude::*;
use slcal_core::CloudPoint;

use super::PointCloud;

#[pymethods]
impl PointCloud {
    fn _repr_html_(&self) -> String {
        let row =
            |(name, value)| format!("<tr><th style=\"text-align:left\">{name}</th><td>{value}</td></tr>");
        let rows = self.summary().into_iter().map(row).collect::<Vec<_>>().concat();
        format!("<table><caption>PointCloud</caption>{rows}</table>")
    }

    fn __repr__(&self) -> String {
        let n = self.cloud.points.len();
        let points = format!("{n} point{}", if n == 1 { "" } else { "s" });
        let triangles = match self.cloud.triangles.len() {
            0 => String::new(),
            m => format!(", {m} triangle{}", if m == 1 { "" } else { "s" }),
        };
        let distances = self
            .distances()
            .map_or_else(String::new, |[near, far]| format!(", {near:.1} to {far:.1} mm from the camera"));
        let sigma = self.median_sigma().map_or_else(String::new, |s| format!(", median σ {s:.3} mm"));
        format!("PointCloud({points}{triangles}{distances}{sigma})")
    }
}

impl PointCloud {
    /// Least and greatest distance from the camera, mm.
    fn distances(&self) -> Option<[f64; 2]> {
        let centre = &self.cloud.camera_centre;
        let all = || self.cloud.points.iter().map(|p| (p.position - centre).norm()).filter(|d| d.is_finite());
        Some([all().reduce(f64::min)?, all().reduce(f64::max)?])
    }

    /// Median of σ, mm; `None` where none is known.
    fn median_sigma(&self) -> Option<f64> {
        let known = |p: &CloudPoint| p.sigma_mm.is_finite() && p.sigma_mm > 0.0;
        let mut sigma: Vec<f64> = self.cloud.points.iter().filter(|p| known(p)).map(|p| p.sigma_mm).collect();
        let middle = sigma.len() / 2;
        (!sigma.is_empty()).then(|| *sigma.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// What a notebook shows.
    fn summary(&self) -> Vec<(&'static str, String)> {
        let mut words = vec![("points", self.cloud.points.len().to_string())];
        if !self.cloud.triangles.is_empty() {
            words.push(("triangles", self.cloud.triangles.len().to_string()));
        }
        if let Some([near, far]) = self.distances() {
            words.push(("distance from the camera", format!("{near:.1} to {far:.1} mm")));
        }
        if let Some(sigma) = self.median_sigma() {
            words.push(("median σ along the ray", format!("{sigma:.3} mm")));
        }
        words.push(("frame", self.frame().to_owned()));
        words
    }
}
