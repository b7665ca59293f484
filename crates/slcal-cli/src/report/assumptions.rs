//! What the calibration takes for given, and what it would cost if it were otherwise.

use maud::{Markup, html};
use slcal_core::{Assumption, AssumptionStatus};

use super::page::Section;
use super::rig_page::RigPage;
use super::verdict::sentence;

/// The columns; where a window is narrow, their cells stand below each other, each with its title.
const TITLES: [&str; 5] = ["Assumption", "Status", "Value", "What a departure would do", "What checks it"];

/// A row for each assumption, those that the verdict rests on first.
pub(super) fn section(page: &RigPage) -> Option<Section> {
    let quality = page.rig.quality.as_ref()?;
    if quality.assumptions.is_empty() {
        return None;
    }
    let decisive: Vec<&Assumption> = quality.rests_on().collect();
    let others = quality.assumptions.iter().filter(|a| !decisive.contains(a));
    let content = html! {
        p { "The result holds if these are true. The moves say by how much focal lengths and baseline would change, found by \
             solving again. Assumptions in bold cost more than the stated σ, and nothing in the photographs confirms them." }
        div.scroll { table.stacked {
            thead { tr { @for title in TITLES { th scope="col" { (title) } } } }
            tbody {
                @for a in &decisive { (row(a, true)) }
                @for a in others { (row(a, false)) }
            }
        } }
    };
    Some(Section { id: "assumptions", title: "What is assumed", content })
}

fn row(a: &Assumption, decisive: bool) -> Markup {
    let status = match a.status {
        AssumptionStatus::Assumed => "assumed",
        AssumptionStatus::Tested => "tested by the photographs",
        AssumptionStatus::Estimated => "estimated from the photographs",
    };
    let check = (a.status == AssumptionStatus::Assumed).then(|| sentence(a.check()));
    let cells = [Some(status.to_owned()), Some(value(a)), Some(sentence(&a.cost())), check];
    html! {
        tr {
            th scope="row" {
                @if decisive { strong { (sentence(&a.text)) } } @else { (sentence(&a.text)) } " " span.aside { code { (a.code) } }
            }
            @for (title, cell) in TITLES[1..].iter().zip(cells) { td data-title=[cell.as_ref().map(|_| title)] { (cell.unwrap_or_default()) } }
        }
    }
}

fn value(a: &Assumption) -> String {
    let digits = |x: f64| {
        if x.abs() >= 100.0 {
            1
        } else if x.abs() >= 1.0 {
            2
        } else {
            4
        }
    };
    let number = |x: f64| format!("{x:.*}", digits(x.abs().max(a.if_off_by)));
    let sigma = a.sigma.map_or_else(|| " exactly".to_owned(), |s| format!(" ± {}", number(s)));
    format!("{}{sigma} {}", number(a.value), a.unit).trim_end().to_owned()
}
