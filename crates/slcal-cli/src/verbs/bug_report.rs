//! `slcal bug-report`: what somebody else needs to find out why a result is wrong, in one archive.

use std::collections::HashSet;
use std::env::consts::{ARCH, OS};
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

use slcal_core::format::recognise;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::args::BugReportArgs;
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{
    Destination, InputKind, Samples, check_spares, files_of, is_named_photo, jpeg_bytes, load_photo,
    read_bytes, write_all,
};
use crate::name::{STUDIO_COMMANDS, has_extension};
use crate::output::{Printer, Table, TextLayout, sanitized};

/// The file that says what the others are.
const ABOUT: &str = "about.txt";
/// Schemas of what is packed. Other files of slcal, such as the studio's settings, tell more of their owner than of the result.
const DESCRIPTIONS: [&str; 3] = ["slcal-rig/", "slcal-observations/", "slcal-pattern/"];
/// More photographs than this are a recording; the first ones show what is wrong.
const MOST_PHOTOGRAPHS: usize = 60;
/// Quality of thumbnails, of 100.
const THUMBNAIL_QUALITY: u8 = 85;

/// A file of the archive.
struct Packed {
    name: String,
    what: String,
    bytes: Vec<u8>,
}

/// A file of the folder that is not in the archive, and why.
struct LeftOut {
    name: String,
    why: String,
}

pub(super) fn run(args: &BugReportArgs, printer: Printer) -> Outcome {
    let output = (!args.dry_run).then(|| Destination::prepare(&args.output, args.force)).transpose()?;
    let files = files_of(&args.folder)?;
    check_spares(&output, files.iter().filter(|f| is_json(f) || is_named_photo(f)).map(PathBuf::as_path))?;
    let busy = printer.busy("reading the folder");
    let (mut packed, left_out) = collect(args, &files, printer);
    drop(busy);
    if packed.is_empty() {
        return Err(Failure::input(
            &args.folder,
            "expected a folder with a rig, observations, descriptions of patterns or photographs; found none of them. \
             Give the folder in which you calibrated",
        ));
    }
    packed.insert(0, about(args, &packed, &left_out));
    if let Some(output) = &output {
        write_all(&[(output.clone(), archive(&packed)?)])?;
    }
    printer.summary(&shown(&packed, &left_out, output.as_ref()), output == Some(Destination::Stdout))
}

fn is_json(path: &Path) -> bool {
    has_extension(path, &["json"])
}

/// What of the files is packed, and what is not.
fn collect(args: &BugReportArgs, files: &[PathBuf], printer: Printer) -> (Vec<Packed>, Vec<LeftOut>) {
    let (mut packed, mut left_out): (Vec<Packed>, Vec<LeftOut>) = (Vec::new(), Vec::new());
    let (mut names, mut photographs) = (HashSet::new(), 0);
    for file in files {
        let name = sanitized(&file.file_name().unwrap_or_default().to_string_lossy());
        let found = if is_named_photo(file) {
            photographs += 1;
            match (args.thumbnail, photographs <= MOST_PHOTOGRAPHS) {
                (0, _) => Err("no thumbnails were asked for".to_owned()),
                (_, false) => Err(format!("beyond the first {MOST_PHOTOGRAPHS} photographs")),
                (most, true) => thumbnail(file, &name, most, printer),
            }
        } else if is_json(file) {
            description(file, &name)
        } else if name == STUDIO_COMMANDS {
            commands(file, &name)
        } else {
            Err("not needed".to_owned())
        };
        match found {
            Ok(file) if names.insert(file.name.clone()) => packed.push(file),
            Ok(_) => left_out.push(LeftOut { name, why: "another file has the same name".to_owned() }),
            Err(why) => left_out.push(LeftOut { name, why: sanitized(&why) }),
        }
    }
    (packed, left_out)
}

/// A rig, observations or the description of a pattern, byte for byte: also one that cannot be read, which may be what is wrong.
fn description(file: &Path, name: &str) -> Result<Packed, String> {
    let bytes = read_bytes(file, InputKind::Rig).map_err(|failure| failure.to_string())?;
    match recognise(&bytes).filter(|kind| DESCRIPTIONS.iter().any(|schema| kind.contains(schema))) {
        Some(what) => Ok(Packed { name: name.to_owned(), what, bytes }),
        None => Err("no rig, observations or pattern".to_owned()),
    }
}

/// What the studio notes down of its commands.
fn commands(file: &Path, name: &str) -> Result<Packed, String> {
    let bytes = read_bytes(file, InputKind::Own).map_err(|failure| failure.to_string())?;
    Ok(Packed { name: name.to_owned(), what: "commands of the studio".to_owned(), bytes })
}

/// A small copy of a photograph, without the tags of its file.
fn thumbnail(file: &Path, name: &str, most: u32, printer: Printer) -> Result<Packed, String> {
    let photo = load_photo(file, Samples::AsFileSays, printer).map_err(|failure| failure.to_string())?;
    let (width, height) = (photo.width(), photo.height());
    let small = if width.max(height) > most { photo.thumbnail(most, most) } else { photo };
    let bytes = jpeg_bytes(&small.to_rgb8(), THUMBNAIL_QUALITY).map_err(|failure| failure.to_string())?;
    let what = format!("{}x{} px, of a photograph of {width}x{height}", small.width(), small.height());
    Ok(Packed { name: format!("thumbnails/{name}.jpg"), what, bytes })
}

/// Version, system, commands, and a list of the rest.
fn about(args: &BugReportArgs, packed: &[Packed], left_out: &[LeftOut]) -> Packed {
    let mut text = format!(
        "slcal {}\n{OS} {ARCH}, {} the studio\n",
        env!("CARGO_PKG_VERSION"),
        if cfg!(feature = "studio") { "with" } else { "without" }
    );
    let commands = args.command.iter().map(|command| sanitized(command));
    let of_packed = packed.iter().map(|p| format!("{}: {}, {} bytes", p.name, p.what, p.bytes.len()));
    let of_left_out = left_out.iter().map(|l| format!("{}: {}", l.name, l.why));
    let lists: [(&str, Vec<String>); 3] = [
        (
            "commands",
            if args.command.is_empty() { vec!["not stated".to_owned()] } else { commands.collect() },
        ),
        ("packed", of_packed.collect()),
        ("left out", of_left_out.collect()),
    ];
    let lists = lists.iter().filter(|(_, lines)| !lines.is_empty());
    text.extend(lists.map(|(head, lines)| format!("\n{head}\n    {}\n", lines.join("\n    "))));
    Packed {
        name: ABOUT.to_owned(),
        what: "version, system, commands, this list".to_owned(),
        bytes: text.into_bytes(),
    }
}

fn archive(packed: &[Packed]) -> Outcome<Vec<u8>> {
    let failed =
        |e: &dyn std::fmt::Display| Failure::new(Exit::Other, format!("cannot pack the archive: {e}"));
    // Without the time of packing: the same folder gives the same archive.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for file in packed {
        zip.start_file(file.name.as_str(), options).map_err(|e| failed(&e))?;
        zip.write_all(&file.bytes).map_err(|e| failed(&e))?;
    }
    Ok(zip.finish().map_err(|e| failed(&e))?.into_inner())
}

fn shown(packed: &[Packed], left_out: &[LeftOut], output: Option<&Destination>) -> String {
    let mut layout = TextLayout::new();
    let head = if output.is_some() { "packed" } else { "would be packed" };
    let mut table = Table::new([head, ">kB", "what it is"]);
    for file in packed {
        let kilobytes = format!("{:.1}", file.bytes.len() as f64 / 1e3);
        table.row([file.name.clone(), kilobytes, file.what.clone()]);
    }
    layout.table(&table);
    for (i, LeftOut { name, why }) in left_out.iter().enumerate() {
        layout.line(if i == 0 { "left out" } else { "" }, format!("{name}: {why}"));
    }
    layout.gap();
    layout.paragraph(
        "Look at it before you share it: thumbnails show what the photographs show, and rigs name the photographs. What cameras write \
         into the files of photographs, such as place and time, is not in it.",
    );
    layout.into_text()
}
