//! Whether the display shows pictures pixel for pixel.

use super::state::{Measured, Problem};

/// Widths over heights that differ by less are the same.
const SAME_ASPECT: f64 = 0.01;

/// Code of a page that does not fill the display.
pub(super) const NOT_FULL_SCREEN: &str = "display-not-full-screen";

/// What stands against pixels at 1:1 on a panel of this size; `None` where nothing does.
pub(super) fn check(panel: [u32; 2], measured: Option<&Measured>) -> Option<Problem> {
    let Some(m) = measured else {
        return Some(Problem::new(
            "display-missing",
            "the display window is not open",
            "open the display window and move it to the projector",
        ));
    };
    let shown = |[w, h]: [u32; 2]| format!("{w}x{h}");
    if m.screen != panel {
        let aspect = |[w, h]: [u32; 2]| f64::from(w) / f64::from(h.max(1));
        let scaled = (aspect(m.screen) / aspect(panel) - 1.0).abs() < SAME_ASPECT;
        let message =
            format!("the display has {} pixels, but the projector has {}", shown(m.screen), shown(panel));
        return Some(if scaled {
            let advice = format!(
                "set the zoom of the browser (Ctrl+0) and the scaling of that display to 100 %, and its resolution to {}",
                shown(panel)
            );
            Problem::new("display-scaled", format!("{message}: the pattern would be scaled"), advice)
        } else {
            let advice = format!(
                "move the window to the projector, or set the projector's own resolution {} in the display settings",
                shown(panel)
            );
            Problem::new("display-size", message, advice)
        });
    }
    (!m.fullscreen || m.viewport != panel).then(|| {
        Problem::new(
            NOT_FULL_SCREEN,
            "the display page does not fill the projector's picture",
            "press F in the display window, or double-click in it",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_at_one_to_one_pass() {
        let panel = [1920, 1080];
        let full = Measured { device_pixel_ratio: 1.0, screen: panel, viewport: panel, fullscreen: true };
        let code = |m: Measured| check(panel, Some(&m)).map(|p| p.code);
        assert_eq!(check(panel, None).unwrap().code, "display-missing");
        assert_eq!(code(full), None);
        assert_eq!(code(Measured { device_pixel_ratio: 2.0, ..full }), None);
        assert_eq!(code(Measured { fullscreen: false, ..full }), Some("display-not-full-screen"));
        assert_eq!(code(Measured { viewport: [1920, 969], ..full }), Some("display-not-full-screen"));
        assert_eq!(code(Measured { screen: [2112, 1188], ..full }), Some("display-scaled"));
        assert_eq!(code(Measured { screen: [1280, 1024], ..full }), Some("display-size"));
    }
}
