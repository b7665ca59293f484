//! One of several plots, chosen without a script.

use maud::{Markup, html};

/// More than these have no rule in the page's style.
const MOST: usize = 4;

/// Plots under their names, of which the reader sees one; the first at the beginning.
pub(crate) fn chosen(id: &str, title: &str, plots: &[(&str, Markup)]) -> Markup {
    debug_assert!(plots.len() <= MOST);
    if let [(_, only)] = plots {
        return only.clone();
    }
    let of = |i: usize| format!("{id}-choice-{i}");
    html! {
        div.chooser role="radiogroup" aria-label=(title) {
            @for (i, (label, _)) in plots.iter().enumerate() {
                input type="radio" name={ (id) "-choice" } id=(of(i)) checked[i == 0];
                label.screen-only for=(of(i)) { (label) }
            }
            div.chosen { @for (_, plot) in plots { div { (plot) } } }
        }
    }
}
