//! Observations → rig.
