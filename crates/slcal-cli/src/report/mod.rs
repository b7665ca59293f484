//! One self-contained HTML file about a rig, or about a cloud: the verdict first, then its reasons.
//!
//! [`RigPage`] is what a report on a rig shows, [`CloudPage`] what a report on a cloud shows. Each other file is one section, and
//! says in a line why it is not shown where something is missing. `working_volume` predicts uncertainty for `verdict` and
//! `uncertainty_map`. `plot` draws flat plots, `view_3d` what the page's script shows in space. `maud` escapes every text. The same page gives the same file.

mod assumptions;
mod channels;
mod cloud_report;
mod command_line;
mod decoding;
mod next_steps;
mod number;
mod page;
mod parameters;
mod photo;
mod photographs;
mod plot;
mod point_statistics;
mod residuals;
mod rig_page;
mod sequence_maps;
mod sheet_bend;
mod uncertainty_map;
mod verdict;
mod view_3d;

pub(crate) use self::cloud_report::{CloudPage, Pictured, cloud_html};
pub(crate) use self::command_line::CommandLine;
#[cfg(feature = "studio")]
pub(crate) use self::command_line::quoted;
use self::page::Section;
pub(crate) use self::photo::Photo;
pub(crate) use self::rig_page::{RigPage, ShownCloud};
pub(crate) use self::sequence_maps::SequenceMaps;
#[cfg(feature = "studio")]
pub(crate) use self::verdict::sentence;
use crate::summary::working_volume;

/// The report, complete.
pub(crate) fn rig_html(page: &RigPage) -> Vec<u8> {
    let working = working_volume::working_volume(page.rig);
    let head = verdict::head(page, working.as_ref().ok().and_then(Option::as_ref));
    let sections = [
        Some(parameters::section(page)),
        photographs::section(page),
        sheet_bend::section(page),
        channels::section(page),
        residuals::section(page),
        Some(view_3d::section(page.rig, page.cloud.as_ref(), view_3d::Begin::All)),
        uncertainty_map::section(page, working),
        next_steps::warnings(page),
        assumptions::section(page),
        next_steps::commands(page),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    page::html(&verdict::title(page), &head, &sections)
}
