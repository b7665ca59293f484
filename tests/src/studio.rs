//! A running studio, and requests to it that say exactly what they send.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{Bench, process};

/// Long enough for a busy machine.
const PATIENCE: Duration = Duration::from_mins(2);

/// A studio in a folder of the bench; it ends with this value.
#[derive(Debug)]
pub struct Studio {
    child: Child,
    /// What it printed: the addresses.
    pub addresses: Value,
    host: String,
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    /// Status code.
    pub status: u16,
    /// Lines of the head, in lower case up to the colon.
    pub head: Vec<String>,
    /// The body.
    pub body: Vec<u8>,
}

impl Answer {
    /// The body as JSON; null where it is none.
    #[must_use]
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or(Value::Null)
    }

    /// The code of a refusal.
    #[must_use]
    pub fn refusal(&self) -> String {
        self.json()["error"]["code"].as_str().unwrap_or_default().to_owned()
    }

    /// A line of the head.
    #[must_use]
    pub fn header(&self, name: &str) -> Option<&str> {
        self.head.iter().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
    }
}

impl Studio {
    /// Starts one with these options.
    ///
    /// # Panics
    /// When it does not start.
    #[must_use]
    pub fn start(bench: &Bench, dir: &str, options: &[&str]) -> Self {
        let mut child = Self::command(bench, dir, options).stdout(Stdio::piped()).spawn().expect("a process");
        let out = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut text = String::new();
        for line in out.lines() {
            let line = line.expect("text");
            text += &line;
            if line == "}" {
                break;
            }
        }
        let addresses: Value = serde_json::from_str(&text).expect("addresses");
        let operator = addresses["operator"].as_str().expect("an address");
        let host = operator.trim_start_matches("http://").split('/').next().expect("a host").to_owned();
        Self { child, addresses, host }
    }

    /// The command that starts one.
    #[must_use]
    pub fn command(bench: &Bench, dir: &str, options: &[&str]) -> Command {
        let mut command = process::command(&bench.binary);
        command.args(["studio", "--no-open", "--json", "--dir"]).arg(bench.path(dir)).args(options);
        command.stdin(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// Host and port.
    #[must_use]
    pub fn host(&self) -> &str {
        &self.host
    }

    /// The token in an address.
    #[must_use]
    pub fn token(&self, page: &str) -> String {
        self.addresses[page].as_str().and_then(|a| a.split('#').nth(1)).unwrap_or_default().to_owned()
    }

    /// A request with these lines after the first; the body's length is added.
    ///
    /// # Panics
    /// When the connection fails.
    #[must_use]
    pub fn ask(&self, line: &str, headers: &[&str], body: &[u8]) -> Answer {
        let mut stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        let mut head = format!("{line} HTTP/1.1\r\nContent-Length: {}\r\n", body.len());
        if !headers.iter().any(|h| h.starts_with("Connection:")) {
            head += "Connection: close\r\n";
        }
        for header in headers {
            head += header;
            head += "\r\n";
        }
        head += "\r\n";
        stream.write_all(head.as_bytes()).expect("a request");
        // A server that refuses does not read the rest.
        let _ = stream.write_all(body);
        let mut reader = BufReader::new(stream);
        let mut lines = Vec::new();
        let mut line = String::new();
        while reader.read_line(&mut line).is_ok_and(|n| n > 2) {
            lines.push(std::mem::take(&mut line).trim_end().to_owned());
        }
        let mut lines = lines.into_iter();
        let status = lines.next().and_then(|l| l.split(' ').nth(1)?.parse().ok()).unwrap_or(0);
        let mut answer = Answer { status, head: lines.collect(), body: Vec::new() };
        // The connection may stay open.
        let length = answer.header("content-length").and_then(|l| l.parse().ok()).unwrap_or(0);
        let _ = reader.take(length).read_to_end(&mut answer.body);
        answer
    }

    /// A request of the studio's own pages: with Host, Origin and the cookie of a role's session.
    #[must_use]
    pub fn ask_as(&self, role: &str, line: &str, body: &[u8]) -> Answer {
        let host = format!("Host: {}", self.host);
        let origin = format!("Origin: http://{}", self.host);
        let token = serde_json::json!({ "token": self.token(role) }).to_string();
        let session = self.ask("POST /api/session", &[&host, &origin], token.as_bytes());
        let cookie = session.header("set-cookie").and_then(|c| c.split(';').next()).unwrap_or_default();
        self.ask(line, &[&host, &origin, &format!("Cookie: {cookie}")], body)
    }

    /// The operator's state as soon as it is so.
    ///
    /// # Panics
    /// When it never is.
    #[must_use]
    pub fn state_when(&self, so: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let state = self.ask_as("operator", "GET /api/state?as=operator", b"").json();
            if so(&state) {
                return state;
            }
            assert!(start.elapsed() < PATIENCE, "{state:#}");
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Ends it as `kill -9` does.
    ///
    /// # Panics
    /// When it cannot be ended.
    pub fn kill(&mut self) {
        self.child.kill().expect("a process");
        process::wait(&mut self.child);
    }

    /// The process.
    #[must_use]
    pub fn child(&self) -> &Child {
        &self.child
    }

    /// Waits for its end: its exit code.
    ///
    /// # Panics
    /// When it does not end.
    pub fn code(&mut self) -> Option<i32> {
        process::wait(&mut self.child).code()
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The files of a folder.
///
/// # Panics
/// When it cannot be read.
#[must_use]
pub fn files(folder: &PathBuf) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries.flatten().filter_map(|e| e.file_name().into_string().ok()).collect();
    names.sort();
    names
}
