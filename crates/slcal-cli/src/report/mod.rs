//! One self-contained HTML file about a rig, or about a cloud: the verdict first, then what it rests on.
//!
//! [`Subject`] is what there is to show; every file here is one section, and says in a line why it is not shown where
//! something is missing; `working` is what is foretold where one works, for two of them. `maud` escapes every text, `figure` every plot. The same subject gives the same file.

mod cloud;
mod command;
mod decoding;
mod expected;
mod figure;
mod next;
mod number;
mod page;
mod parameters;
mod photographs;
mod points;
mod residuals;
mod space;
mod verdict;
mod working;

use slcal_core::{Observations, PointCloud, Rig, ViewResiduals};

pub(crate) use self::cloud::{CloudSubject, cloud_html};
pub(crate) use self::command::{CommandLine, quoted};
use self::figure::Figures;
use self::page::Section;
pub(crate) use self::photographs::Photo;
pub(crate) use self::points::Surface;
use crate::name::name_among;

/// What a report is about. Names are those that the reader knows: as they were typed.
pub(crate) struct Subject<'a> {
    pub(crate) rig: &'a Rig,
    /// The rig's file; empty when it has none.
    pub(crate) rig_name: String,
    /// One entry per view, where it is at hand.
    pub(crate) photos: Vec<Option<Photo>>,
    /// What was measured in them.
    pub(crate) observations: Option<&'a Observations>,
    /// How far the measurements lie from the rig, or why that is not known.
    pub(crate) residuals: Result<Vec<ViewResiduals>, String>,
    /// The checkerboard's file, for the commands to run next.
    pub(crate) checker_name: Option<String>,
    pub(crate) cloud: Option<ShownCloud<'a>>,
    /// The commands that led here, the last one last.
    pub(crate) made_by: Vec<String>,
}

impl Subject<'_> {
    /// What the page calls the rig.
    fn name(&self) -> &str {
        if self.rig_name.is_empty() { "calibration" } else { &self.rig_name }
    }
}

/// What the page calls the photograph of view `i`.
fn photo_name(rig: &Rig, i: usize) -> &str {
    let names: Vec<&str> = rig.views.iter().map(|v| v.photo.as_deref().unwrap_or("photograph")).collect();
    name_among(&names, i)
}

/// A cloud beside the rig.
pub(crate) struct ShownCloud<'a> {
    pub(crate) name: String,
    pub(crate) cloud: &'a PointCloud,
}

/// The report, complete.
pub(crate) fn html(subject: &Subject) -> Vec<u8> {
    let mut figures = Figures::default();
    let working = working::working(subject.rig);
    let head = verdict::head(subject, working.as_ref().ok().and_then(Option::as_ref));
    let sections = [
        Some(parameters::section(subject)),
        photographs::section(subject),
        residuals::section(subject, &mut figures),
        Some(space::section(subject.rig, subject.cloud.as_ref(), &mut figures)),
        expected::section(subject, working, &mut figures),
        next::warnings(subject),
        next::commands(subject),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    page::html(&verdict::title(subject), &head, &sections, &figures)
}
