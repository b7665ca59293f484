//! The calibration against known truth: closed forms, Monte Carlo, hostile input.

mod bad_input;
mod channels;
mod coverage;
mod efficiency;
mod extremes;
mod focal_prior;
mod many_views;
mod mistakes;
mod monte_carlo;
mod observations;
mod papers;
pub(crate) mod scene;
mod study;
