//! Files of photographs, of every format that is read: what is decoded is a picture that can be looked at.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_cli::files::{decode_photo, read_tags};
use slcal_core::photo::PhotoView;

fuzz_target!(|data: &[u8]| {
    let _ = read_tags(data);
    if let Ok(decoded) = decode_photo(data, "x", false) {
        let view = PhotoView::try_from(&decoded.photo).expect("a photograph");
        assert!(view.width() > 0 && view.height() > 0);
    }
});
