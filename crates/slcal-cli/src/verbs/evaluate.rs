//! `slcal evaluate`: how far the points of a cloud lie from a plane or a sphere.

use slcal_core::evaluate::{FitConfig, fit_plane, fit_sphere};
use slcal_core::format::{read_ply, report_json};

use crate::args::{EvaluateArgs, ShapeArg};
use crate::exit::{InFile as _, Outcome};
use crate::io::{input_name, read_bytes};
use crate::output::{Printer, print_json, print_result};
use crate::summary;

pub(super) fn run(args: &EvaluateArgs, printer: Printer) -> Outcome {
    let busy = printer.busy(format!("fitting a surface to {}", input_name(&args.cloud)));
    let cloud = read_ply(read_bytes(&args.cloud, "a point cloud as PLY")?.as_slice()).in_file(&args.cloud)?;
    printer.detail(format!("{} points", cloud.points.len()));
    let config = FitConfig::default();
    match args.shape {
        ShapeArg::Plane => {
            let fit = fit_plane(&cloud, &config).in_file(&args.cloud)?;
            drop(busy);
            if args.json {
                return print_json(&report_json::plane_evaluation(&fit, &config));
            }
            print_result(&summary::plane_fit(&fit))
        }
        ShapeArg::Sphere => {
            let fit = fit_sphere(&cloud, &config).in_file(&args.cloud)?;
            drop(busy);
            if args.json {
                return print_json(&report_json::sphere_evaluation(&fit, &config));
            }
            print_result(&summary::sphere_fit(&fit))
        }
    }
}
