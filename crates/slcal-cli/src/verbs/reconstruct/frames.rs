//! The frames, their names, and the destinations of their clouds.

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use slcal_core::format::CloudFormat;

use crate::args::ReconstructArgs;
use crate::exit::{Failure, Outcome};
use crate::io::{Destination, RawFormat, RawFrame, cloud_is_complete, input_name, is_dash};

/// A frame to reconstruct.
#[derive(Debug)]
pub(in crate::verbs) struct Frame {
    /// The file; `-` for stdin.
    pub(in crate::verbs) image: PathBuf,
    /// Which frame of a stream.
    pub(in crate::verbs) number: Option<usize>,
    /// The pixels, when they came from a stream.
    pub(in crate::verbs) raw: Option<RawFrame>,
    /// The destination of the cloud, or why there is none.
    pub(in crate::verbs) place: Outcome<Place>,
}

impl Frame {
    /// Its name in messages.
    pub(in crate::verbs) fn name(&self) -> String {
        match self.number {
            Some(n) => stream_name(n),
            None => input_name(&self.image),
        }
    }
}

fn stream_name(number: usize) -> String {
    format!("stdin, frame {number}")
}

/// The destination of a cloud.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::verbs) struct Place {
    /// Its name as given by the command line.
    pub(in crate::verbs) name: String,
    /// `None` when an earlier run has written it.
    pub(in crate::verbs) output: Option<Destination>,
}

/// The naming rules of clouds in a folder.
#[derive(Debug, Clone)]
pub(in crate::verbs) struct OutputFolder {
    path: PathBuf,
    format: CloudFormat,
    force: bool,
    resume: bool,
}

impl OutputFolder {
    /// Of `--out-dir`, when it is given.
    pub(in crate::verbs) fn of(args: &ReconstructArgs) -> Option<Self> {
        let (format, force, resume) = (args.format, args.force, args.resume);
        args.out_dir.as_ref().map(|path| Self { path: path.clone(), format, force, resume })
    }

    /// The file for a cloud; the name keeps its dots.
    fn file(&self, stem: &OsStr) -> PathBuf {
        let mut name = stem.to_owned();
        name.push(".");
        name.push(self.format.name());
        self.path.join(name)
    }

    fn place(&self, stem: &OsStr) -> Outcome<Place> {
        let file = self.file(stem);
        if self.resume && cloud_is_complete(self.format, &file) {
            return Ok(Place { name: file.display().to_string(), output: None });
        }
        // An incomplete cloud is replaced when a run resumes.
        let output = Destination::prepare(&file, self.force || self.resume)?;
        Ok(Place { name: file.display().to_string(), output: Some(output) })
    }

    /// The destinations for photographs, whose names must differ.
    pub(in crate::verbs) fn places(&self, images: &[PathBuf]) -> Outcome<Vec<Place>> {
        let mut seen: HashMap<OsString, &Path> = HashMap::new();
        for image in images {
            if let Some(other) = seen.insert(stem(image), image) {
                return Err(Failure::usage(format!(
                    "{} and {} would both be written to {}; rename one of them, or use separate folders (--out-dir)",
                    input_name(other),
                    input_name(image),
                    self.file(&stem(image)).display()
                )));
            }
        }
        images.iter().map(|image| self.place(&stem(image))).collect()
    }

    /// Refuses a folder with clouds of an earlier stream, unless they may be kept or replaced. This is checked before any frame is
    /// processed, although the number of frames is unknown.
    pub(in crate::verbs) fn check_for_stream(&self) -> Outcome {
        self.place(&stream_stem(0))?;
        if self.force || self.resume {
            return Ok(());
        }
        let is_frame = |name: &OsStr| {
            let name = name.to_string_lossy();
            let number = name.strip_prefix("frame_").and_then(|n| n.strip_suffix(self.format.name()));
            number.and_then(|n| n.strip_suffix('.')).is_some_and(|n| n.parse::<usize>().is_ok())
        };
        let found = fs::read_dir(&self.path).ok().into_iter().flatten().filter_map(Result::ok);
        let mut files: Vec<PathBuf> =
            found.filter(|e| is_frame(&e.file_name())).map(|entry| entry.path()).collect();
        files.sort();
        // The first existing file is refused like any existing output.
        files.first().map_or(Ok(()), |file| Destination::prepare(file, false).map(|_| ()))
    }

    /// The frames of a stream on stdin until its end; a truncated frame ends it with an error, and one that takes longer than
    /// `patience`.
    pub(in crate::verbs) fn frames(
        self,
        format: RawFormat,
        patience: Option<Duration>,
    ) -> impl Iterator<Item = Frame> + Send {
        let mut number = 0;
        let mut over = false;
        let mut read = reader(format, patience);
        std::iter::from_fn(move || {
            if over {
                return None;
            }
            let read = match read(number) {
                Ok(None) if number > 0 => return None,
                Ok(None) => Err(empty_stream(&stream_name(number))),
                Ok(Some(frame)) => Ok(frame),
                Err(failure) => Err(failure),
            };
            over = read.is_err();
            let (raw, place) = match read {
                Ok(raw) => (Some(raw), self.place(&stream_stem(number))),
                Err(failure) => (None, Err(failure)),
            };
            number += 1;
            Some(Frame { image: PathBuf::from("-"), number: Some(number - 1), raw, place })
        })
    }
}

type ReadFrame = Box<dyn FnMut(usize) -> Outcome<Option<RawFrame>> + Send>;

/// What reads the next frame from stdin, given its number.
fn reader(format: RawFormat, patience: Option<Duration>) -> ReadFrame {
    let read = move |number| RawFrame::read(&mut std::io::stdin().lock(), format, &stream_name(number));
    let Some(patience) = patience else { return Box::new(read) };
    // A read cannot be given up. It goes on in a thread that ends with the process.
    let (send, receive) = mpsc::sync_channel(0);
    thread::spawn(move || (0..).map(read).try_for_each(|frame| send.send(frame)));
    Box::new(move |number| receive.recv_timeout(patience).unwrap_or_else(|_| Err(stalled(number, patience))))
}

fn stalled(number: usize, patience: Duration) -> Failure {
    Failure::new(
        crate::exit::Exit::Input,
        format!(
            "{}: expected a frame within {} s (--timeout), found a stream that stalls; check the program that writes it",
            stream_name(number),
            patience.as_secs_f64()
        ),
    )
}

fn empty_stream(name: &str) -> Failure {
    Failure::new(
        crate::exit::Exit::Input,
        format!("{name}: expected a frame, found an empty stream; check the program that writes it"),
    )
}

fn stream_stem(number: usize) -> OsString {
    format!("frame_{number:06}").into()
}

/// The file name of a photograph without its extension.
fn stem(image: &Path) -> OsString {
    if is_dash(image) { "stdin".into() } else { image.file_stem().unwrap_or(image.as_os_str()).to_owned() }
}
