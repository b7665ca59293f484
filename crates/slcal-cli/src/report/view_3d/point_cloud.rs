//! The cloud, thinned so that a browser rotates it smoothly, with a choice of colours.

use std::collections::HashMap;
use std::fmt::Write as _;

use nalgebra::Point3;
use serde_json::{Value, json};
use slcal_core::geometry::Pose;
use slcal_core::{PointCloud, Rig};

use super::super::figure::{Choice, packed, packed_colours, packed_indices};
use crate::quantile::Sorted;

/// More points than this are thinned: enough for a shape, and a report that opens at once and stays small.
const MAX_SHOWN: usize = 20_000;

/// Points as they are shown.
pub(super) struct ShownPoints {
    positions: Vec<Point3<f64>>,
    colours: Vec<[u8; 3]>,
    sigma_mm: Vec<f64>,
    noise_mm: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    total: usize,
    total_triangles: usize,
}

impl ShownPoints {
    /// The points that are shown: one per cell of the camera's image, so that every part of the surface keeps its share.
    pub(super) fn new(rig: &Rig, cloud: &PointCloud) -> Self {
        let camera_from_cloud = camera_from_cloud(rig, cloud.frame);
        let positions: Vec<Point3<f64>> =
            cloud.points.iter().map(|p| camera_from_cloud.transform(&p.position)).collect();
        let pixels: Vec<Option<[f64; 2]>> = positions
            .iter()
            .map(|p| {
                rig.camera.model.project(p).map(|u| [u.x, u.y]).filter(|u| u.iter().all(|x| x.is_finite()))
            })
            .collect();
        let mut cell = 0.0;
        let (mut kept, mut place) = every(&positions);
        let area = f64::from(rig.camera.model.width) * f64::from(rig.camera.model.height);
        while kept.len() > MAX_SHOWN {
            cell = if cell == 0.0 {
                (area / cloud.points.len().max(1) as f64).sqrt() * 0.25
            } else {
                cell * 1.12
            };
            (kept, place) = one_per_cell(&positions, &pixels, cell);
        }
        let triangles = thinned(&cloud.triangles, &place);
        let of = |f: fn(&slcal_core::CloudPoint) -> f64| kept.iter().map(|&i| f(&cloud.points[i])).collect();
        Self {
            positions: kept.iter().map(|&i| positions[i]).collect(),
            colours: kept.iter().map(|&i| cloud.points[i].color).collect(),
            sigma_mm: of(|p| p.sigma_mm),
            noise_mm: of(|p| p.noise_mm),
            triangles,
            total: cloud.points.len(),
            total_triangles: cloud.triangles.len(),
        }
    }

    /// Half of the points are nearer than this.
    pub(super) fn median_depth_mm(&self) -> Option<f64> {
        Sorted::new(self.positions.iter().map(|p| p.z)).at(0.5)
    }

    /// Adds the cloud to a plot; gives the choices of its colour.
    pub(super) fn add_to(&self, traces: &mut Vec<Value>) -> Vec<Choice> {
        if self.positions.is_empty() {
            return Vec::new();
        }
        let axis = |k: usize| packed(&self.positions.iter().map(|p| plotted(p)[k]).collect::<Vec<_>>());
        let points = traces.len();
        let colours = self.colours();
        let mut trace = json!({
            "type": "scatter3d", "mode": "markers", "name": "points", "x": axis(0), "y": axis(1), "z": axis(2),
            "marker": {
                // Squares have two triangles, circles dozens.
                "symbol": "square", "size": 2, "line": { "width": 0 }, "opacity": 1,
                "colorbar": { "thickness": 12, "len": 0.6, "outlinewidth": 0, "tickcolor": "$line" },
            },
            "hovertemplate": "%{x:.1f} right, %{y:.1f} deep, %{z:.1f} up<extra></extra>",
        });
        // As the first choice, which is pressed, shows them.
        for (path, value) in colours.first().and_then(|(_, change)| change.as_object()).into_iter().flatten()
        {
            *path.split('.').fold(&mut trace, |at, key| &mut at[key]) = value.clone();
        }
        traces.push(trace);
        let choice = |(label, change): &(&'static str, Value)| Choice {
            label,
            traces: vec![points],
            change: change.clone(),
        };
        let mut choices: Vec<Choice> = colours.iter().map(choice).collect();
        if !self.triangles.is_empty() {
            traces.push(self.surface());
            for choice in &mut choices {
                choice.traces.push(points + 1);
                choice.change["visible"] = json!([true, false]);
            }
            choices.push(Choice {
                label: "surface",
                traces: vec![points, points + 1],
                change: json!({ "visible": [false, true] }),
            });
        }
        if choices.len() > 1 { choices } else { Vec::new() }
    }

    fn surface(&self) -> Value {
        let axis = |k: usize| packed(&self.positions.iter().map(|p| plotted(p)[k]).collect::<Vec<_>>());
        let corner = |k: usize| packed_indices(&self.triangles.iter().map(|t| t[k]).collect::<Vec<_>>());
        json!({
            "type": "mesh3d", "name": "surface", "visible": false, "x": axis(0), "y": axis(1), "z": axis(2),
            "i": corner(0), "j": corner(1), "k": corner(2), "color": "$surface", "flatshading": false,
            "lighting": { "ambient": 0.35, "diffuse": 0.8, "specular": 0.08, "roughness": 0.7, "fresnel": 0.05 },
            "lightposition": { "x": -1e4, "y": -2e4, "z": 2e4 }, "hoverinfo": "skip", "showlegend": false,
        })
    }

    /// By what the points may be coloured: name and what plotly is to change.
    fn colours(&self) -> Vec<(&'static str, Value)> {
        let by_value = |title: &str, values: Value, range: [f64; 2]| {
            json!({
                "marker.color": values, "marker.colorscale": "Viridis", "marker.showscale": true, "marker.cmin": range[0],
                "marker.cmax": range[1], "marker.colorbar.title.text": title,
            })
        };
        let mut all = Vec::new();
        if self.colours.iter().any(|c| *c != self.colours[0]) {
            let colours = packed_colours(self.colours.iter().copied());
            all.push(("photograph", json!({ "marker.color": colours, "marker.showscale": false })));
        }
        let depth: Vec<f64> = self.positions.iter().map(|p| p.z).collect();
        all.push(("depth", by_value("depth, mm", packed(&depth), bulk(&depth))));
        for (label, title, values) in [("σ", "σ, mm", &self.sigma_mm), ("noise", "noise, mm", &self.noise_mm)]
        {
            if values.iter().any(|x| x.is_finite() && *x > 0.0) {
                all.push((label, by_value(title, packed(values), bulk(values))));
            }
        }
        all
    }

    /// How much of the cloud is shown.
    pub(super) fn note(&self, name: &str) -> String {
        let mut note = if self.positions.len() < self.total {
            format!(
                "{} of the {} points of {name} are shown, spread evenly over the image",
                self.positions.len(),
                self.total
            )
        } else {
            format!("All {} points of {name} are shown", self.total)
        };
        if self.total_triangles > self.triangles.len() {
            let _ = write!(
                note,
                "; the surface has {} of {} triangles",
                self.triangles.len(),
                self.total_triangles
            );
        }
        note + ". σ is the expected error along the line of sight, most of it common to all points; noise is the part that differs \
                from point to point."
    }
}

/// The axes of the plot: right, forward, up; a camera's are right, down, forward.
pub(super) fn plotted(p: &Point3<f64>) -> [f64; 3] {
    [p.x, p.z, -p.y]
}

/// Where the cloud's points are in the camera's frame.
fn camera_from_cloud(rig: &Rig, frame: slcal_core::Frame) -> Pose {
    match (frame, rig.views.first()) {
        (slcal_core::Frame::Plane, Some(view)) => view.camera_from_sheet,
        _ => Pose::identity(),
    }
}

/// All points that are somewhere.
fn every(positions: &[Point3<f64>]) -> (Vec<usize>, Vec<Option<u32>>) {
    let (mut kept, mut place) = (Vec::new(), vec![None; positions.len()]);
    for (i, p) in positions.iter().enumerate() {
        if p.iter().all(|x| x.is_finite()) {
            place[i] = Some(kept.len() as u32);
            kept.push(i);
        }
    }
    (kept, place)
}

/// One point per cell of the image, and which one stands for each point. Points of one cell but of other depths stay apart,
/// so that outlines stay sharp.
fn one_per_cell(
    positions: &[Point3<f64>],
    pixels: &[Option<[f64; 2]>],
    cell: f64,
) -> (Vec<usize>, Vec<Option<u32>>) {
    /// Depths that differ by more than this share are of different surfaces.
    const DEPTH_STEP: f64 = 0.05;
    let (mut kept, mut place) = (Vec::new(), vec![None; positions.len()]);
    let mut of_cell: HashMap<[i64; 3], u32> = HashMap::new();
    for (i, pixel) in pixels.iter().enumerate() {
        let Some([u, v]) = pixel else { continue };
        let layer = (positions[i].z.ln() / DEPTH_STEP).floor() as i64;
        let key = [(u / cell).floor() as i64, (v / cell).floor() as i64, layer];
        let at = *of_cell.entry(key).or_insert_with(|| {
            kept.push(i);
            (kept.len() - 1) as u32
        });
        place[i] = Some(at);
    }
    (kept, place)
}

/// The triangles between the points that stand for their corners.
fn thinned(triangles: &[[u32; 3]], place: &[Option<u32>]) -> Vec<[u32; 3]> {
    let mut seen = std::collections::HashSet::new();
    let mut kept = Vec::new();
    for t in triangles {
        let corner = |k: usize| place.get(t[k] as usize).copied().flatten();
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        if a == b || b == c || c == a {
            continue;
        }
        let mut key = [a, b, c];
        key.sort_unstable();
        if seen.insert(key) {
            kept.push([a, b, c]);
        }
    }
    kept
}

/// The range of colours: nearly all values, so that a few far ones do not make the rest alike.
fn bulk(values: &[f64]) -> [f64; 2] {
    Sorted::new(values.iter().copied()).range([0.02, 0.98])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_begin_as_the_choice_that_is_pressed() {
        let at = |z: f64| Point3::new(0.0, 0.0, z);
        let one_colour = ShownPoints {
            positions: vec![at(900.0), at(1100.0)],
            colours: vec![[7; 3]; 2],
            sigma_mm: vec![f64::NAN; 2],
            noise_mm: vec![f64::NAN; 2],
            triangles: Vec::new(),
            total: 2,
            total_triangles: 0,
        };
        let mut traces = Vec::new();
        one_colour.add_to(&mut traces);
        let marker = &traces[0]["marker"];
        assert_eq!(
            (&marker["showscale"], &marker["colorbar"]["title"]["text"]),
            (&json!(true), &json!("depth, mm"))
        );
        assert_eq!(marker["colorbar"]["thickness"], 12);
    }

    #[test]
    fn thinning_keeps_one_point_per_cell_and_depth() {
        let at = |x: f64, z: f64| Point3::new(x, 0.0, z);
        let positions = [at(0.0, 1000.0), at(1.0, 1001.0), at(0.5, 3000.0), at(90.0, 1000.0)];
        let pixels = [Some([0.1, 0.0]), Some([0.2, 0.0]), Some([0.15, 0.0]), Some([9.0, 0.0])];
        let (kept, place) = one_per_cell(&positions, &pixels, 1.0);
        assert_eq!(kept, [0, 2, 3]);
        assert_eq!(place, [Some(0), Some(0), Some(1), Some(2)]);
        // The first triangle has two corners in one cell; the last says the same as the second.
        assert_eq!(thinned(&[[0, 1, 3], [0, 2, 3], [1, 3, 2]], &place), [[0, 1, 2]]);
    }
}
