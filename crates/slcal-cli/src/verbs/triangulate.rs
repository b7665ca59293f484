//! `slcal triangulate`: from the matches of any decoder to a cloud.

use std::path::Path;

use slcal_core::format::{read_dense_matches, read_matches};
use slcal_core::{cloud_from_dense_matches, cloud_from_matches};

use super::reconstruct::cloud_config;
use crate::args::TriangulateArgs;
use crate::exit::{InFile as _, Outcome};
use crate::io::{
    Destination, InputKind, bytes_of, check_projector, check_spares, cloud_format_of, input_name, load_rig,
    open_stream, read_bytes, write_all,
};
use crate::output::Printer;
use crate::summary;

pub(super) fn run(args: &TriangulateArgs, printer: Printer) -> Outcome {
    let format = cloud_format_of(&args.output)?;
    let output = Destination::prepare(&args.output, args.force)?;
    check_spares([&output], [args.rig.as_path(), &args.matches])?;
    let rig = load_rig(&args.rig)?;
    check_projector(&args.rig, &rig)?;
    let busy = printer.busy(format!("triangulating {}", input_name(&args.matches)));
    let config = cloud_config(&args.shape, args.cull, &rig, &args.rig)?;
    let result = if is_npz(&args.matches) {
        let file = read_bytes(&args.matches, InputKind::Matches)?;
        let matches = read_dense_matches(&file).in_file(&args.matches)?;
        drop(file);
        cloud_from_dense_matches(&rig, &matches, &config)
    } else {
        let matches = read_matches(open_stream(&args.matches, InputKind::Matches)?).in_file(&args.matches)?;
        cloud_from_matches(&rig, &matches, &config)
    };
    let result = result.in_file(&args.matches)?;
    write_all(&[(output.clone(), bytes_of(|out| format.write(&result.cloud, out))?)])?;
    drop(busy);
    printer.summary(&summary::cloud(&result), output == Destination::Stdout)
}

/// Whether matches are arrays of NumPy, by the name of their file.
fn is_npz(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"))
}
