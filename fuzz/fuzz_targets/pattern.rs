//! A pattern's JSON: read, written and read again it is the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{read_pattern, write_pattern};

fuzz_target!(|data: &[u8]| {
    let Ok(read) = read_pattern(data) else { return };
    let mut written = Vec::new();
    // What is not finite is refused.
    if write_pattern(&read, &mut written).is_ok() {
        let again = read_pattern(written.as_slice()).expect("what was written is read");
        let mut twice = Vec::new();
        write_pattern(&again, &mut twice).expect("what was read is written");
        assert!(written == twice, "written twice, it differs");
    }
});
