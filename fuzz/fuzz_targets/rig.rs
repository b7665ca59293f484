//! A rig's JSON: read, written and read again it is the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{read_rig, write_rig};

fuzz_target!(|data: &[u8]| {
    let Ok(read) = read_rig(data) else { return };
    let mut written = Vec::new();
    // What is not finite is refused.
    if write_rig(&read, &mut written).is_ok() {
        let again = read_rig(written.as_slice()).expect("what was written is read");
        let mut twice = Vec::new();
        write_rig(&again, &mut twice).expect("what was read is written");
        assert!(written == twice, "written twice, it differs");
    }
});
