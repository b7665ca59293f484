//! Starts the studio: folder, port, worker, server.

use std::fmt::Write as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::browser;
use super::job::Done;
use super::machine::{FRAME_NOT_SHOWN, Machine, Options};
use super::project::{Project, Purpose, Settings};
use super::queue::{Next, Queue};
use super::server::access::Access;
use super::server::hub::Hub;
use super::server::links::Links;
use super::server::serve;
use super::state::{CameraKind, Problem};
use super::watch_folder::WatchFolder;
use super::worker::{Pictures, Worker};
use crate::args::StudioArgs;
use crate::exit::{Exit, Failure, Outcome};
use crate::io::{
    Foreign, InputKind, decode_photo, end_normally_on_signals, extension_of, input_name, read_bytes,
};
use crate::output::{Printer, print_json, print_result, sanitized};

/// The usual port, and how many after it are tried.
const PORT: u16 = 8642;
const PORTS: u16 = 50;
/// The folder of `--watch` is looked at this often.
const WATCH_EVERY: Duration = Duration::from_millis(300);
/// What the demonstration starts with.
const DEMO_PROJECTOR: [u32; 2] = [1024, 768];
const DEMO_SIZE: &str = "594x420mm";

pub(crate) fn run(args: &StudioArgs, printer: Printer) -> Outcome {
    let failed =
        |e: &dyn std::fmt::Display| Failure::new(Exit::Other, format!("cannot start the server: {e}"));
    let (project, settings) = Project::open(&args.folder())?;
    check_photographs(&project, &settings, args)?;
    let settings = started(settings, args);
    let watched = args.watch.as_deref().map(|folder| watch(folder, &project)).transpose()?;
    let listener = listen(args)?;
    let at = listener.local_addr().map_err(|e| failed(&e))?;
    let lan = args.lan.then(local_address).flatten();
    let access = Access::new(at, lan.as_slice()).map_err(|e| failed(&e))?;
    let here = format!("127.0.0.1:{}", at.port());
    let there = lan.map(|ip| SocketAddr::new(ip, at.port()).to_string());
    let links = Links::new(&access, &here, there.as_deref());

    let project = Arc::new(project);
    let (pictures, queue) = (Arc::new(Pictures::default()), Arc::new(Queue::default()));
    let options = Options {
        demo: args.demo,
        lan: args.lan,
        watch: args.watch.as_ref().map(|p| p.display().to_string()),
    };
    let machine = Machine::new(&settings, options);
    let hub = Hub::new(machine, access, links.clone(), project.clone(), pictures.clone(), queue.clone());
    end_normally_on_signals();
    start_worker(Worker::new(project.clone(), pictures, args.demo), queue, hub.clone());
    if let Some(watched) = watched {
        start_watching(watched, project.clone(), hub.clone(), printer);
    }
    announce(args, &links)?;
    let opened = match (args.no_open, args.display_only) {
        (true, _) => Ok(()),
        (_, true) => browser::open_kiosk(project.folder(), &links.display),
        (_, false) => browser::open(project.folder(), &links.operator),
    };
    if let Err(e) = opened {
        printer.note(format!("no browser could be opened ({e}); open the address yourself"));
    }
    serve(&hub, listener).map_err(|e| failed(&e))
}

/// Photographs belong to the rig and the pattern under which they were taken.
fn check_photographs(project: &Project, kept: &Settings, args: &StudioArgs) -> Outcome {
    if project.photos(Purpose::Sheet).is_empty() {
        return Ok(());
    }
    let refused = |found: String| {
        let folder = project.folder().display();
        Failure::usage(format!(
            "{folder}: expected photographs of this rig, found {found}; use another --dir"
        ))
    };
    match (kept.demo, args.demo) {
        (true, false) => return Err(refused("those of the demonstration".into())),
        (false, true) => return Err(refused("those of a real one".into())),
        _ => {}
    }
    match (kept.projector, args.projector) {
        (Some([w, h]), Some(new)) if [w, h] != new => {
            Err(refused(format!("those of a projector with {w}x{h} pixels")))
        }
        _ => Ok(()),
    }
}

/// What the folder keeps, and what the command line says instead.
fn started(kept: Settings, args: &StudioArgs) -> Settings {
    let mut settings = kept;
    settings.projector = args.projector.or(settings.projector);
    settings.size = args.size.map(|s| s.to_string()).or(settings.size);
    if args.watch.is_some() {
        settings.camera = Some(CameraKind::Folder);
    }
    if args.demo {
        settings.projector.get_or_insert(DEMO_PROJECTOR);
        settings.size.get_or_insert_with(|| DEMO_SIZE.to_owned());
    }
    settings
}

fn listen(args: &StudioArgs) -> Outcome<TcpListener> {
    let ip = if args.lan { Ipv4Addr::UNSPECIFIED } else { Ipv4Addr::LOCALHOST };
    let bind = |port| TcpListener::bind((ip, port));
    if let Some(port) = args.port {
        return bind(port).map_err(|e| {
            Failure::new(
                Exit::Other,
                format!("--port {port}: expected a free port, but {e}; leave --port out"),
            )
        });
    }
    (PORT..PORT + PORTS).find_map(|port| bind(port).ok()).ok_or_else(|| {
        let last = PORT + PORTS - 1;
        Failure::new(
            Exit::Other,
            format!("expected a free port from {PORT} to {last}, found none; use --port"),
        )
    })
}

/// This machine's address in the network. Nothing is sent: a socket is only asked which way it would go.
fn local_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    // An address that is reserved for documentation.
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    socket.local_addr().ok().map(|at| at.ip()).filter(|ip| !ip.is_unspecified() && !ip.is_loopback())
}

fn start_worker(mut worker: Worker, queue: Arc<Queue>, hub: Arc<Hub>) {
    thread::spawn(move || {
        loop {
            match queue.next() {
                Next::Job(job) => {
                    let work = AssertUnwindSafe(|| worker.work(job, &mut |done| hub.done(done)));
                    if catch_unwind(work).is_err() {
                        hub.done(Done::Failed(failed_inside()));
                    }
                }
                Next::Live(frame) => {
                    if let Ok(Some(done)) = catch_unwind(AssertUnwindSafe(|| worker.look(&frame))) {
                        hub.done(done);
                    }
                }
            }
        }
    });
}

/// A fault of slcal itself: the studio goes on.
fn failed_inside() -> Problem {
    Problem::new(
        "fault",
        "slcal failed at this; it is a fault of slcal",
        "report it, with the project's folder",
    )
}

fn watch(folder: &Path, project: &Project) -> Outcome<WatchFolder> {
    let same = folder.canonicalize().is_ok_and(|f| project.folder().canonicalize().is_ok_and(|p| p == f));
    if same {
        let message =
            "--watch: expected another folder than that of --dir, which gets copies of its photographs";
        return Err(Failure::usage(message));
    }
    WatchFolder::new(folder).map_err(|e| {
        let message = format!("--watch {}: expected a folder that can be read: {e}", folder.display());
        Failure::new(Exit::Input, message)
    })
}

/// Takes photographs out of the watched folder as they are completed.
fn start_watching(mut watched: WatchFolder, project: Arc<Project>, hub: Arc<Hub>, printer: Printer) {
    thread::spawn(move || {
        // Photographs that came in a step that takes none wait for the next one that does.
        let mut waiting = Vec::new();
        loop {
            thread::sleep(WATCH_EVERY);
            waiting.extend(watched.new_files(Instant::now()));
            // One by one: of a sequence, each shows another picture.
            while let Some(path) = waiting.first().cloned() {
                let purpose = match hub.purpose(None) {
                    Ok(purpose) => purpose,
                    // It shows the picture before, once more.
                    Err(problem) if problem.code == FRAME_NOT_SHOWN => {
                        waiting.remove(0);
                        hub.trouble(problem);
                        continue;
                    }
                    Err(_) => break,
                };
                waiting.remove(0);
                if let Err(failure) = take(&path, purpose, &project, &hub) {
                    printer.note(failure.to_string());
                    hub.trouble(Problem::new(
                        "photograph-not-taken",
                        failure.to_string(),
                        "take it again, or drop the file here",
                    ));
                }
            }
        }
    });
}

fn take(path: &Path, purpose: Purpose, project: &Project, hub: &Hub) -> Outcome {
    let bytes = read_bytes(path, InputKind::Photo)?;
    let name = input_name(path);
    let extension = extension_of(&bytes);
    // Cameras write other files beside their photographs.
    if extension.is_none() && Foreign::of(&bytes, "").is_none_or(|kind| kind == Foreign::Raw) {
        return Ok(());
    }
    // By its own name: raw files look like TIFF.
    decode_photo(&bytes, &name)?;
    let Some(extension) = extension else { return Ok(()) };
    let photo = project.keep(purpose, &bytes, extension)?;
    hub.kept(purpose, photo);
    Ok(())
}

/// Where the pages are, for programs.
#[derive(Serialize)]
struct Addresses<'a> {
    schema: &'static str,
    operator: &'a str,
    #[serde(flatten)]
    links: &'a Links,
}

/// Says where the pages are.
fn announce(args: &StudioArgs, links: &Links) -> Outcome {
    if args.json {
        return print_json(&Addresses {
            schema: "slcal-studio-addresses/1",
            operator: &links.operator,
            links,
        });
    }
    let mut text = format!(
        "slcal studio works in {}\n\n  operator   {}\n  display    {}   (open it on the projector)\n",
        sanitized(&args.folder().display().to_string()),
        links.operator,
        links.display
    );
    if let Some(camera) = &links.camera {
        let _ = write!(
            text,
            "  elsewhere  {}   (operator)\n  phone      {camera}\n  watcher    {}\n\n",
            links.operator_elsewhere.as_deref().unwrap_or_default(),
            links.watcher
        );
        text += &links.qr_text().unwrap_or_default();
        text += "\nAnyone in this network can read along: the connection is not encrypted. A webcam, the choice of the display and \
                 keeping it awake need the addresses with 127.0.0.1 on this machine.\n";
    } else if args.lan {
        text += "\nThis machine has no address in a network.\n";
    }
    text += "\nCtrl-C ends it; nothing is lost.\n";
    print_result(&text)
}
