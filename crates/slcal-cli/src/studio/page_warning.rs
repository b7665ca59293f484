//! A warning as the page tells it.

use serde::Serialize;

/// What was noticed, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct PageWarning {
    pub(super) code: String,
    pub(super) message: String,
    pub(super) advice: String,
}

impl From<&slcal_core::Warning> for PageWarning {
    fn from(w: &slcal_core::Warning) -> Self {
        Self { code: w.code.clone(), message: w.message.clone(), advice: w.advice.clone() }
    }
}
