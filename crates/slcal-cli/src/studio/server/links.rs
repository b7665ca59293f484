//! The addresses of the pages, with their tokens.

use qrcode::QrCode;
use qrcode::render::{svg, unicode};
use serde::Serialize;

use super::access::{Access, Role};

/// Addresses to open. They contain secrets: only the operator is told them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(in crate::studio) struct Links {
    #[serde(skip)]
    pub(in crate::studio) operator: String,
    /// The operator's page for other machines, where they are let in.
    pub(in crate::studio) operator_elsewhere: Option<String>,
    pub(in crate::studio) display: String,
    /// For phones, where others of the network are let in.
    pub(in crate::studio) camera: Option<String>,
    pub(in crate::studio) watcher: String,
    /// The camera's address as a picture.
    camera_qr: Option<String>,
}

impl Links {
    /// `here` is host and port on this machine, `lan` those for others.
    pub(in crate::studio) fn new(access: &Access, here: &str, lan: Option<&str>) -> Self {
        let address = |host: &str, path: &str, role| format!("http://{host}/{path}#{}", access.token(role));
        let camera = lan.map(|host| address(host, "camera", Role::Camera));
        let camera_qr = camera
            .as_deref()
            .and_then(|url| QrCode::new(url).ok())
            .map(|code| code.render::<svg::Color<'_>>().min_dimensions(200, 200).quiet_zone(true).build());
        Self {
            operator: address(here, "", Role::Operator),
            operator_elsewhere: lan.map(|host| address(host, "", Role::Operator)),
            display: address(here, "display", Role::Display),
            watcher: address(lan.unwrap_or(here), "", Role::Watcher),
            camera,
            camera_qr,
        }
    }

    /// The camera's address for a terminal.
    pub(in crate::studio) fn qr_text(&self) -> Option<String> {
        let code = QrCode::new(self.camera.as_deref()?).ok()?;
        Some(code.render::<unicode::Dense1x2>().quiet_zone(true).build())
    }
}
