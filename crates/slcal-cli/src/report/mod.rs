//! One self-contained HTML file about a rig, or about a cloud: the verdict first, then its reasons.
//!
//! [`Subject`] is what a report on a rig shows, [`CloudSubject`] what a report on a cloud shows. Each other file is one section, and
//! says in a line why it is not shown where something is missing. `working_volume` predicts uncertainty for `verdict` and
//! `uncertainty_map`. `maud` escapes every text, `figure` every plot. The same subject gives the same file.

mod cloud_report;
mod command_line;
mod decoding;
mod figure;
mod next_steps;
mod number;
mod page;
mod parameters;
mod photo;
mod photographs;
mod point_statistics;
mod residuals;
mod subject;
mod uncertainty_map;
mod verdict;
mod view_3d;
mod working_volume;

pub(crate) use self::cloud_report::{CloudSubject, cloud_html};
pub(crate) use self::command_line::CommandLine;
use self::figure::Figures;
use self::page::Section;
pub(crate) use self::photo::Photo;
pub(crate) use self::point_statistics::FittedSurface;
pub(crate) use self::subject::{ShownCloud, Subject};

/// The report, complete.
pub(crate) fn rig_html(subject: &Subject) -> Vec<u8> {
    let mut figures = Figures::default();
    let working = working_volume::working(subject.rig);
    let head = verdict::head(subject, working.as_ref().ok().and_then(Option::as_ref));
    let sections = [
        Some(parameters::section(subject)),
        photographs::section(subject),
        residuals::section(subject, &mut figures),
        Some(view_3d::section(subject.rig, subject.cloud.as_ref(), &mut figures)),
        uncertainty_map::section(subject, working, &mut figures),
        next_steps::warnings(subject),
        next_steps::commands(subject),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    page::html(&verdict::title(subject), &head, &sections, &figures)
}
