//! What all marks of a plot have in common.

use maud::{Markup, html};

use super::frame::Frame;

/// Something drawn in a plot, in the colour of its group.
pub(crate) trait Mark {
    fn draw(&self, frame: &Frame) -> Markup;
}

/// A colour of the page, by what it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Colour {
    Camera,
    Projector,
    Sheet,
    Cloud,
    Noise,
    Ink,
}

impl Colour {
    /// The class that has this colour in the page's style.
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Projector => "projector",
            Self::Sheet => "sheet",
            Self::Cloud => "cloud",
            Self::Noise => "noise",
            Self::Ink => "ink",
        }
    }
}

/// How a legend shows a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Key {
    Line,
    Dashes,
    Bar,
    Vector,
    Cross,
}

impl Key {
    /// The mark beside its name.
    pub(super) fn picture(self, colour: Colour) -> Markup {
        html! {
            svg class={ "key plotted " (colour.class()) } viewBox="0 0 28 16" aria-hidden="true" {
                @match self {
                    Self::Line => path.line d="M2 8H26" {},
                    Self::Dashes => path.line.dashed d="M2 8H26" {},
                    Self::Bar => path.area d="M8 2h12v12h-12z" {},
                    Self::Vector => { path.area d="M3 8a2.2 2.2 0 1 0 4.4 0a2.2 2.2 0 1 0-4.4 0" {} path.line d="M5 8H25" {} },
                    Self::Cross => path.line d="M10 4l8 8M18 4l-8 8" {},
                }
            }
        }
    }
}
