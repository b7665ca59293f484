//! Photograph of stripes → matches.
