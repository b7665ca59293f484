//! Matches and rig → points in space.
