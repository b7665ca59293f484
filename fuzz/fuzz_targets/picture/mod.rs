//! Small pictures that a fuzzer can change.

use image::{Rgb, RgbImage};
use slcal_core::photo::{Layout, PhotoView, Samples};

pub fn view(picture: &RgbImage) -> PhotoView<'_> {
    let [width, height] = [picture.width(), picture.height()].map(|n| n as usize);
    PhotoView::new(Samples::U8(picture.as_raw()), width, height, 3 * width, Layout::Rgb).expect("a whole picture")
}

/// Changes a picture by the bytes: each six are a place, a size and what to do there.
pub fn edit(picture: &mut RgbImage, data: &[u8]) {
    let (width, height) = picture.dimensions();
    for step in data.as_chunks::<6>().0 {
        let [x, y, size, kind, a, b] = step.map(u32::from);
        let (left, top) = (x * width / 256, y * height / 256);
        let (right, bottom) = (left + 1 + (size & 15) * width / 16, top + 1 + (size >> 4) * height / 16);
        for y in top..bottom.min(height) {
            for x in left..right.min(width) {
                let Rgb(old) = *picture.get_pixel(x, y);
                picture.put_pixel(x, y, Rgb(changed(old, [kind, a, b], x, y)));
            }
        }
    }
}

fn changed(old: [u8; 3], [kind, a, b]: [u32; 3], x: u32, y: u32) -> [u8; 3] {
    let (low, high) = (a as u8, b as u8);
    match kind % 6 {
        0 => [low, high, low ^ high],
        1 => old.map(|v| v.saturating_add(low)),
        2 => old.map(|v| v.saturating_sub(low)),
        3 => old.map(|v| !v),
        4 => [old[1], old[2], old[0]],
        // Noise that depends on nothing but the place.
        _ => old.map(|v| v.wrapping_add(((x * 31 + y * 17 + a) * (b | 1) % 64) as u8)),
    }
}
