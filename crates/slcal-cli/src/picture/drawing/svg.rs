//! A drawing as SVG text.

use std::fmt::Write as _;

use nalgebra::Point2;

use super::appearance;
use super::canvas::Drawing;
use super::color::Color;
use super::font::{CAPITALS, Font};
use super::path_data::{Number, push_lines};
use super::primitive::{Anchor, Item, Pen, Primitive};

/// Verdana is as wide as DejaVu Sans, where that is missing.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

impl Drawing {
    /// The drawing as an `<svg>` element that stands in an HTML page: as wide as its surroundings, in pixels of the
    /// photograph. `background` is the address (a data URI) of the photograph beneath.
    pub(crate) fn svg(&self, background: Option<&str>) -> String {
        write(self, background)
    }
}

/// Writing into a string cannot fail: what `write!` returns means nothing here.
fn write(drawing: &Drawing, background: Option<&str>) -> String {
    let [w, h] = drawing.size;
    let title = escaped(&drawing.title);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" role=\"img\" aria-label=\"{title}\" \
         style=\"display:block;width:100%;height:auto\"><title>{title}</title>"
    );
    if let Some(address) = background {
        let (color, light, href) = (appearance::COLOR_KEPT, appearance::LIGHT_KEPT, escaped(address));
        let dim = format!(" style=\"filter:saturate({color}) brightness({light})\"");
        let dim = if drawing.dimmed { &*dim } else { "" };
        let _ = write!(
            text,
            "<image preserveAspectRatio=\"none\" width=\"{w}\" height=\"{h}\" href=\"{href}\"{dim}/>"
        );
    }
    // Pixel centres are integers in the drawing, and halves in SVG.
    text.push_str("<g transform=\"translate(.5 .5)\" stroke-linecap=\"round\" stroke-linejoin=\"round\">");
    let font = Font::embedded();
    for item in drawing.all_items() {
        write_item(&mut text, &item, drawing.unit(), &font);
    }
    text.push_str("</g></svg>");
    text
}

fn write_item(text: &mut String, item: &Item, unit: f64, font: &Font) {
    let pen = &item.pen;
    let color = hex(pen.color);
    let opacity = |share: f64| {
        if share < 1.0 { format!(" opacity=\"{}\"", Number(share)) } else { String::new() }
    };
    match &item.primitive {
        Primitive::Text { at, text: words, size, anchor } => {
            write_text(text, (*at, words.as_str(), *size, *anchor), pen, font);
        }
        Primitive::Lines(_) | Primitive::Rings(..) => {
            let path = path(&item.primitive);
            let dash = if pen.dashed { dashes(unit) } else { String::new() };
            let mut stroke = |color: &str, width: f64, share: f64| {
                let (width, opacity) = (Number(width), opacity(share));
                let _ = write!(
                    text,
                    "<path fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{opacity}{dash} d=\"{path}\"/>"
                );
            };
            if pen.halo {
                stroke("#000", appearance::halo_width(pen, unit), appearance::HALO_OPACITY * pen.opacity);
            }
            stroke(&color, pen.width * unit, pen.opacity);
        }
        Primitive::Areas(_) | Primitive::Dots(..) => {
            let path = path(&item.primitive);
            if pen.halo {
                let (width, opacity) =
                    (Number(appearance::HALO * unit), opacity(appearance::HALO_OPACITY * pen.opacity));
                let _ =
                    write!(text, "<path stroke=\"#000\" stroke-width=\"{width}\"{opacity} d=\"{path}\"/>");
            }
            let _ = write!(text, "<path fill=\"{color}\"{} d=\"{path}\"/>", opacity(pen.opacity));
        }
    }
}

fn write_text(
    text: &mut String,
    (at, words, size, anchor): (Point2<f64>, &str, f64, Anchor),
    pen: &Pen,
    font: &Font,
) {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let halo = if pen.halo {
        format!(
            " stroke=\"#000\" stroke-opacity=\"{}\" stroke-width=\"{}\" paint-order=\"stroke\"",
            Number(appearance::TEXT_HALO_OPACITY),
            Number(appearance::TEXT_HALO * size)
        )
    } else {
        String::new()
    };
    // With another font of the browser's, too, the panel of the legend holds its words.
    let length = if font.has(words) && words.chars().count() > 1 {
        format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", Number(font.width(words, size)))
    } else {
        String::new()
    };
    let _ = write!(
        text,
        "<text x=\"{}\" y=\"{}\" font-family=\"{FAMILY}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"{halo}{length}>{}</text>",
        Number(at.x),
        Number(at.y + 0.5 * CAPITALS * size),
        Number(size),
        hex(pen.color),
        escaped(words)
    );
}

fn path(primitive: &Primitive) -> String {
    let mut d = String::new();
    let mut parts = |parts: &[Vec<Point2<f64>>], end: &str| {
        for part in parts {
            push_lines(&mut d, part.iter().map(|p| [p.x, p.y]));
            d.push_str(end);
        }
    };
    match primitive {
        Primitive::Lines(lines) => parts(lines, ""),
        Primitive::Areas(areas) => parts(areas, "z"),
        Primitive::Dots(centres, radius) | Primitive::Rings(centres, radius) => {
            let r = Number(*radius);
            for c in centres {
                let (x, y, wide) = (Number(c.x - radius), Number(c.y), Number(2.0 * radius));
                let _ = write!(d, "M{x} {y}a{r} {r} 0 1 0 {wide} 0a{r} {r} 0 1 0-{wide} 0");
            }
        }
        Primitive::Text { .. } => {}
    }
    d
}

fn dashes(unit: f64) -> String {
    let [on, off] = appearance::DASHES.map(|d| Number(d * unit));
    format!(" stroke-dasharray=\"{on} {off}\"")
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text that stands in an element or an attribute as it is; control characters, which XML cannot hold, are left out.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            c if c.is_control() => safe.push(' '),
            '\u{fffe}' | '\u{ffff}' => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::picture::drawing::color::{ORANGE, WHITE};
    use crate::picture::drawing::legend::Legend;

    const NASTY: &str = "<b onload=\"x('y')\"> & Größe \u{1}\u{7f} 写真 \u{ffff}]]>.jpg";

    fn drawn() -> Drawing {
        let mut drawing = Drawing::new([640, 480], NASTY);
        drawing.dots([Point2::new(10.25, 20.5)], 2.0, Pen::new(ORANGE).plain());
        drawing.polyline(&[Point2::new(1.0, 2.0), Point2::new(3.123_456, 4.0)], Pen::new(WHITE).dashed());
        drawing.label(Point2::new(100.0, 100.0), NASTY, 1.0, Anchor::End, WHITE);
        drawing.legend = Some(Legend::new(NASTY));
        drawing
    }

    #[test]
    fn any_text_is_only_text() {
        let text = drawn().svg(Some("data:image/png;base64,AA\"><script>"));
        let page = Document::parse(&text).unwrap();
        let names: std::collections::BTreeSet<_> =
            page.descendants().filter(roxmltree::Node::is_element).map(|n| n.tag_name().name()).collect();
        assert_eq!(names.into_iter().collect::<Vec<_>>(), ["g", "image", "path", "svg", "text", "title"]);
        let safe = "<b onload=\"x('y')\"> & Größe    写真  ]]>.jpg";
        assert_eq!(page.root_element().attribute("aria-label"), Some(safe));
        let words: Vec<_> =
            page.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
        assert_eq!(words[0], safe);
        // Nothing to collide with, to run or to fetch.
        assert!(
            page.descendants()
                .all(|n| n.attributes().all(|a| a.name() != "id" && !a.name().starts_with("on")))
        );
        assert_eq!(text.matches("href").count(), 1);
    }

    #[test]
    fn coordinates_are_the_photographs() {
        let text = drawn().svg(None);
        let page = Document::parse(&text).unwrap();
        assert_eq!(page.root_element().attribute("viewBox"), Some("0 0 640 480"));
        let group = page.descendants().find(|n| n.has_tag_name("g")).unwrap();
        assert_eq!(group.attribute("transform"), Some("translate(.5 .5)"));
        let path = |color: &str| {
            let of = |n: &roxmltree::Node| {
                n.attribute("fill") == Some(color) || n.attribute("stroke") == Some(color)
            };
            page.descendants().filter(|n| n.has_tag_name("path")).find(of).unwrap().attribute("d").unwrap()
        };
        // A radius of two units of 0.75 px.
        assert_eq!(path("#e69f00"), "M8.75 20.5a1.5 1.5 0 1 0 3 0a1.5 1.5 0 1 0-3 0");
        assert_eq!(path("#ffffff"), "M1 2L3.12 4");
    }
}
