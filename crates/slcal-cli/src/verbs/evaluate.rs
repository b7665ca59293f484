//! `slcal evaluate`: how far the points of a cloud lie from a plane or a sphere.

use slcal_core::PointCloud;
use slcal_core::evaluate::{FitConfig, PlaneFit, SphereFit, fit_plane, fit_sphere};
use slcal_core::format::read_ply;

use crate::args::{EvaluateArgs, ShapeArg};
use crate::exit::{InFile as _, Outcome};
use crate::io::{Destination, check_spares, input_name, png_bytes, read_bytes, write_all};
use crate::output::{Printer, print_json, print_result};
use crate::picture::deviation_map::{DeviationMap, picture};
use crate::summary;

pub(super) fn run(args: &EvaluateArgs, printer: Printer) -> Outcome {
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    check_spares(&overlay, [args.cloud.as_path()])?;
    let busy = printer.busy(format!("fitting a surface to {}", input_name(&args.cloud)));
    let cloud = read_ply(read_bytes(&args.cloud, "a point cloud as PLY")?.as_slice()).in_file(&args.cloud)?;
    printer.detail(format!("{} points", cloud.points.len()));
    let config = FitConfig::default();
    match args.shape {
        ShapeArg::Plane => {
            let fit = fit_plane(&cloud, &config).in_file(&args.cloud)?;
            if let Some(place) = overlay {
                write_all(&[(place, draw_plane(args, &cloud, &fit)?)])?;
            }
            drop(busy);
            if args.json {
                return print_json(&fit.to_json(&config));
            }
            print_result(&summary::plane_fit(&fit))
        }
        ShapeArg::Sphere => {
            let fit = fit_sphere(&cloud, &config).in_file(&args.cloud)?;
            if let Some(place) = overlay {
                write_all(&[(place, draw_sphere(args, &cloud, &fit)?)])?;
            }
            drop(busy);
            if args.json {
                return print_json(&fit.to_json(&config));
            }
            print_result(&summary::sphere_fit(&fit))
        }
    }
}

fn draw_plane(args: &EvaluateArgs, cloud: &PointCloud, fit: &PlaneFit) -> Outcome<Vec<u8>> {
    // The normal points to the camera: points nearer to it are positive.
    let distances: Vec<f64> =
        cloud.points.iter().map(|p| fit.plane.signed_distance_mm(&p.position)).collect();
    let map = DeviationMap {
        name: &input_name(&args.cloud),
        what: "plane",
        sides: ["behind it", "before it"],
        report: &fit.report,
        distances_mm: &distances,
    };
    png_bytes(&picture(cloud, &map)?)
}

fn draw_sphere(args: &EvaluateArgs, cloud: &PointCloud, fit: &SphereFit) -> Outcome<Vec<u8>> {
    let distance = |p: &nalgebra::Point3<f64>| (p - fit.centre).norm() - fit.radius_mm;
    let distances: Vec<f64> = cloud.points.iter().map(|p| distance(&p.position)).collect();
    let map = DeviationMap {
        name: &input_name(&args.cloud),
        what: "sphere",
        sides: ["inside", "outside"],
        report: &fit.report,
        distances_mm: &distances,
    };
    png_bytes(&picture(cloud, &map)?)
}
