//! Values of projective and Euclidean geometry: no estimation, no images.
//!
//! Conventions: integer pixel coordinates are pixel centres; device frames are x right, y down, z forward;
//! lengths are millimetres; transforms are named `a_from_b`.

mod bent_side;
mod camera;
mod distortion;
mod homography;
mod legendre;
mod length_unit;
mod line;
mod nominal;
mod paper;
mod plane;
mod point;
mod pose;
mod ray;
mod rectangle;
mod sheet_bend;
mod sheet_size;
mod warp;

pub(crate) use bent_side::BentSide;
pub use camera::{Camera, Intrinsics};
pub use distortion::Distortion;
public_with! { "stages": pub use homography::Homography; }
public_with! { "stages": pub use line::Line; }
pub(crate) use length_unit::length_mm;
pub(crate) use nominal::FILM_DIAGONAL_MM;
pub(crate) use paper::{UsualSheet, usual_proportions};
#[cfg(any(feature = "evaluate", feature = "stages"))]
pub use plane::Plane;
#[cfg(not(any(feature = "evaluate", feature = "stages")))]
pub(crate) use plane::Plane;
public_with! { "stages": pub use point::{ProjectivePoint, VanishingPoints}; }
pub use pose::Pose;
pub(crate) use pose::nearest_rotation;
public_with! { "stages": pub use ray::Ray; }
pub use rectangle::RectangleSize;
pub(crate) use rectangle::Side;
pub use sheet_bend::SheetBend;
pub(crate) use sheet_bend::{Shortening, Terms};
pub use sheet_size::SheetSize;
public_with! { "stages": pub use warp::Warp; }
