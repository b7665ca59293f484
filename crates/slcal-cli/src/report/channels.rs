//! How red and blue are displaced against green, in projector and camera.

use maud::{Markup, html};
use slcal_core::{ChannelRegistration, RegistrationSource};

use super::number::{decimals_of, field, fixed, significant};
use super::page::Section;
use super::rig_page::RigPage;

pub(super) fn section(page: &RigPage) -> Option<Section> {
    let registration = page.rig.channel_registration.as_ref()?;
    let from = match registration.from {
        RegistrationSource::Checker => "the corners of the projected checkerboard",
        RegistrationSource::Stripes => "projected stripes",
    };
    let content = html! {
        p {
            "The red, the green and the blue picture of a projector do not lie exactly on each other, and camera lenses show the three \
             colours at slightly different sizes. Against green, which all other numbers on this page belong to, " (from) " show:"
        }
        div.scroll { table {
            thead { tr {
                th scope="col" { "Colour" } th.number scope="col" { "Right, px of the panel" } th.number scope="col" { "Down, px of the panel" }
                th.number scope="col" { "Camera's magnification" } th.number scope="col" { "Projector's magnification" }
            } }
            tbody { (row("Red", "red", registration)) (row("Blue", "blue", registration)) }
        } }
        p.note {
            "A magnification of 0.0003 puts the colour a third of a pixel further out at 1000 px from the centre. One sheet hardly tells the \
             camera's from the projector's: their sum is known better than either. Decoding corrects stripes by this, so that stripes \
             of all hues lie on one surface. ± is one standard deviation."
        }
    };
    Some(Section { id: "channels", title: "Colour channels", content })
}

fn row(title: &str, color: &str, r: &ChannelRegistration) -> Markup {
    let of = |d: &slcal_core::ChannelDisplacements| match color {
        "red" => (d.projector.red, d.camera.red),
        _ => (d.projector.blue, d.camera.blue),
    };
    let ((projector, camera), (of_projector, of_camera)) = (of(&r.displacements), of(&r.sigma));
    let number = |path: &str, value: f64, sigma: f64| {
        let at = |part: &str| format!("channel_registration.{part}{path}");
        html! {
            td.number {
                (field(&at(""), value, &fixed(value, decimals_of(sigma)))) " ± " (field(&at("sigma."), sigma, &significant(sigma, 2)))
            }
        }
    };
    let shift = |k: usize| {
        number(&format!("projector.{color}.shift_px.{k}"), projector.shift_px[k], of_projector.shift_px[k])
    };
    html! {
        tr {
            th scope="row" { (title) } (shift(0)) (shift(1))
            (number(&format!("camera.{color}.radial"), camera.radial, of_camera.radial))
            (number(&format!("projector.{color}.scale"), projector.scale, of_projector.scale))
        }
    }
}
