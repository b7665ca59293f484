//! Pictures drawn so that they appear upright on the sheet: [`rectify`](super::rectify()) and the drawing in one call.

use image::RgbImage;
use image::imageops::flip_horizontal;
use nalgebra::Point2;

use super::{Rectification, rectify, rectify_checker};
use crate::error::{ErrorSubject, Result};
use crate::pattern::{CheckerPattern, warp_image};
use crate::rig::Rig;

/// What to project so that a picture appears upright and as large as possible on the sheet of a view, and where it lies
/// there; black around it. The result has the panel's size.
///
/// # Errors
/// As [`rectify`]; [`Error::Invalid`](crate::Error::Invalid) for a picture without pixels or wider than 16384 px.
pub fn rectify_picture(rig: &Rig, view: usize, picture: &RgbImage) -> Result<(RgbImage, Rectification)> {
    let (w, h) = (f64::from(picture.width()), f64::from(picture.height()));
    let place = rectify(rig, view, Point2::new(-0.5, -0.5), Point2::new(w - 0.5, h - 0.5))?;
    let panel = rig.require_projector()?.device.model.size();
    let drawn = warp_image(picture, panel, &place.panel_from_source, [0; 3])?;
    Ok((to_project(drawn, rig), place))
}

/// The picture that makes a panel look so: mirrored where the projector mirrors it once more.
fn to_project(panel: RgbImage, rig: &Rig) -> RgbImage {
    if rig.is_mirrored() { flip_horizontal(&panel) } else { panel }
}

/// What to project so that a checkerboard appears upright and as large as possible on the sheet of a view, its edges as
/// sharp as those of the pattern itself, and where it lies there.
///
/// # Errors
/// As [`rectify`]; [`Error::Invalid`](crate::Error::Invalid) for a pattern that was drawn for another panel.
///
/// # Examples
/// ```
/// # let checker = slcal_core::CheckerPattern::new([1024, 768], &Default::default())?;
/// # let sheet = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg"))?;
/// # let mut calibrator = slcal_core::Calibrator::new("594x420mm".parse()?).with_pattern(&checker);
/// # calibrator.add(slcal_core::PhotoView::try_from(&sheet)?)?;
/// # let rig = calibrator.calibrate()?.rig;
/// use slcal_core::rectify_checker_picture;
///
/// let (picture, place) = rectify_checker_picture(&rig, 0, &checker)?;
/// assert_eq!(picture.dimensions(), (1024, 768)); // what to project
/// assert!(place.size_mm.width_mm > 100.0); // how large it appears on the sheet
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rectify_checker_picture(
    rig: &Rig,
    view: usize,
    pattern: &CheckerPattern,
) -> Result<(RgbImage, Rectification)> {
    rig.projector_for(ErrorSubject::Checkerboard, pattern.projector)?;
    let place = rectify_checker(rig, view, pattern)?;
    Ok((to_project(pattern.draw_warped(&place.panel_from_source)?, rig), place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::CheckerConfig;
    use crate::simulate::{PoseConfig, RigConfig, Scene};

    fn rig() -> Rig {
        Scene::new(&RigConfig::default(), &[PoseConfig::tilted(25.0, 28.0)]).unwrap().rig()
    }

    #[test]
    fn a_picture_is_drawn_where_its_place_says() {
        let rig = rig();
        // Left half red, right half blue, with a white dot that marks the top.
        let picture = RgbImage::from_fn(80, 60, |x, y| match (x, y) {
            (56..64, 6..14) => image::Rgb([255; 3]),
            (0..40, _) => image::Rgb([255, 0, 0]),
            _ => image::Rgb([0, 0, 255]),
        });
        let (drawn, place) = rectify_picture(&rig, 0, &picture).unwrap();
        assert_eq!((drawn.width(), drawn.height()), (1024, 768));
        let at = |x: f64, y: f64| {
            let q = place.panel_from_source.map(Point2::new(x, y)).unwrap();
            drawn.get_pixel(q.x.round() as u32, q.y.round() as u32).0
        };
        assert_eq!([at(20.0, 30.0), at(60.0, 40.0)], [[255, 0, 0], [0, 0, 255]]);
        assert_eq!(at(59.5, 9.5), [255; 3]);
        let outside = place.corners_px[0] + (place.corners_px[0] - place.corners_px[2]) * 0.01;
        if outside.x > 0.0 && outside.y > 0.0 {
            assert_eq!(drawn.get_pixel(outside.x as u32, outside.y as u32).0, [0; 3]);
        }
        assert!(rectify_picture(&rig, 1, &picture).is_err());
        assert!(rectify_picture(&rig, 0, &RgbImage::new(0, 4)).is_err());
    }

    #[test]
    fn a_checkerboard_is_drawn_where_it_is_looked_for() {
        let rig = rig();
        let pattern = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
        let (drawn, place) = rectify_checker_picture(&rig, 0, &pattern).unwrap();
        assert_eq!(place, rectify_checker(&rig, 0, &pattern).unwrap());
        let of_square = |i: u32, j: u32| {
            let half = nalgebra::Vector2::repeat(pattern.square_px / 2.0);
            let middle = pattern.inner_corner(i, j) - half;
            let q = place.panel_from_source.map(middle).unwrap();
            drawn.get_pixel(q.x.round() as u32, q.y.round() as u32).0[0]
        };
        for j in 0..7 {
            for i in 0..10 {
                assert_eq!(of_square(i, j), if (i + j) % 2 == 0 { 0 } else { 255 }, "{i} {j}");
            }
        }
        let other = CheckerPattern::new([800, 600], &CheckerConfig::default()).unwrap();
        let error = rectify_checker_picture(&rig, 0, &other).unwrap_err().to_string();
        assert!(error.contains("1024x768") && error.contains("800x600"), "{error}");
        let alone = Rig { projector: None, ..rig };
        assert!(rectify_checker_picture(&alone, 0, &pattern).is_err());
        assert!(rectify_picture(&alone, 0, &drawn).is_err());
    }
}
