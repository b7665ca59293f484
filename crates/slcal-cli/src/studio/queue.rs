//! Jobs on their way to the worker: all of them in order, of live frames only the newest.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};

use super::job::{Job, LiveFrame};

/// What the worker does next.
#[derive(Debug)]
pub(super) enum Next {
    Job(Job),
    Live(LiveFrame),
}

#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: Mutex<Waiting>,
    ready: Condvar,
}

#[derive(Debug, Default)]
struct Waiting {
    jobs: VecDeque<Job>,
    live: Option<LiveFrame>,
}

impl Queue {
    pub(super) fn push(&self, job: Job) {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).jobs.push_back(job);
        self.ready.notify_one();
    }

    /// Replaces a live frame that still waits.
    pub(super) fn show(&self, frame: LiveFrame) {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).live = Some(frame);
        self.ready.notify_one();
    }

    /// Waits for work; jobs come before live frames.
    pub(super) fn next(&self) -> Next {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(job) = waiting.jobs.pop_front() {
                return Next::Job(job);
            }
            if let Some(frame) = waiting.live.take() {
                return Next::Live(frame);
            }
            waiting = self.ready.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::job::LookFor;
    use super::*;

    #[test]
    fn of_live_frames_only_the_newest_is_looked_at() {
        let queue = Queue::default();
        let frame =
            |seq| LiveFrame { seq, picture: None, look_for: LookFor::Nothing, wanted: None, scene: None };
        (1..4).for_each(|seq| queue.show(frame(seq)));
        queue.push(Job::KeepLive);
        queue.push(Job::Calibrate(vec![1]));
        assert!(matches!(queue.next(), Next::Job(Job::KeepLive)));
        assert!(matches!(queue.next(), Next::Job(Job::Calibrate(used)) if used == [1]));
        assert!(matches!(queue.next(), Next::Live(f) if f.seq == 3));
    }
}
