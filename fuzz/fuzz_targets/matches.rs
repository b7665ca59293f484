//! Matches as CSV: read, written and read again they are the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{read_matches, write_matches};

fuzz_target!(|data: &[u8]| {
    let Ok(read) = read_matches(data) else { return };
    let mut written = Vec::new();
    // What is not finite is refused.
    if write_matches(&read, &mut written).is_ok() {
        let again = read_matches(written.as_slice()).expect("what was written is read");
        let mut twice = Vec::new();
        write_matches(&again, &mut twice).expect("what was read is written");
        assert!(written == twice, "written twice, it differs");
    }
});
