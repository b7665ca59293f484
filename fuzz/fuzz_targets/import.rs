//! A rig from files of other programs: the first byte is the number of the format (or another one, where the content tells), a form feed separates files.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{ExchangeFormat, ExportConfig, ImportConfig, NamedBytes, export_rig, import_rig};

const NAMES: [&str; 3] = ["cameras.txt", "images.txt", "points3D.txt"];

fuzz_target!(|data: &[u8]| {
    let Some((&choice, rest)) = data.split_first() else { return };
    let format = ExchangeFormat::ALL.get(usize::from(choice.wrapping_sub(b'0'))).copied();
    // Binary files may hold any byte.
    let most = if rest.starts_with(b"PK") { 1 } else { NAMES.len() };
    let parts = rest.splitn(most, |byte| *byte == 0x0c);
    let files: Vec<NamedBytes<'_>> = NAMES.iter().zip(parts).map(|(name, bytes)| NamedBytes { name, bytes }).collect();
    let config = ImportConfig { camera_size: Some([640, 480]), ..ImportConfig::default() };
    if let Ok(imported) = import_rig(format, &files, &config) {
        // A rig that was read is written, or refused with a reason.
        for format in ExchangeFormat::ALL {
            let _ = export_rig(&imported.rig, format, &ExportConfig::default());
        }
    }
});
