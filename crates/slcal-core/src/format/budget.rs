//! What reading an input may cost: memory is earned by the bytes of the input, and spent on the values that are kept of it.

use std::cell::Cell;
use std::io::{self, Read};

use crate::error::{Error, ErrorSubject, Result};

/// Memory for any input, bytes: 64 MB less what a process takes by itself.
const START: u64 = 48_000_000;
/// Memory for every byte of an input, bytes: 20 less the input itself, of which two copies exist at times, and what allocators add.
const PER_BYTE: u64 = 16;
/// What is earned by declared sizes, which cost a file nothing, bytes in all.
const MOST_DECLARED: u64 = 256_000_000;
/// Memory that an allocation takes beside its content, bytes.
const ALLOCATION: usize = 16;
/// Room that a list begins with.
const FIRST_ROOM: usize = 4;
/// Memory of an object of JSON with up to [`NAMES_IN_ONE`] names, bytes: one node of a B-tree.
const NODE_MEMORY: usize = 640;
const NAMES_IN_ONE: usize = 11;
/// Memory of every further name, bytes: nodes are half full at least.
const NAME_MEMORY: usize = 128;
/// A longer line of text, bytes, means that the file is another one.
pub(in crate::format) const LONGEST_LINE: usize = 1 << 20;
/// Maximum nesting of values; a rig needs six levels.
pub(in crate::format) const DEEPEST: usize = 32;

/// The memory that reading one input may take.
#[derive(Debug)]
pub(in crate::format) struct Budget {
    what: ErrorSubject,
    read: Cell<u64>,
    declared: Cell<u64>,
    kept: Cell<u64>,
}

impl Budget {
    /// For an input of this many bytes.
    pub(in crate::format) fn new(what: ErrorSubject, bytes: usize) -> Self {
        Self { what, read: Cell::new(bytes as u64), declared: Cell::new(0), kept: Cell::new(0) }
    }

    /// For a stream, which earns as it is read.
    pub(in crate::format) fn of_stream(what: ErrorSubject) -> Self {
        Self::new(what, 0)
    }

    /// Adds the declared size of compressed data, which is then unpacked.
    #[cfg(feature = "npz")]
    pub(in crate::format) fn unpack(&self, bytes: u64) -> Result<()> {
        let declared = self.declared.get().saturating_add(bytes);
        self.declared.set(declared);
        if declared <= MOST_DECLARED {
            return Ok(());
        }
        let (most, found) = (MOST_DECLARED / 1_000_000, declared / 1_000_000);
        Err(Error::malformed(
            self.what,
            format!(
                "expected at most {most} MB when it is unpacked, found {found} MB; is it the right file?"
            ),
        ))
    }

    /// Spends memory, bytes.
    pub(in crate::format) fn keep(&self, bytes: usize) -> Result<()> {
        self.kept.set(self.kept.get().saturating_add(bytes as u64));
        if self.kept.get() <= self.earned() { Ok(()) } else { Err(self.spent()) }
    }

    /// The error when nothing is left.
    pub(in crate::format) fn spent(&self) -> Error {
        Error::malformed(
            self.what,
            format!(
                "expected values that take at most {} MB of memory, and {PER_BYTE} bytes for each byte of the file, found more; \
                 is it the right file?",
                START / 1_000_000
            ),
        )
    }

    /// The memory that is left, bytes.
    #[cfg(feature = "exchange")]
    pub(in crate::format) fn left(&self) -> u64 {
        self.earned().saturating_sub(self.kept.get())
    }

    /// Spends the memory of a list.
    pub(in crate::format) fn keep_list<T>(&self, count: usize) -> Result<()> {
        self.keep(count.saturating_mul(size_of::<T>()))
    }

    /// Spends the memory of one more value in a list of `length`.
    pub(in crate::format) fn push<T>(&self, length: usize) -> Result<()> {
        match length {
            0 => self.keep(ALLOCATION + FIRST_ROOM * size_of::<T>()),
            1..FIRST_ROOM => Ok(()),
            _ => self.keep(size_of::<T>()),
        }
    }

    /// Spends the memory of one more name in an object of JSON that has `length`.
    pub(in crate::format) fn push_name(&self, length: usize) -> Result<()> {
        match length {
            0 => self.keep(NODE_MEMORY),
            1..NAMES_IN_ONE => Ok(()),
            _ => self.keep(NAME_MEMORY),
        }
    }

    /// Spends the memory of a copy of a text.
    pub(in crate::format) fn keep_text(&self, text: &str) -> Result<()> {
        if text.is_empty() { Ok(()) } else { self.keep(ALLOCATION + text.len().max(ALLOCATION)) }
    }

    fn earned(&self) -> u64 {
        let by_declaration = self.declared.get().saturating_mul(PER_BYTE).min(MOST_DECLARED);
        START + self.read.get().saturating_mul(PER_BYTE).max(by_declaration)
    }
}

/// A stream that earns what is read of it, and may refuse lines that are too long.
pub(in crate::format) struct Metered<'b, R> {
    inner: R,
    budget: &'b Budget,
    longest_line: usize,
    /// Bytes since the last end of a line.
    line: usize,
}

impl<'b, R: Read> Metered<'b, R> {
    /// A stream of any bytes.
    pub(in crate::format) fn new(inner: R, budget: &'b Budget) -> Self {
        Self { inner, budget, longest_line: usize::MAX, line: 0 }
    }

    /// A stream of lines, which fails with [`io::ErrorKind::InvalidData`] where one is too long.
    pub(in crate::format) fn of_lines(inner: R, budget: &'b Budget) -> Self {
        Self { longest_line: LONGEST_LINE, ..Self::new(inner, budget) }
    }
}

impl<R: Read> Read for Metered<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        let earned = self.budget.read.get().saturating_add(count as u64);
        self.budget.read.set(earned);
        self.line = match buffer[..count].iter().rposition(|byte| matches!(byte, b'\n' | b'\r')) {
            Some(end) => count - end - 1,
            None => self.line.saturating_add(count),
        };
        if self.line > self.longest_line {
            let message =
                format!("expected lines of at most {} bytes, found a longer one", self.longest_line);
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn budget(bytes: usize) -> Budget {
        Budget::new(ErrorSubject::ImportFile, bytes)
    }

    #[test]
    fn memory_follows_the_length_of_the_input() {
        assert!(budget(0).keep(START as usize).is_ok());
        let said = budget(0).keep(START as usize + 1).unwrap_err().to_string();
        assert!(said.contains("at most 48 MB of memory, and 16 bytes for each byte"), "{said}");
        let longer = budget(1_000_000);
        longer.keep(START as usize).unwrap();
        longer.keep_list::<u64>(2_000_000).unwrap();
        longer.keep_list::<u8>(1).unwrap_err();
        budget(0).keep_list::<u64>(usize::MAX).unwrap_err();
    }

    #[cfg(feature = "npz")]
    #[test]
    fn what_is_declared_is_limited_in_all() {
        let budget = budget(0);
        budget.unpack(200_000_000).unwrap();
        budget.keep((START + MOST_DECLARED) as usize).unwrap();
        budget.keep(1).unwrap_err();
        let said = budget.unpack(200_000_000).unwrap_err().to_string();
        assert!(said.contains("at most 256 MB when it is unpacked, found 400 MB"), "{said}");
        budget.unpack(u64::MAX).unwrap_err();
    }

    #[test]
    fn streams_earn_as_they_are_read_and_refuse_long_lines() {
        let budget = Budget::of_stream(ErrorSubject::Ply);
        budget.keep(START as usize).unwrap();
        budget.keep(1).unwrap_err();
        let long = vec![b' '; LONGEST_LINE + 1];
        Metered::new(long.as_slice(), &budget).read_to_end(&mut Vec::new()).unwrap();
        budget.keep(1_000_000).unwrap();
        let refused = Metered::of_lines(long.as_slice(), &budget).read_to_end(&mut Vec::new());
        assert_eq!(refused.unwrap_err().kind(), io::ErrorKind::InvalidData);
        let lines = [&long[..LONGEST_LINE], b"\n", &long[..LONGEST_LINE]].concat();
        Metered::of_lines(lines.as_slice(), &budget).read_to_end(&mut Vec::new()).unwrap();
    }
}
