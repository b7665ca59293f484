//! `slcal evaluate`: how far the points of a cloud lie from a plane or a sphere.

use serde::Serialize;
use slcal_core::PointCloud;
use slcal_core::evaluate::{FitConfig, FitReport, fit_plane, fit_sphere};
use slcal_core::format::read_ply;

use crate::args::{EvaluateArgs, ShapeArg};
use crate::exit::{InFile as _, Outcome};
use crate::io::read_bytes;
use crate::output::{Printer, print_json, print_result};
use crate::summary;

pub(super) fn run(args: &EvaluateArgs, printer: Printer) -> Outcome {
    let cloud = read_ply(read_bytes(&args.cloud, "a point cloud as PLY")?.as_slice()).in_file(&args.cloud)?;
    printer.detail(format!("{} points", cloud.points.len()));
    let result = fit(args.shape, &cloud).in_file(&args.cloud)?;
    if args.json {
        print_json(&result)
    } else {
        print_result(&summary::fit(&result.shape.to_string(), &result.report))
    }
}

/// What evaluation reports as JSON.
#[derive(Serialize)]
struct Evaluation {
    schema: &'static str,
    #[serde(flatten)]
    shape: Shape,
    /// Which points count as inliers.
    rule: String,
    #[serde(flatten)]
    report: FitReport,
}

#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Shape {
    /// The points X with normal · X + `offset_mm` = 0.
    Plane {
        normal: [f64; 3],
        offset_mm: f64,
    },
    Sphere {
        centre_mm: [f64; 3],
        radius_mm: f64,
    },
}

impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Plane { normal: [x, y, z], offset_mm } => {
                write!(f, "plane      {x:.5} x + {y:.5} y + {z:.5} z + {offset_mm:.2} mm = 0")
            }
            Self::Sphere { centre_mm: [x, y, z], radius_mm } => {
                write!(f, "sphere     centre {x:.2}, {y:.2}, {z:.2} mm, radius {radius_mm:.2} mm")
            }
        }
    }
}

fn fit(shape: ShapeArg, cloud: &PointCloud) -> slcal_core::Result<Evaluation> {
    let config = FitConfig::default();
    let (shape, report) = match shape {
        ShapeArg::Plane => {
            let fit = fit_plane(cloud, &config)?;
            let normal = fit.plane.normal;
            (
                Shape::Plane { normal: [normal.x, normal.y, normal.z], offset_mm: fit.plane.offset_mm },
                fit.report,
            )
        }
        ShapeArg::Sphere => {
            let fit = fit_sphere(cloud, &config)?;
            (Shape::Sphere { centre_mm: fit.centre.into(), radius_mm: fit.radius_mm }, fit.report)
        }
    };
    let rule = format!(
        "inliers lie within {} times their robust sigma (1.4826 x median distance)",
        config.inlier_sigmas
    );
    Ok(Evaluation { schema: "slcal-evaluate/1", shape, rule, report })
}
