//! The step Use: pictures without keystone.

use std::sync::Arc;

use super::state_machine::{Effect, Machine};
use crate::studio::job::Job;
use crate::studio::state::{Problem, Step};

impl Machine {
    /// A picture that is to be projected without keystone.
    pub(in crate::studio) fn project_picture(
        &mut self,
        name: String,
        bytes: Arc<[u8]>,
    ) -> Result<Vec<Effect>, Problem> {
        self.need(Step::Use)?;
        self.state.busy = Some("drawing the picture");
        Ok(vec![Effect::Work(Job::Rectify { name, bytes })])
    }
}
