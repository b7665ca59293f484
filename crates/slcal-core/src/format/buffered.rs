//! Writing through a buffer.

use std::io::{BufWriter, Write};

use crate::error::{Error, ErrorSubject, Result};

/// Calls `write` with a buffer before `output` and flushes it.
pub(super) fn buffered<W: Write>(
    what: ErrorSubject,
    output: W,
    write: impl FnOnce(&mut BufWriter<W>) -> std::io::Result<()>,
) -> Result<()> {
    let mut out = BufWriter::new(output);
    write(&mut out).and_then(|()| out.flush()).map_err(|e| Error::writing(what, e))
}
