//! Photographs of a sheet under a checkerboard, drawn and then changed by the data: whatever is found is finite.
#![no_main]

mod picture;

use image::{Rgb, RgbImage};
use libfuzzer_sys::fuzz_target;
use slcal_core::detect::{DetectConfig, observe};
use slcal_core::geometry::RectangleSize;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};

const PANEL: [u32; 2] = [160, 120];

fuzz_target!(|data: &[u8]| {
    let config = CheckerConfig { squares: [5, 4], square_px: Some(16.0), ..CheckerConfig::default() };
    let pattern = CheckerPattern::new(PANEL, &config).expect("the board fits");
    let board = pattern.image().expect("a pattern is drawn");
    let mut photo = RgbImage::from_pixel(PANEL[0] + 80, PANEL[1] + 80, Rgb([20, 20, 20]));
    // The sheet ends a little beyond the light.
    for (x, y, pixel) in photo.enumerate_pixels_mut() {
        if (20..PANEL[0] + 60).contains(&x) && (20..PANEL[1] + 60).contains(&y) {
            let light = x.checked_sub(40).zip(y.checked_sub(40)).and_then(|(x, y)| board.get_pixel_checked(x, y));
            *pixel = light.map_or(Rgb([70; 3]), |Rgb(light)| Rgb(light.map(|v| 70 + v / 2)));
        }
    }
    picture::edit(&mut photo, data);
    let size = RectangleSize::new(594.0, 420.0).expect("a size");
    if let Ok(found) = observe(picture::view(&photo), None, size, Some(&pattern), &DetectConfig::default()) {
        assert!(found.observation.pairs.iter().all(|p| p.camera.iter().all(|x| x.is_finite())));
    }
});
