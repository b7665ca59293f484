//! Data that the page carries for its script.

use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

/// A value as JSON that cannot end its element.
pub(super) fn json(id: &str, value: &impl Serialize) -> Markup {
    let text = serde_json::to_string(value).unwrap_or_else(|_| "{}".to_owned()).replace('<', "\\u003c");
    html! { script type="application/json" id=(id) { (PreEscaped(text)) } }
}

/// Bytes, compressed (zlib) and as base64.
pub(super) fn bytes(id: &str, bytes: &[u8]) -> Markup {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing into memory does not fail; the view of no bytes shows the scene alone.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    html! { script type="application/octet-stream;base64" data-compressed="deflate" id=(id) { (STANDARD.encode(packed)) } }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    #[test]
    fn json_cannot_end_the_script_that_holds_it() {
        let text = json("id", &"</script><!-- <script>alert(1)").into_string();
        assert_eq!(text.matches('<').count(), 2);
    }

    #[test]
    fn bytes_come_back() {
        let all: Vec<u8> = (0..=255).cycle().take(10_000).collect();
        let text = bytes("id", &all).into_string();
        let packed = STANDARD.decode(text.split('>').nth(1).unwrap().split('<').next().unwrap()).unwrap();
        let mut back = Vec::new();
        flate2::read::ZlibDecoder::new(packed.as_slice()).read_to_end(&mut back).unwrap();
        assert_eq!(back, all);
    }
}
