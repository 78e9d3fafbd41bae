//! The fields of a part of a file, one after the other.

/// What of the part was not read yet. Every number has its least significant byte first.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

/// The address of what does not exist.
pub(super) const NOWHERE: u64 = u64::MAX;

impl<'a> Fields<'a> {
    /// The next `count` bytes, or `None` if there are fewer.
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (first, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(first)
    }

    /// Goes on after the next `count` bytes, or returns `None` if there are fewer.
    pub(super) fn skip(&mut self, count: usize) -> Option<()> {
        self.take(count).map(|_| ())
    }

    /// Goes on after `expected`, or returns `None` if something else comes next.
    pub(super) fn expect(&mut self, expected: &[u8]) -> Option<()> {
        let found = self.take(expected.len())?;
        (found == expected).then_some(())
    }

    /// The next number of `width` bytes, at most 8.
    pub(super) fn number(&mut self, width: usize) -> Option<u64> {
        let mut wide = [0; 8];
        wide.get_mut(..width)?.copy_from_slice(self.take(width)?);
        Some(u64::from_le_bytes(wide))
    }

    /// The next number of `width` bytes, as a number of bytes or of parts.
    pub(super) fn count(&mut self, width: usize) -> Option<usize> {
        usize::try_from(self.number(width)?).ok()
    }

    /// The next byte.
    pub(super) fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|b| b[0])
    }

    /// The next address or length: 8 bytes.
    pub(super) fn word(&mut self) -> Option<u64> {
        self.number(8)
    }
}
