//! The command line, one file per verb.

mod advise;
mod bug_report;
mod calibrate;
mod cli;
mod cloud;
mod decode;
mod demo;
mod evaluate;
mod examples;
mod exchange;
mod headings;
mod help;
#[cfg(test)]
mod manual_tests;
mod pattern;
mod photo;
mod reconstruct;
mod rectify;
mod report;
mod shell;
mod simulate;
#[cfg(feature = "studio")]
mod studio;
mod triangulate;
mod value;
mod verify;

pub(crate) use advise::AdviseArgs;
pub(crate) use bug_report::BugReportArgs;
pub(crate) use calibrate::CalibrateArgs;
pub(crate) use cli::{Cli, Verb};
pub(crate) use cloud::CloudArgs;
pub(crate) use decode::{DecodeArgs, DecodeInput};
pub(crate) use demo::DemoArgs;
pub(crate) use evaluate::{EvaluateArgs, ShapeArg};
pub(crate) use exchange::{ExportArgs, ImportArgs};
pub(crate) use help::{command, hinted};
pub(crate) use pattern::{
    CheckerArgs, GrayArgs, PatternOutput, PatternVerb, PhaseArgs, SequenceArgs, SequenceOutput, StripesArgs,
};
pub(crate) use photo::GammaArg;
pub(crate) use reconstruct::ReconstructArgs;
pub(crate) use rectify::RectifyArgs;
pub(crate) use report::ReportArgs;
pub(crate) use shell::{CompletionsArgs, ManArgs};
pub(crate) use simulate::{
    Crosstalk, LightArgs, MeshFrameArg, NoiseArgs, PlaceArgs, SceneArgs, SimulateVerb, ViewsArgs, WallArg,
};
#[cfg(feature = "studio")]
pub(crate) use studio::StudioArgs;
pub(crate) use triangulate::TriangulateArgs;
pub(crate) use verify::VerifyArgs;
