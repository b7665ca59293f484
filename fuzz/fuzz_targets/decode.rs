//! Photographs of stripes, drawn and then changed by the data: whatever is seen, matches name slits of the pattern.
#![no_main]

mod picture;

use libfuzzer_sys::fuzz_target;
use slcal_core::decode::{DecodeConfig, decode};
use slcal_core::pattern::{Axis, StripeConfig, StripePattern};

fuzz_target!(|data: &[u8]| {
    let Some((&choice, data)) = data.split_first() else { return };
    let axis = if choice & 1 == 0 { Axis::Columns } else { Axis::Rows };
    let config = StripeConfig { hues: 2 + u32::from(choice >> 1) % 3, order: 3, slits: Some(10), axis, ..StripeConfig::default() };
    let Ok(pattern) = StripePattern::new([96, 96], &config) else { return };
    let mut photo = pattern.image().expect("a pattern is drawn");
    picture::edit(&mut photo, data);
    if let Ok(decoding) = decode(picture::view(&photo), &pattern, &DecodeConfig::default()) {
        for m in &decoding.matches.items {
            assert!(m.camera.iter().all(|x| x.is_finite()) && m.sigma_px > 0.0, "{m:?}");
            assert!(m.slit.is_none_or(|slit| usize::from(slit) < pattern.centres_px.len()), "{m:?}");
        }
    }
});
