//! `slcal evaluate`: how far the points of a cloud lie from a plane or a sphere.

use slcal_core::evaluate::FitConfig;

use crate::args::EvaluateArgs;
use crate::exit::{InFile as _, Outcome};
use crate::io::{Destination, check_spares, input_name, load_cloud, png_bytes, write_all};
use crate::output::{Printer, print_json, print_result};
use crate::picture::deviation_map::{DeviationMap, picture};
use crate::summary;
use crate::surface::FittedSurface;

pub(super) fn run(args: &EvaluateArgs, printer: Printer) -> Outcome {
    let overlay = Destination::prepare_overlay(args.overlay.as_ref(), args.force)?;
    check_spares(&overlay, [args.cloud.as_path()])?;
    let name = input_name(&args.cloud);
    let busy = printer.busy(format!("fitting a surface to {name}"));
    let cloud = load_cloud(&args.cloud)?;
    printer.detail(format!("{} points", cloud.points.len()));
    let config = FitConfig::default();
    let fit = FittedSurface::new(args.shape, &cloud, &config).in_file(&args.cloud)?;
    if let Some(place) = overlay {
        let (what, sides) = fit.in_words();
        let distances_mm = &fit.distances_mm(&cloud);
        let map = DeviationMap { name: &name, what, sides, report: fit.report(), distances_mm };
        write_all(&[(place, png_bytes(&picture(&cloud, &map)?)?)])?;
    }
    drop(busy);
    match &fit {
        FittedSurface::Plane(plane) if args.json => print_json(&plane.to_json(&config)),
        FittedSurface::Sphere(sphere) if args.json => print_json(&sphere.to_json(&config)),
        fit => print_result(&summary::surface_fit(fit)),
    }
}
