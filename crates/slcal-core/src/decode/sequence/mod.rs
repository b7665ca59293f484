//! Photographs of a sequence (Gray code, shifted sinusoids) → [`DenseMatches`](crate::DenseMatches).
//!
//! `decoder` takes frames in any order (`frame_plan` has the best one). Each becomes grey `levels` and is folded (`folded_frames`, by
//! `folded_band`) into `planes`, a fixed number of bytes per pixel; along some lines all levels are kept (`sample_lines`). `decoding` makes the
//! result of them. The samples tell the noise (`frame_noise`), and whether the frames are what they are said to be (`frame_checks`);
//! `positions` reads the cell of a lit pixel (`pixel_light`, `pixel_code`) and its position from the phase (`phase_positions`) or between
//! the borders of the code along `code_lines` (`code_borders`, `disorder`); `mixed_pixels` leaves out those that see two surfaces, and
//! `result_checks` refuses what is no scene.

#[cfg(test)]
mod bad_input_tests;
mod code_borders;
mod code_lines;
mod decoder;
mod decoding;
mod disorder;
mod folded_band;
mod folded_frames;
mod frame_checks;
mod frame_noise;
mod frame_plan;
mod levels;
mod mixed_pixels;
mod phase_positions;
mod pixel_code;
mod pixel_light;
mod planes;
mod positions;
mod report;
mod result_checks;
mod sample_lines;
#[cfg(test)]
mod tests;

pub use decoder::SequenceDecoder;
pub use report::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoding};
