//! A verdict on a terminal.

use slcal_core::Verdict;

use crate::output::{BAD, FAIR, GOOD, styled};

/// A verdict in its colour.
pub(crate) fn verdict(verdict: Verdict) -> String {
    let colour = match verdict {
        Verdict::Good => GOOD,
        Verdict::Fair | Verdict::Weak => FAIR,
        Verdict::Degenerate => BAD,
    };
    styled(colour, verdict.name())
}
