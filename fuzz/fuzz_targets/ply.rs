//! A cloud as PLY, text or binary: read, written and read again it is the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{read_ply, write_ply};

fuzz_target!(|data: &[u8]| {
    let Ok(read) = read_ply(data) else { return };
    // Files have 32-bit coordinates; what lies beyond them is infinite there, and left out on reading.
    if read.points.iter().any(|p| p.position.iter().any(|x| x.abs() > f64::from(f32::MAX))) {
        return;
    }
    let mut written = Vec::new();
    // What is not finite is refused.
    if write_ply(&read, &mut written).is_ok() {
        let again = read_ply(written.as_slice()).expect("what was written is read");
        let mut twice = Vec::new();
        write_ply(&again, &mut twice).expect("what was read is written");
        assert!(written == twice, "written twice, it differs");
    }
});
