//! What the tests of several modules start from.

mod cloud;
mod layouts;
mod noise;
mod rendered_scenes;
mod rig;

pub(crate) use cloud::test_cloud;
pub(crate) use layouts::layouts;
pub(crate) use noise::Noise;
pub(crate) use rendered_scenes::{rendered_scenes, shared_data};
pub(crate) use rig::test_rig;
