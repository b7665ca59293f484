//! The next best view.

use slcal_core::advise::{Advice, Predicted, TiltPrediction};

use crate::output::{BOLD, GOOD, Table, TextLayout, styled, unbroken};

/// Per cent with two significant digits.
fn percent(share: f64) -> String {
    let p = 100.0 * share;
    match p {
        p if p >= 1000.0 => ">1000".into(),
        p if p >= 10.0 => format!("{p:.0}"),
        p if p > 0.0 => format!("{p:.*}", (1.0 - p.log10().floor()).clamp(1.0, 4.0) as usize),
        _ => "0".into(),
    }
}

fn predicted(p: &Predicted) -> String {
    let mut parts = vec![format!("camera {} %", percent(p.camera_focal))];
    parts.extend(p.projector_focal.map(|f| format!("projector {} %", percent(f))));
    parts.extend(p.projector_cy_px.map(|cy| format!("its cy {cy:.1} px")));
    let point = p.point_mm.map(|mm| format!("; {}", unbroken(&format!("a point at the sheet {mm:.2} mm"))));
    parts.iter().map(|part| unbroken(part)).collect::<Vec<_>>().join(", ") + &point.unwrap_or_default()
}

/// The uncertainty now, what each tilt would bring, and the pose to photograph next.
pub(crate) fn advice(advice: &Advice) -> String {
    let mut layout = TextLayout::new();
    layout.paragraph(format!(
        "Predicted σ (one standard deviation) of the focal lengths, per cent; the sheet of {:.0} x {:.0} mm {}",
        advice.size.width_mm,
        advice.size.height_mm,
        unbroken(&format!("{:.0} mm from the camera", advice.distance_mm))
    ));
    if let Some(now) = &advice.now {
        layout.line("now", predicted(now));
    }
    let with_projector = advice.table.iter().filter_map(|t| t.one).any(|p| p.projector_focal.is_some());
    let tables: &[(&str, Prediction)] = if advice.now.is_some() {
        &[("after one more photograph", |t| t.one)]
    } else {
        &[("after one photograph", |t| t.one), ("after two, the second with the tilt reversed", |t| t.pair)]
    };
    for (title, of) in tables {
        table(&mut layout, advice, &format!("camera, {title}"), |t| Some(of(t)?.camera_focal));
        if with_projector {
            table(&mut layout, advice, &format!("projector, {title}"), |t| of(t)?.projector_focal);
        }
    }
    layout.gap();
    layout.paragraph(
        "Across: tilt about the vertical axis, + with the right side nearer to the camera than the left. Down: about the horizontal \
         axis, + with the top side nearer than the bottom. Sides are as the photograph shows them. - : the sheet would leave the \
         frame, the pattern would leave the sheet, or the view would be too flat.",
    );
    layout.gap();
    next(&mut layout, advice);
    layout.into_text()
}

/// What is predicted: one more photograph, or two.
type Prediction = fn(&TiltPrediction) -> Option<Predicted>;

fn table(layout: &mut TextLayout, advice: &Advice, title: &str, of: impl Fn(&TiltPrediction) -> Option<f64>) {
    let Some(first) = advice.table.first() else { return };
    layout.gap();
    layout.paragraph(styled(BOLD, &unbroken(title)));
    let columns = advice.table.iter().take_while(|t| t.tilt_x_rad == first.tilt_x_rad).count().max(1);
    let degrees = |rad: f64| format!("{:+.0}°", rad.to_degrees());
    let heads = advice.table[..columns].iter().map(|t| format!(">{}", degrees(t.tilt_y_rad)));
    let heads: Vec<String> = std::iter::once(String::new()).chain(heads).collect();
    let mut table = Table::new(heads.iter().map(String::as_str)).tight();
    for row in advice.table.chunks(columns) {
        let cells = row.iter().map(|t| of(t).map_or("-".to_owned(), percent));
        table.row(row.first().map(|t| degrees(t.tilt_x_rad)).into_iter().chain(cells));
    }
    layout.table(&table);
}

fn next(layout: &mut TextLayout, advice: &Advice) {
    let Some(next) = &advice.next else {
        return layout.line(
            "next",
            "no pose is possible: the sheet does not fit into the frame at this distance, or the pattern does not fit onto the \
             sheet; move the sheet further away or make the pattern smaller",
        );
    };
    let (words, after) = (next.in_words(advice.size), predicted(&next.after));
    match &advice.now {
        None => {
            layout.line("next", format!("{words}; then photograph it again with both tilts reversed"));
            layout.line("after both", after);
        }
        Some(_) if advice.worth_it => {
            layout.line("next", words);
            layout.line("after it", after);
        }
        Some(_) => {
            layout.line(
                "next",
                format!(
                    "{}: the best pose would bring {after}",
                    styled(GOOD, "no further photograph is worth it")
                ),
            );
            layout.line("", format!("({words})"));
        }
    }
}
