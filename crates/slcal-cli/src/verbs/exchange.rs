//! `slcal export` and `slcal import`: rigs as files of other programs, and back.

use std::path::{Path, PathBuf};

use serde::Serialize;
use slcal_core::format::{
    ExchangeFormat, Export, ExportConfig, ImportConfig, NamedBytes, StorageText, export_rig, import_rig,
    write_rig,
};
use slcal_core::{Error, ErrorSubject};

use crate::args::{ExportArgs, ImportArgs};
use crate::exit::{Failure, InFile as _, Outcome};
use crate::io::{
    Destination, bytes_of, check_distinct, check_json, check_spares, export_places, import_paths, input_name,
    load_rig, make_folder, read_exchange, storage_of, write_all,
};
use crate::output::{Printer, TextLayout, print_json, print_result, sanitized};

#[derive(Serialize)]
struct ExportReport {
    schema: &'static str,
    format: ExchangeFormat,
    files: Vec<String>,
    convention: &'static str,
    left_out: Vec<String>,
}

#[derive(Serialize)]
struct ImportReport {
    schema: &'static str,
    format: ExchangeFormat,
    file: String,
    projector: bool,
    views: usize,
    notes: Vec<String>,
}

pub(super) fn export(args: &ExportArgs, printer: Printer) -> Outcome {
    let storage = match args.to {
        ExchangeFormat::OpenCv => storage_of(&args.output)?,
        _ => StorageText::default(),
    };
    let rig = load_rig(&args.rig)?;
    let Export { files, left_out, .. } =
        export_rig(&rig, args.to, &ExportConfig { storage, lossy: args.lossy }).in_file(&args.rig)?;
    let names: Vec<&str> = files.iter().map(|f| f.name).collect();
    let places = export_places(&args.output, args.to, &names)?;
    if let Some(folder) = &places.folder {
        make_folder(folder)?;
    }
    let outputs =
        places.paths.iter().map(|p| Destination::prepare(p, args.force)).collect::<Outcome<Vec<_>>>()?;
    check_distinct(&outputs)?;
    outputs.iter().try_for_each(|o| check_json(args.json, o))?;
    check_spares(&outputs, [args.rig.as_path()])?;
    let report = ExportReport {
        schema: "slcal-export/1",
        format: args.to,
        files: outputs.iter().map(Destination::name).collect(),
        convention: args.to.convention(),
        left_out,
    };
    let to_stdout = outputs.contains(&Destination::Stdout);
    write_all(&outputs.into_iter().zip(files.into_iter().map(|f| f.bytes)).collect::<Vec<_>>())?;
    for note in &report.left_out {
        printer.note(note);
    }
    if to_stdout {
        return Ok(());
    }
    if args.json {
        return print_json(&report);
    }
    let mut layout = TextLayout::new();
    for file in &report.files {
        layout.line("wrote", sanitized(file));
    }
    layout.line("convention", report.convention);
    print_result(&layout.into_text())
}

pub(super) fn import(args: &ImportArgs, printer: Printer) -> Outcome {
    let output = Destination::prepare(&args.output, args.force)?;
    check_json(args.json, &output)?;
    let paths = import_paths(&args.files)?;
    check_spares([&output], paths.iter().map(PathBuf::as_path))?;
    let contents = paths.iter().map(|p| read_exchange(p)).collect::<Outcome<Vec<_>>>()?;
    let names: Vec<String> = paths.iter().map(|p| file_name(p)).collect();
    let files: Vec<NamedBytes<'_>> =
        names.iter().zip(&contents).map(|(name, bytes)| NamedBytes { name, bytes }).collect();
    let config = ImportConfig { camera_size: args.camera_size, projector_size: args.projector_size };
    let first = paths.first().map_or(Path::new("-"), PathBuf::as_path);
    let found = import_rig(args.from, &files, &config)
        .map_err(|e| Failure::in_file(first, &e).and(option_for(&e)))?;
    let bytes = bytes_of(|out| write_rig(&found.rig, out))?;
    let report = ImportReport {
        schema: "slcal-import/1",
        format: found.format,
        file: output.name(),
        projector: found.rig.projector.is_some(),
        views: found.rig.views.len(),
        notes: found.notes,
    };
    let to_stdout = output == Destination::Stdout;
    write_all(&[(output, bytes)])?;
    for note in &report.notes {
        printer.note(format!("{}: {note}", input_name(first)));
    }
    if to_stdout {
        return Ok(());
    }
    if args.json {
        return print_json(&report);
    }
    let devices = if report.projector { "camera and projector" } else { "a camera alone" };
    let views = match report.views {
        0 => String::new(),
        1 => ", 1 view".to_owned(),
        n => format!(", {n} views"),
    };
    let format = report.format.name();
    let mut layout = TextLayout::new();
    layout.line("wrote", sanitized(&report.file));
    layout.line("read", format!("{devices}{views} from {format}"));
    print_result(&layout.into_text())
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The option that provides a missing value.
fn option_for(error: &Error) -> &'static str {
    match error {
        Error::Invalid { what: ErrorSubject::CameraImageSize, found, .. } if found == "none" => {
            " (--camera-size WxH)"
        }
        Error::Invalid { what: ErrorSubject::ProjectorImageSize, found, .. } if found == "none" => {
            " (--projector-size WxH)"
        }
        Error::Malformed { what: ErrorSubject::ImportFile, .. } => " (--from)",
        _ => "",
    }
}
