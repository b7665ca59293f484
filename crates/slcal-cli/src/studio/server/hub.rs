//! The one place where events meet the state: pages, worker and time come here, effects go out from here.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use image::RgbImage;
use serde_json::{Value, json};
use tokio::sync::{Semaphore, broadcast, watch};

use super::access::{Access, Role};
use super::links::Links;
use super::told::{Listener, told};
use crate::studio::event::{DisplayEvent, OperatorEvent};
use crate::studio::job::Done;
use crate::studio::machine::{Effect, Machine};
use crate::studio::project::{Project, Purpose, StoredPhoto};
use crate::studio::queue::Queue;
use crate::studio::state::Problem;
use crate::studio::worker::Pictures;

/// Messages that wait for a slow page before it misses some.
const MESSAGES: usize = 64;
const DECODED_AT_A_TIME: usize = 2;

/// A message to pages beside the state.
#[derive(Debug, Clone)]
pub(super) enum Message {
    /// To all pages that see the live picture.
    Live(Arc<str>),
    /// To the page that operates.
    Shoot(Arc<str>),
}

/// A page that is connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Page {
    id: u64,
    role: Role,
}

/// What is changed under the lock.
struct Inner {
    machine: Machine,
    pages: Vec<Page>,
    next_id: u64,
    /// The page that operates.
    operating: Option<u64>,
    live_cloud: Option<(u64, Arc<[u8]>)>,
}

pub(in crate::studio) struct Hub {
    inner: Mutex<Inner>,
    pub(super) access: Mutex<Access>,
    pub(super) project: Arc<Project>,
    pub(super) pictures: Arc<Pictures>,
    queue: Arc<Queue>,
    links: Links,
    changed: watch::Sender<u64>,
    messages: broadcast::Sender<Message>,
    started: Instant,
    /// Photographs that are decoded at a time for requests: large ones take hundreds of megabytes each.
    pub(super) decoding: Semaphore,
}

impl Hub {
    pub(in crate::studio) fn new(
        (machine, effects): (Machine, Vec<Effect>),
        access: Access,
        links: Links,
        project: Arc<Project>,
        pictures: Arc<Pictures>,
        queue: Arc<Queue>,
    ) -> Arc<Self> {
        let inner = Inner { machine, pages: Vec::new(), next_id: 1, operating: None, live_cloud: None };
        let hub = Arc::new(Self {
            inner: Mutex::new(inner),
            access: Mutex::new(access),
            project,
            pictures,
            queue,
            links,
            changed: watch::Sender::new(0),
            messages: broadcast::Sender::new(MESSAGES),
            started: Instant::now(),
            decoding: Semaphore::new(DECODED_AT_A_TIME),
        });
        hub.change(|_| effects);
        hub
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn access(&self) -> MutexGuard<'_, Access> {
        self.access.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn now_ms(&self) -> u64 {
        self.started.elapsed().as_millis() as u64
    }

    /// Changes the state, does what follows, and tells the pages.
    fn change(&self, event: impl FnOnce(&mut Inner) -> Vec<Effect>) {
        let mut inner = self.lock();
        inner.machine.at(self.now_ms());
        let effects = event(&mut inner);
        // Live frames change nothing that pages draw from the state.
        let quiet =
            effects.iter().all(|e| matches!(e, Effect::Look(_) | Effect::Live(_))) && !effects.is_empty();
        for effect in effects {
            self.follow(effect, &mut inner);
        }
        drop(inner);
        if !quiet {
            self.changed.send_modify(|version| *version += 1);
        }
    }

    fn follow(&self, effect: Effect, inner: &mut Inner) {
        let failed = |inner: &mut Inner, why: String| {
            inner.machine.state.problem =
                Some(Problem::new("not-kept", why, "make room on the disk, or start with another --dir"));
        };
        match effect {
            Effect::Work(job) => self.queue.push(job),
            // All are told after every change.
            Effect::Tell => {}
            Effect::Live(frame) => self.queue.show(frame),
            Effect::Shoot { shot, purpose } => {
                let message = json!({ "type": "shoot", "shot": shot, "purpose": purpose }).to_string();
                let _ = self.messages.send(Message::Shoot(message.into()));
            }
            Effect::Look(look) => {
                let message = json!({ "type": "live", "live": look }).to_string();
                let _ = self.messages.send(Message::Live(message.into()));
            }
            Effect::LiveCloud { sequence, bytes } => inner.live_cloud = Some((sequence, bytes)),
            Effect::Save => {
                if let Err(failure) = self.project.save(&inner.machine.settings()) {
                    failed(inner, failure.to_string());
                }
            }
            Effect::Log(command) => {
                if let Err(failure) = self.project.log(&command) {
                    failed(inner, failure.to_string());
                }
            }
        }
    }

    /// Waits for changes of the state.
    pub(super) fn watch(&self) -> watch::Receiver<u64> {
        self.changed.subscribe()
    }

    /// Receives messages beside the state.
    pub(super) fn listen(&self) -> broadcast::Receiver<Message> {
        self.messages.subscribe()
    }

    /// A page connects; the first operator operates.
    pub(super) fn connect(&self, role: Role) -> u64 {
        let mut id = 0;
        self.change(|inner| {
            id = inner.next_id;
            inner.next_id += 1;
            inner.pages.push(Page { id, role });
            if role == Role::Operator && inner.operating.is_none() {
                inner.operating = Some(id);
            }
            self.count_displays(inner)
        });
        id
    }

    pub(super) fn disconnect(&self, id: u64) {
        self.change(|inner| {
            inner.pages.retain(|p| p.id != id);
            if inner.operating == Some(id) {
                inner.operating = inner.pages.iter().find(|p| p.role == Role::Operator).map(|p| p.id);
                inner.machine.operator_changed();
            }
            self.count_displays(inner)
        });
    }

    pub(super) fn operates(&self, id: u64) -> bool {
        self.lock().operating == Some(id)
    }

    /// Refuses what comes from an operator's page that does not operate.
    pub(super) fn check_operates(&self, id: u64) -> Result<(), Problem> {
        if self.operates(id) { Ok(()) } else { Err(not_operating()) }
    }

    /// An event of an operator's page.
    pub(super) fn operate(&self, id: u64, event: OperatorEvent) -> Result<(), Problem> {
        let mut refused = None;
        self.change(|inner| {
            if event == OperatorEvent::TakeOver {
                if inner.operating.replace(id) != Some(id) {
                    inner.machine.operator_changed();
                }
                return Vec::new();
            }
            if inner.operating != Some(id) {
                refused = Some(not_operating());
                return Vec::new();
            }
            inner.machine.operate(event).unwrap_or_else(|problem| {
                refused = Some(problem);
                Vec::new()
            })
        });
        refused.map_or(Ok(()), Err)
    }

    pub(super) fn display(&self, event: DisplayEvent) {
        self.change(|inner| inner.machine.display(event));
    }

    /// A live frame of the page that operates.
    pub(super) fn frame(&self, id: u64, seq: u32, picture: Arc<RgbImage>) {
        self.change(
            |inner| {
                if inner.operating == Some(id) { inner.machine.frame(seq, picture) } else { vec![] }
            },
        );
    }

    /// What the worker found.
    pub(in crate::studio) fn done(&self, done: Done) {
        let now = self.now_ms();
        self.change(|inner| inner.machine.done(done, now));
    }

    /// Time passes.
    pub(super) fn tick(&self) {
        let now = self.now_ms();
        let mut inner = self.lock();
        let watched = inner.pages.iter().any(|p| matches!(p.role, Role::Operator | Role::Watcher));
        let effects = inner.machine.tick(now, watched);
        let mut is_told = effects.iter().any(|e| !matches!(e, Effect::Live(_)));
        for effect in effects {
            self.follow(effect, &mut inner);
        }
        is_told |= inner.machine.give_up(now);
        drop(inner);
        if is_told {
            self.change(|_| Vec::new());
        }
    }

    /// What a photograph shows that arrives now, as the answer to a shot or by itself.
    pub(in crate::studio) fn purpose(&self, shot: Option<u64>) -> Result<Purpose, Problem> {
        self.lock().machine.purpose_of(shot)
    }

    /// Tells of something that went wrong beside the requests.
    pub(in crate::studio) fn trouble(&self, problem: Problem) {
        self.change(|inner| {
            inner.machine.state.problem = Some(problem);
            Vec::new()
        });
    }

    /// A photograph that was kept in the project.
    pub(in crate::studio) fn kept(&self, purpose: Purpose, photo: StoredPhoto) {
        self.change(|inner| inner.machine.kept(purpose, photo));
    }

    pub(super) fn project_picture(&self, name: String, bytes: Arc<[u8]>) -> Result<(), Problem> {
        let mut refused = None;
        self.change(|inner| {
            inner.machine.project_picture(name, bytes).unwrap_or_else(|problem| {
                refused = Some(problem);
                Vec::new()
            })
        });
        refused.map_or(Ok(()), Err)
    }

    /// Looks at the machine.
    pub(super) fn with<T>(&self, look: impl FnOnce(&Machine) -> T) -> T {
        look(&self.lock().machine)
    }

    fn count_displays(&self, inner: &mut Inner) -> Vec<Effect> {
        let count = inner.pages.iter().filter(|p| p.role == Role::Display).count();
        if count == 0 {
            self.pictures.darken();
        }
        inner.machine.displays(count)
    }

    pub(super) fn live_cloud(&self) -> Option<Arc<[u8]>> {
        self.lock().live_cloud.as_ref().map(|(_, bytes)| bytes.clone())
    }

    /// The state as one page is told it.
    pub(super) fn told(&self, role: Role, id: Option<u64>) -> Value {
        let inner = self.lock();
        let count = |role| inner.pages.iter().filter(|p| p.role == role).count();
        let to = Listener {
            role,
            id,
            operating: id.is_some() && inner.operating == id,
            displays: count(Role::Display),
            watchers: count(Role::Watcher),
            operators: count(Role::Operator),
        };
        told(&inner.machine, &to, &self.links, self.project.folder())
    }
}

fn not_operating() -> Problem {
    Problem::new("not-operating", "another page operates", "take over first")
}
