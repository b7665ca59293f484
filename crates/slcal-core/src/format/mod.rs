//! Rigs, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.
