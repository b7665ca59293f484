//! What a cloud's file does not tell: the calibration it was made with, and what was noticed.

use serde::{Deserialize, Serialize};
use slcal_core::Warning;

const SCHEMA: &str = "slcal-studio-cloud/1";

/// Kept beside a cloud, under its name with `.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct CloudNote {
    schema: String,
    /// [`fingerprint`] of the rig's file.
    pub(super) rig: String,
    pub(super) warnings: Vec<Warning>,
}

impl CloudNote {
    pub(super) fn new(rig: &str, warnings: Vec<Warning>) -> Self {
        Self { schema: SCHEMA.into(), rig: rig.to_owned(), warnings }
    }

    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        serde_json::from_slice(bytes).ok().filter(|note: &Self| note.schema == SCHEMA)
    }
}

/// A short text that differs where the files of two rigs do (FNV-1a, 64 bits).
pub(super) fn fingerprint(rig_file: &[u8]) -> String {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", rig_file.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingerprints_are_those_of_fnv_1a() {
        // Test vectors of the algorithm's authors.
        assert_eq!(fingerprint(b""), "cbf29ce484222325");
        assert_eq!(fingerprint(b"a"), "af63dc4c8601ec8c");
        assert_eq!(fingerprint(b"foobar"), "85944171f73967e8");
    }

    #[test]
    fn notes_of_something_else_are_not_read() {
        let note = CloudNote::new("1", Vec::new());
        let bytes = serde_json::to_vec(&note).unwrap();
        assert_eq!(CloudNote::read(&bytes), Some(note));
        assert_eq!(CloudNote::read(br#"{"schema":"other/1","rig":"1","warnings":[]}"#), None);
        assert_eq!(CloudNote::read(b"{"), None);
    }
}
