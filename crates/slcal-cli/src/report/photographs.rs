//! The photographs with the measured points and their residuals.

use maud::{Markup, PreEscaped, html};
use slcal_core::{Rig, View};

use super::number::significant;
use super::page::Section;
use super::photo::Photo;
use super::residuals::odd_words;
use super::rig_page::{RigPage, photo_name};
use crate::picture::residual_drawing::{self, MeasuredView};
use crate::picture::{Drawing, sheet};

/// How much coarser lines and words are than in a separate picture, since pages show photographs smaller.
const COARSER_ALONE: f64 = 1.3;
const COARSER_AMONG_OTHERS: f64 = 2.0;

pub(super) fn section(page: &RigPage) -> Option<Section> {
    let rig = page.rig;
    if rig.views.is_empty() {
        return None;
    }
    let shown = page.photos.iter().flatten().count();
    let missing = rig.views.len() - shown.min(rig.views.len());
    let fits = fits(page);
    let like = drawing(rig, "");
    let factor = residual_drawing::magnification(fits.iter().flatten().copied(), like.unit());
    let content = html! {
        @if shown > 0 {
            (legend(rig, &fits, factor))
            div.photos {
                @for (i, view) in rig.views.iter().enumerate() {
                    @if let Some(Some(photo)) = page.photos.get(i) {
                        (shot(rig, i, view, photo, fits.get(i).copied().flatten(), factor))
                    }
                }
            }
        }
        @if missing > 0 {
            p.note {
                (if shown == 0 { "The photographs are not shown" } else { "Some photographs are not shown" })
                ": their files were not found. Give them with " code { "slcal report --photo" } "."
            }
        }
    };
    Some(Section { id: "photographs", title: "Photographs", content })
}

/// Observations and residuals of each view, where they are known.
fn fits<'a>(page: &'a RigPage) -> Vec<Option<MeasuredView<'a>>> {
    let misses = page.residuals.as_ref().ok();
    let fit = |(i, view): (usize, &'a View)| {
        let observed = page.observations?.views.get(i)?;
        Some(MeasuredView { observed, residuals: misses?.get(i)?, view })
    };
    page.rig.views.iter().enumerate().map(fit).collect()
}

/// A drawing with coarser lines, as the page shows photographs small.
fn drawing(rig: &Rig, title: &str) -> Drawing {
    let coarser = if rig.views.len() > 1 { COARSER_AMONG_OTHERS } else { COARSER_ALONE };
    Drawing::new([rig.camera.model.width, rig.camera.model.height], title).coarser(coarser)
}

fn shot(
    rig: &Rig,
    i: usize,
    view: &View,
    photo: &Photo,
    fit: Option<MeasuredView<'_>>,
    factor: f64,
) -> Markup {
    let name = photo_name(rig, i);
    let mut drawing = drawing(rig, &format!("{name}: the sheet and the points measured on it"));
    match fit {
        Some(fit) => residual_drawing::draw(&mut drawing, fit, factor),
        None => sheet::draw_outline(&mut drawing, &view.corners_px),
    }
    let odd = fit.is_some_and(|f| f.residuals.is_odd());
    html! {
        figure.odd[odd] {
            (photo.under(&drawing))
            figcaption {
                strong.file { (name) }
                @if let Some(rms) = &view.rms_px {
                    ": rms residuals: sheet edges " (significant(rms.edges, 2)) " px"
                    @if let Some(corners) = rms.corners { ", projected corners " (significant(corners, 2)) " px" }
                }
                @if odd { " " span.flag { "⚠ " (odd_words(fit.map(|f| f.residuals))) } }
            }
        }
    }
}

/// The legend, in the colours of the drawings.
fn legend(rig: &Rig, fits: &[Option<MeasuredView<'_>>], factor: f64) -> Markup {
    let any = |of: fn(&MeasuredView<'_>) -> bool| fits.iter().flatten().any(of);
    let fitted = fits.iter().any(Option::is_some);
    let outliers = any(|f| f.outliers() > 0);
    html! {
        ul.legend {
            li { (key(html! { line x1="2" y1="8" x2="26" y2="8" stroke="#56b4e9" stroke-width="2"; })) "the sheet" }
            @if fitted {
                li { (key(html! { circle cx="8" cy="8" r="2" fill="#f0e442"; circle cx="20" cy="8" r="2" fill="#f0e442"; }))
                    "measured edge points" }
                @if any(|f| !f.observed.pairs.is_empty()) {
                    li { (key(html! { circle cx="14" cy="8" r="4.5" fill="none" stroke="#e69f00" stroke-width="1.6"; }))
                        "projected corners" }
                    li { (key(html! { circle cx="14" cy="8" r="4.5" fill="none" stroke="#e08cbe" stroke-width="2"; }))
                        "the first projected corner" }
                }
                li { (key(html! { path d="M3 8H22M17 4l6 4l-6 4" fill="none" stroke="#00b282" stroke-width="2"; }))
                    "residuals, to the predicted position, enlarged " (significant(factor, 2)) " times" }
                @if outliers {
                    li { (key(html! { path d="M10 4l8 8M18 4l-8 8" stroke="#ec680a" stroke-width="2"; })) "outliers, left out" }
                }
                li { (key(html! { path d="M2 8H26" stroke="#e08cbe" stroke-width="1.5" stroke-dasharray="5 4"; }))
                    (vanishing(rig)) }
            }
        }
    }
}

fn key(mark: Markup) -> Markup {
    let mark = PreEscaped(mark.into_string());
    html! { svg.key viewBox="0 0 28 16" aria-hidden="true" { rect width="28" height="16" rx="3" fill="#33383f" {} (mark) } " " }
}

/// Only vanishing points near the frame are drawn.
fn vanishing(rig: &Rig) -> &'static str {
    if rig.views.len() == 1 {
        "to a vanishing point near the frame"
    } else {
        "to vanishing points near the frame"
    }
}
