//! `slcal studio`: show patterns, take photographs, see results, in a browser window.
//!
//! Pages send events to `server`, which hands them to `machine`. The machine changes the `state` and asks for work; `worker` does it on
//! a thread of its own and tells the machine what it found. Pages are told the state as JSON and draw it. `project` is the
//! folder in which everything lies.

mod auto_shot;
mod browser;
mod checker;
mod cloud_note;
mod display_check;
mod event;
mod flash;
mod guide;
mod job;
mod live;
mod machine;
mod page_calibration;
mod pose_angles;
mod project;
mod queue;
mod scan_folder;
mod sequence_cloud;
mod server;
mod simulated_camera;
mod start;
mod state;
mod watch_folder;
mod words;
mod worker;
#[cfg(test)]
mod worker_tests;

pub(crate) use self::start::run;
