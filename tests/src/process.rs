//! Processes that tests start: with signals as a terminal sets them, whoever runs the tests, and with a limit on their time.

use std::ffi::OsStr;
use std::io::Read;
use std::process::{Child, Command, ExitStatus, Output};
use std::sync::OnceLock;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How long a process may take before it is killed and the test fails. Nothing that a test runs takes a tenth of it.
pub const PATIENCE: Duration = Duration::from_mins(5);

const POLL: Duration = Duration::from_millis(2);

/// A command that begins with the usual dispositions of signals. Under `nohup` or a shell's `&` some are ignored, and a process
/// that inherited that would not be ended by what a test sends.
#[must_use]
pub fn command(program: impl AsRef<OsStr>) -> Command {
    static HAS_ENV: OnceLock<bool> = OnceLock::new();
    let tried = || Command::new("env").args(["--default-signal", "true"]).status();
    if !HAS_ENV.get_or_init(|| cfg!(target_os = "linux") && tried().is_ok_and(|s| s.success())) {
        return Command::new(program);
    }
    let mut command = Command::new("env");
    command.arg("--default-signal").arg(program);
    command
}

/// Waits for the end of a process.
///
/// # Panics
/// When it takes longer than [`PATIENCE`]; it is killed then.
pub fn wait(child: &mut Child) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a process") {
            return status;
        }
        if begun.elapsed() > PATIENCE {
            let _ = child.kill();
            let _ = child.wait();
            panic!("a process had not ended after {PATIENCE:?}, and was killed");
        }
        thread::sleep(POLL);
    }
}

/// The same with what it prints, where that is piped.
///
/// # Panics
/// As [`wait`].
#[must_use]
pub fn output(mut child: Child) -> Output {
    let (stdout, stderr) = (collected(child.stdout.take()), collected(child.stderr.take()));
    let status = wait(&mut child);
    let [stdout, stderr] = [stdout, stderr].map(|read| read.join().expect("the output of a process"));
    Output { status, stdout, stderr }
}

fn collected(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// Sends a signal by its name, "INT" for instance.
///
/// # Panics
/// When there is no such process.
pub fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|s| s.success()), "SIG{name} was not sent");
}
