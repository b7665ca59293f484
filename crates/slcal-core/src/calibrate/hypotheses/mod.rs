//! Other explanations of the observations. Each is tried, and reported where it fits better.

pub(crate) mod aspect;
pub(crate) mod centimetres;
pub(crate) mod contradiction;
pub(crate) mod either_way;
pub(crate) mod explain;
mod explanation;
mod misfit;
pub(crate) mod other_size;
mod outline_fit;
mod plausible;
pub(crate) mod shown_scale;
pub(crate) mod together;
pub(crate) mod told;
pub(crate) mod transposed;
mod with_amounts;
