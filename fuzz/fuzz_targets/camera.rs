//! A camera from YAML, XML or JSON of several programs.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::read_camera;

fuzz_target!(|data: &[u8]| {
    if let Ok(known) = read_camera(data) {
        // A camera may be refused for an image, not break.
        let _ = known.for_image([640, 480]);
    }
});
