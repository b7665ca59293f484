//! Photographs of a sequence (Gray code, shifted sinusoids) → [`DenseMatches`](crate::DenseMatches).

#[cfg(test)]
mod bad_input_tests;
mod code_borders;
mod decoder;
mod frame_checks;
mod frame_noise;
mod frame_plan;
mod levels;
mod phase_positions;
mod pixel_code;
mod planes;
mod sample_lines;
#[cfg(test)]
mod tests;

pub use decoder::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoder, SequenceDecoding};
