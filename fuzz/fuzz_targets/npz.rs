//! An NPZ archive with right lengths and checksums, whose arrays are the data: each begins with a byte that names it and two that
//! say how long it is.
#![no_main]

use libfuzzer_sys::fuzz_target;
use slcal_core::format::{ExchangeFormat, ImportConfig, NamedBytes, import_rig, read_dense_matches};

const NAMES: [&str; 25] = [
    "camera_K", "camera_dist", "camera_size", "camera_sigma", "projector_K", "projector_dist", "projector_size", "R", "t",
    "view_photo", "view_size_mm", "camera_from_sheet_R", "warnings", "covariance", "covariance_parameters", "projector_mirrored",
    "u", "v", "projector_column", "projector_row", "sigma_column_px", "sigma_row_px", "confidence", "color", "image_size",
];

fuzz_target!(|data: &[u8]| {
    let mut archive = Archive::default();
    let mut rest = data;
    while let [name, high, low, behind @ ..] = rest {
        let length = usize::from(u16::from_be_bytes([*high, *low])).min(behind.len());
        let (array, next) = behind.split_at(length);
        archive.add(&format!("{}.npy", NAMES[usize::from(*name) % NAMES.len()]), array);
        rest = next;
    }
    let bytes = archive.finish();
    let files = [NamedBytes { name: "rig.npz", bytes: &bytes }];
    if let Ok(matches) = read_dense_matches(&bytes) {
        assert!(matches.known() <= matches.width * matches.height);
    }
    let _ = import_rig(Some(ExchangeFormat::Npz), &files, &ImportConfig::default());
});

/// A ZIP archive of stored entries.
#[derive(Default)]
struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    entries: u16,
}

impl Archive {
    fn add(&mut self, name: &str, content: &[u8]) {
        let place = self.bytes.len() as u32;
        let length = (content.len() as u32).to_le_bytes();
        // Version, flags, method, time, date; checksum, both lengths, length of the name, no extra field.
        let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0];
        head.extend(crc32(content).to_le_bytes());
        head.extend([length, length].concat());
        head.extend((name.len() as u16).to_le_bytes());
        head.extend([0, 0]);
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&head);
        self.bytes.extend(name.as_bytes());
        self.bytes.extend(content);
        self.directory.extend(b"PK\x01\x02\x14\x00");
        self.directory.extend(&head);
        // No comment, first disk, no attributes.
        self.directory.extend([0; 10]);
        self.directory.extend(place.to_le_bytes());
        self.directory.extend(name.as_bytes());
        self.entries += 1;
    }

    fn finish(mut self) -> Vec<u8> {
        let place = self.bytes.len() as u32;
        self.bytes.extend(&self.directory);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        self.bytes.extend([self.entries.to_le_bytes(), self.entries.to_le_bytes()].concat());
        self.bytes.extend((self.directory.len() as u32).to_le_bytes());
        self.bytes.extend(place.to_le_bytes());
        self.bytes.extend([0, 0]);
        self.bytes
    }
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
    };
    !bytes.iter().fold(!0, step)
}
