//! The photographs with the measured points and their residuals.

use maud::{Markup, html};
use slcal_core::{Rig, View};

use super::number::significant;
use super::page::Section;
use super::photo::Photo;
use super::residuals::odd_words;
use super::rig_page::{RigPage, photo_name};
use crate::picture::residual_drawing::{self, MeasuredView};
use crate::picture::{Drawing, Swatch, sheet};

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
    let factor = residual_drawing::enlargement(fits.iter().flatten().copied(), like.unit());
    let content = html! {
        @if shown > 0 {
            (legend(rig, &fits, factor))
            div.photos {
                @for (i, view) in rig.views.iter().enumerate() {
                    @if let Some(Some(photo)) = page.photos.get(i) {
                        (shot(page, i, view, photo, fits.get(i).copied().flatten(), factor))
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
    let (residuals, camera) = (page.residuals.as_ref().ok(), &page.rig.camera.model);
    let fit = |(i, view): (usize, &'a View)| {
        let observed = page.observations?.views.get(i)?;
        Some(MeasuredView { observed, residuals: residuals?.get(i)?, view, camera })
    };
    page.rig.views.iter().enumerate().map(fit).collect()
}

/// A drawing with coarser lines, as the page shows photographs small.
fn drawing(rig: &Rig, title: &str) -> Drawing {
    let coarser = if rig.views.len() > 1 { COARSER_AMONG_OTHERS } else { COARSER_ALONE };
    Drawing::new(rig.camera.model.size(), title).coarser(coarser)
}

fn shot(
    page: &RigPage,
    i: usize,
    view: &View,
    photo: &Photo,
    fit: Option<MeasuredView<'_>>,
    factor: f64,
) -> Markup {
    let (rig, pairs) = (page.rig, page.pairs_word());
    let name = photo_name(rig, i);
    let mut drawing = drawing(rig, &format!("{name}: the sheet and the points measured on it"));
    match fit {
        Some(fit) => residual_drawing::draw(&mut drawing, fit, factor),
        None => sheet::draw_expected(&mut drawing, view, &rig.camera.model),
    }
    let odd = fit.is_some_and(|f| f.residuals.is_odd());
    html! {
        figure.odd[odd] {
            (photo.under(&drawing))
            figcaption {
                strong.file { (name) }
                @if let Some(rms) = &view.rms_px {
                    ": rms residuals: sheet edges " (significant(rms.edges, 2)) " px"
                    @if let Some(corners) = rms.corners { ", " (pairs) " " (significant(corners, 2)) " px" }
                }
                @if let Some(clipped) = view.clipped_percent.filter(|p| p.round() > 0.0) {
                    "; " (format!("{clipped:.0} % of the lit sheet is overexposed"))
                }
                @if odd { " " span.flag { "⚠ " (odd_words(fit.map(|f| f.residuals))) } }
            }
        }
    }
}

/// The legend of all drawings.
fn legend(rig: &Rig, fits: &[Option<MeasuredView<'_>>], factor: f64) -> Markup {
    let fits = fits.iter().flatten().copied();
    let legend = residual_drawing::legend(&drawing(rig, ""), "", fits, factor);
    let marks = legend.entries.iter().filter_map(|e| Some((key(&e.swatch)?, &e.text)));
    html! { ul.legend { @for (mark, text) in marks { li { (mark) (text) } } } }
}

/// The mark of an entry; scale bars fit no page, which shows photographs at any size.
fn key(swatch: &Swatch) -> Option<Markup> {
    let (pen, path, width) = match swatch {
        Swatch::Line(pen) => (pen, "M2 8H26", 2),
        Swatch::Dot(pen) => (pen, "M8 8h0M20 8h0", 4),
        Swatch::Ring(pen) => (pen, "M9.5 8a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0-9 0", 2),
        Swatch::Arrow(pen) => (pen, "M3 8H22M17 4l6 4l-6 4", 2),
        Swatch::Cross(pen) => (pen, "M10 4l8 8M18 4l-8 8", 2),
        _ => return None,
    };
    let [r, g, b] = pen.color;
    Some(html! {
        svg.key viewBox="0 0 28 16" aria-hidden="true" {
            rect width="28" height="16" rx="3" fill="#33383f" {}
            path d=(path) fill="none" stroke={ "rgb(" (r) "," (g) "," (b) ")" } stroke-width=(width) stroke-linecap="round"
                stroke-dasharray=[pen.dashed.then_some("4 5")] {}
        }
        " "
    })
}
