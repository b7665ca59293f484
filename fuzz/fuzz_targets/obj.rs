//! A cloud as OBJ.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::read_obj;

fuzz_target!(|data: &[u8]| {
    if let Ok(cloud) = read_obj(data) {
        let points = cloud.points.len();
        assert!(cloud.triangles.iter().flatten().all(|&i| (i as usize) < points), "a face of points that are not there");
    }
});
