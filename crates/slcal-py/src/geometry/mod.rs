//! Cameras and poses: values that rigs are made of.

mod camera;
mod pose;

use pyo3::prelude::*;

pub(crate) use camera::{Camera, distortion_of};
pub(crate) use pose::{Pose, pose_of};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Camera>()?;
    module.add_class::<Pose>()
}
