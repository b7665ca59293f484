//! What follows from what: events change the state, and ask for work. `state_machine` has the events and where each of them goes, the
//! others a step or a part of the work each.

mod calibrate;
mod display;
mod live;
mod photographs;
mod rectify;
mod scan;
mod sequence;
mod set_up;
mod shooting;
mod state_machine;

pub(super) use self::sequence::FRAME_NOT_SHOWN;
pub(super) use self::state_machine::{Effect, Machine, Options};

#[cfg(test)]
mod sequence_tests;
#[cfg(test)]
mod tests;
