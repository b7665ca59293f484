//! Observations' JSON: read, written and read again they are the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{read_observations, write_observations};

fuzz_target!(|data: &[u8]| {
    let Ok(read) = read_observations(data) else { return };
    let mut written = Vec::new();
    // What is not finite is refused.
    if write_observations(&read, &mut written).is_ok() {
        let again = read_observations(written.as_slice()).expect("what was written is read");
        let mut twice = Vec::new();
        write_observations(&again, &mut twice).expect("what was read is written");
        assert!(written == twice, "written twice, it differs");
    }
});
