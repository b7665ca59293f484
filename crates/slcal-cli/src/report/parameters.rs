//! The parameters with their ±; every number has its exact value in the source of the page.

use maud::{Markup, html};
use slcal_core::{Device, Rig, StereoPose, View};

use super::number::{decimals_of, derived, field, fixed, significant};
use super::page::Section;
use super::rig_page::{RigPage, photo_name};
use crate::summary::working_volume::view_distance_mm;

const COEFFICIENTS: [&str; 5] = ["k1", "k2", "p1", "p2", "k3"];

pub(super) fn section(page: &RigPage) -> Section {
    let rig = page.rig;
    let content = html! {
        div.scroll { table.parameters {
            thead { tr { th scope="col" { "Parameter" } th.number scope="col" { "Value" } th scope="col" { "Unit" } } }
            @for ((name, shown), fy_sigma) in rig.devices().zip(rig.fy_sigmas_px()) {
                (device(name, if name == "camera" { "Camera" } else { "Projector" }, shown, fy_sigma))
            }
            @if let Some(projector) = &rig.projector { (position(rig, &projector.from_camera)) }
        } }
        @if let Some(projector) = &rig.projector { (transform(&projector.from_camera)) }
        @if !rig.views.is_empty() { (poses(rig)) }
        @if rig.projector.is_none() { p.note { "This rig has no projector: it was calibrated without a pattern." } }
        @if rig.views.is_empty() { p.note { "The rig lists no photographs of a sheet." } }
        @if rig.camera.sigma.is_none() { p.note { "The rig states no ± for its numbers." } }
        p.note {
            "± is one standard deviation; “fixed” means assumed, not estimated. Pixel centres have integer coordinates. Method: " (rig.method) "."
        }
    };
    Section { id: "parameters", title: "Parameters", content }
}

fn device(path: &str, title: &str, device: &Device, fy_sigma: Option<f64>) -> Markup {
    let (model, sigma) = (&device.model, &device.sigma);
    let (k, size) = (&model.intrinsics, model.size());
    let at = |field: &str| format!("{path}.{field}");
    let focal = |axis: usize, value: f64| {
        measured(&at(&format!("K.{axis}.{axis}")), value, sigma.map(|s| (at("sigma.focal_px"), s.focal_px)))
    };
    let aspect = sigma.map(|s| s.aspect).filter(|s| *s > 0.0);
    let vertical = || match fy_sigma.filter(|s| *s > 0.0 && aspect.is_some()) {
        Some(s) => html! {
            (field(&at("K.1.1"), k.fy, &fixed(k.fy, decimals_of(s)))) " ± " (derived(&at("fy_sigma_px"), s, &significant(s, 2)))
        },
        None => focal(1, k.fy),
    };
    let percent = |share: Option<f64>| {
        html! { @if let Some(share) = share { span.aside { " (" (significant(share, 2)) " %)" } } }
    };
    let share = sigma.filter(|s| s.focal_px > 0.0).map(|s| 100.0 * s.focal_px / k.fx);
    // From edge to edge, to both sides of the principal point.
    let degrees = |pixels: u32, f: f64, c: f64| {
        (((c + 0.5) / f).atan() + ((f64::from(pixels) - 0.5 - c) / f).atan()).to_degrees()
    };
    let fov = [degrees(size[0], k.fx, k.cx), degrees(size[1], k.fy, k.cy)];
    let d = model.distortion.to_array();
    let distorts = d.iter().chain(sigma.iter().flat_map(|s| &s.distortion)).any(|c| *c != 0.0);
    html! {
        tbody {
            tr.group { th scope="rowgroup" colspan="3" { (title) } }
            (row("Image size", &html! {
                (field(&at("width"), f64::from(size[0]), &size[0].to_string())) " × "
                (field(&at("height"), f64::from(size[1]), &size[1].to_string()))
            }, "px"))
            @if (k.fx - k.fy).abs() <= 1e-9 * k.fx && aspect.is_none() {
                (row("Focal length", &html! { (focal(0, k.fx)) (percent(share)) }, "px"))
            } @else {
                (row("Focal length, horizontal", &html! { (focal(0, k.fx)) (percent(share)) }, "px"))
                (row("Focal length, vertical", &vertical(), "px"))
                @if let Some(s) = aspect {
                    (row("Vertical to horizontal focal length", &html! {
                        (derived(&at("aspect"), k.fy / k.fx, &fixed(k.fy / k.fx, decimals_of(s)))) " ± "
                        (field(&at("sigma.aspect"), s, &significant(s, 2)))
                    }, ""))
                }
            }
            (row("Field of view", &html! {
                (derived(&at("fov_x_deg"), fov[0], &fixed(fov[0], 1))) "° × "
                (derived(&at("fov_y_deg"), fov[1], &fixed(fov[1], 1))) "°"
            }, ""))
            (row("Principal point, x", &measured(&at("K.0.2"), k.cx, sigma.map(|s| (at("sigma.cx_px"), s.cx_px))), "px"))
            (row("Principal point, y", &measured(&at("K.1.2"), k.cy, sigma.map(|s| (at("sigma.cy_px"), s.cy_px))), "px"))
            @if k.skew != 0.0 { (row("Skew", &field(&at("K.0.1"), k.skew, &significant(k.skew, 4)), "px")) }
            @if distorts {
                @for (i, name) in COEFFICIENTS.iter().enumerate() {
                    (row(&format!("Distortion {name}"), &measured(
                        &at(&format!("distortion.{i}")), d[i],
                        sigma.map(|s| (at(&format!("sigma.distortion.{i}")), s.distortion[i])),
                    ), ""))
                }
            } @else {
                (row("Lens distortion", &html! { span.aside { "none assumed" } }, ""))
            }
        }
    }
}

/// Where the projector is, as somebody behind the camera sees it.
fn position(rig: &Rig, stereo: &StereoPose) -> Markup {
    let pose = &stereo.pose;
    let (centre, centre_sigma) = (pose.centre(), rig.projector_centre_sigma_mm());
    let rotation = (pose.rotation.angle().to_degrees(), rig.rotation_sigma_rad().map(f64::to_degrees));
    let sides = [("to the left", "to the right"), ("above", "below"), ("behind", "in front")];
    html! {
        tbody {
            tr.group { th scope="rowgroup" colspan="3" { "Projector relative to the camera" } }
            (row("Baseline: distance of the optical centres", &computed("baseline", pose.translation.norm(), rig.baseline_sigma_mm()), "mm"))
            @for (i, (negative, positive)) in sides.into_iter().enumerate() {
                (row(
                    if centre[i] < 0.0 { negative } else { positive },
                    &computed(["centre_x", "centre_y", "centre_z"][i], centre[i].abs(), centre_sigma.map(|s| s[i])),
                    "mm",
                ))
            }
            (row("Rotation angle", &computed("rotation", rotation.0, rotation.1), "°"))
            @if rig.is_mirrored() {
                (row("Its pictures appear mirrored", &html! { "column c counts as column width − 1 − c" }, ""))
            }
        }
    }
}

/// The transform as programs use it.
fn transform(stereo: &StereoPose) -> Markup {
    html! {
        details {
            summary { "Transform from camera to projector, as in rig.json" }
            p { "X" sub { "projector" } " = R · X" sub { "camera" } " + t; x right, y down, z forward." }
            div.scroll { table.parameters { tbody {
                @for i in 0..3 {
                    (row(["t, x", "t, y", "t, z"][i], &measured(
                        &format!("projector_from_camera.t.{i}"), stereo.pose.translation[i],
                        stereo.sigma_t_mm.map(|s| (format!("projector_from_camera.sigma_t_mm.{i}"), s[i])),
                    ), "mm"))
                }
                @for i in 0..3 {
                    (row(["R, row 1", "R, row 2", "R, row 3"][i], &html! {
                        @for j in 0..3 {
                            @let r = stereo.pose.rotation[(i, j)];
                            (field(&format!("projector_from_camera.R.{i}.{j}"), r, &fixed(r, 4))) " "
                        }
                    }, ""))
                }
            } } }
        }
    }
}

/// A row for the sheet in each photograph.
fn poses(rig: &Rig) -> Markup {
    let bent = rig.views.iter().any(|v| v.bend.is_some());
    html! {
        h3 { "The sheet" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "Photograph" } th.number scope="col" { "given size, mm" } th.number scope="col" { "distance, mm" }
                th.number scope="col" { "tilt, °" }
                @if bent { th.number scope="col" { "bend, mm" } }
            } }
            tbody { @for (i, view) in rig.views.iter().enumerate() { (pose(rig, i, view, bent)) } }
        } }
    }
}

fn pose(rig: &Rig, i: usize, view: &View, bent: bool) -> Markup {
    let at = |field: &str| format!("views.{i}.{field}");
    let distance = view_distance_mm(view);
    let tilt = rig.tilt_rad(i).map(f64::to_degrees);
    html! { tr {
        th.file scope="row" { (photo_name(rig, i)) }
        td.number {
            (field(&at("size_mm.0"), view.size.width_mm, &fixed(view.size.width_mm, 1))) " × "
            (field(&at("size_mm.1"), view.size.height_mm, &fixed(view.size.height_mm, 1)))
        }
        td.number { (derived(&at("distance_mm"), distance, &fixed(distance, 0))) }
        td.number { @if let Some(tilt) = tilt { (derived(&at("tilt_deg"), tilt, &fixed(tilt, 1))) } }
        @if bent { td.number { @if let Some(sag) = rig.sag(i) {
            (field(&at("bend.sag_mm"), sag.sag_mm, &fixed(sag.sag_mm, decimals_of(sag.sigma_mm)))) " ± "
            (derived(&at("bend_sigma_mm"), sag.sigma_mm, &significant(sag.sigma_mm, 2)))
        } } }
    } }
}

/// A value with its σ, each under its own name; "fixed" where it was not estimated.
fn measured(path: &str, value: f64, sigma: Option<(String, f64)>) -> Markup {
    let plain = || field(path, value, &fixed(value, plain_decimals(value)));
    match sigma {
        None => plain(),
        Some((sigma_path, s)) if s > 0.0 => html! {
            (field(path, value, &fixed(value, decimals_of(s)))) " ± " (field(&sigma_path, s, &significant(s, 2)))
        },
        Some((sigma_path, s)) => html! { (plain()) " " (field(&sigma_path, s, "fixed")) },
    }
}

/// A value that is computed from the rig, with its σ where that is known.
fn computed(name: &str, value: f64, sigma: Option<f64>) -> Markup {
    let sigma = sigma.filter(|s| *s > 0.0);
    html! {
        (derived(name, value, &fixed(value, sigma.map_or(1, decimals_of).min(4))))
        @if let Some(s) = sigma { " ± " (derived(&format!("{name}_sigma"), s, &significant(s, 2))) }
    }
}

/// Decimals of a number whose σ nobody knows: five significant digits, at least one decimal.
fn plain_decimals(value: f64) -> usize {
    if value == 0.0 { 1 } else { (4 - value.abs().log10().floor() as i32).clamp(1, 8) as usize }
}

fn row(label: &str, value: &Markup, unit: &str) -> Markup {
    html! { tr { th scope="row" { (label) } td.value { (value) } td.unit { (unit) } } }
}
