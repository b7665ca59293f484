//! There and back again, for values that nobody chose: geometry, files and patterns.

mod files;
mod geometry;
mod patterns;
