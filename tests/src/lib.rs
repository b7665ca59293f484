//! Runs of the real binary in fresh folders, and photographs for it to look at.

pub mod exif;
pub mod process;
mod scene;
pub mod studio;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// What simulated and rendered scenes of ideal lenses and flat sheets are: with it the estimator is exact on them.
pub const IDEAL: &str = "--flatness flat --distortion none --projector-distortion none";

pub use scene::Scene;

/// A fresh folder in which a binary runs; removed at the end.
#[derive(Debug)]
pub struct Bench {
    folder: TempDir,
    binary: PathBuf,
}

/// What a run left.
#[derive(Debug)]
pub struct Run {
    /// Exit code; −1 when a signal ended it.
    pub code: i32,
    /// What it printed as results, bytes.
    pub stdout: Vec<u8>,
    /// What it said.
    pub stderr: String,
}

impl Bench {
    /// A fresh folder for the binary.
    ///
    /// # Panics
    /// When no temporary folder can be made.
    #[must_use]
    pub fn new(binary: &str) -> Self {
        Self { folder: TempDir::new().expect("a temporary folder"), binary: PathBuf::from(binary) }
    }

    /// A path in the folder.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Puts a file into the folder.
    ///
    /// # Panics
    /// When it cannot be written.
    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).expect("a writable temporary folder");
    }

    /// The text of a file in the folder.
    ///
    /// # Panics
    /// When there is no such text.
    #[must_use]
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Names in the folder, sorted, hidden ones too.
    ///
    /// # Panics
    /// When the folder cannot be read.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.folder.path())
            .expect("the temporary folder")
            .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// The binary in the folder, to be given its arguments.
    #[must_use]
    pub fn command(&self) -> Command {
        let mut command = process::command(&self.binary);
        command.current_dir(self.folder.path());
        command
    }

    /// Runs the binary in the folder with words separated by spaces.
    #[must_use]
    pub fn run(&self, line: &str) -> Run {
        self.run_args(&line.split_whitespace().collect::<Vec<_>>(), &[])
    }

    /// Runs the binary in the folder with these arguments and bytes on stdin.
    ///
    /// # Panics
    /// When the binary cannot be started.
    #[must_use]
    pub fn run_args(&self, args: &[&str], stdin: &[u8]) -> Run {
        let mut child = self
            .command()
            .args(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("{}: {e}", self.binary.display()));
        let mut pipe = child.stdin.take().expect("a piped stdin");
        let bytes = stdin.to_vec();
        let feeder = std::thread::spawn(move || {
            // A run that ends without reading its stdin is no failure of the test.
            let _ = pipe.write_all(&bytes);
        });
        let output = process::output(child);
        feeder.join().expect("the feeding of stdin");
        Run {
            code: output.status.code().unwrap_or(-1),
            stdout: output.stdout,
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Run {
    /// What it printed, as text.
    #[must_use]
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.stdout).into_owned()
    }

    /// The same with single spaces between words, wherever lines were broken.
    #[must_use]
    pub fn words(&self) -> String {
        self.text().split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Asserts success.
    ///
    /// # Panics
    /// When the exit code is not 0.
    #[must_use]
    pub fn ok(self) -> Self {
        assert_eq!(self.code, 0, "stderr: {}", self.stderr);
        self
    }

    /// Asserts an exit code and that the message holds these words; and that nothing was printed as a result.
    ///
    /// # Panics
    /// When it is otherwise.
    pub fn fails(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, code, "stderr: {}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "no \"{word}\" in: {}", self.stderr);
        }
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        assert!(self.stdout.is_empty(), "results in spite of the failure: {}", self.text());
    }
}

/// The root of the repository.
#[must_use]
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}
