//! An HDF5 file behind a block of another format.

use super::fault::{CUT, Fault};
use super::fields::Fields;

/// The bytes that a superblock begins with.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// A file from its superblock on; addresses count from there.
#[derive(Clone, Copy)]
pub(in super::super) struct File<'a> {
    bytes: &'a [u8],
    /// The address of the root group's header.
    pub(super) root: u64,
}

impl<'a> File<'a> {
    /// The file whose superblock begins at byte `start` of `bytes`.
    ///
    /// # Errors
    /// [`Fault`] if there is none, for addresses of other than 8 bytes, and for fewer bytes than it
    /// says.
    pub(in super::super) fn new(bytes: &'a [u8], start: usize) -> Result<Self, Fault> {
        let bytes_from = bytes.get(start..).ok_or(CUT)?;
        let (root, end) = Self::superblock(Fields(bytes_from))?;
        // The end counts from the first byte of the whole file.
        if (bytes.len() as u64) < end {
            return Err(CUT);
        }
        Ok(Self {
            bytes: bytes_from,
            root,
        })
    }

    /// The address of the root group's header, and the end of the file.
    fn superblock(mut fields: Fields<'_>) -> Result<(u64, u64), Fault> {
        let version = (|| {
            fields.expect(SIGNATURE)?;
            fields.byte()
        })();
        let version = version.ok_or(Fault::Damaged("has no HDF5 signature after its header"))?;
        let widths = match version {
            0 | 1 => (|| {
                fields.skip(4)?;
                let widths = [fields.byte()?, fields.byte()?];
                // Sizes of nodes, and flags.
                fields.skip(9 + 4 * usize::from(version))?;
                Some(widths)
            })(),
            2 | 3 => (|| {
                let widths = [fields.byte()?, fields.byte()?];
                fields.skip(1)?;
                Some(widths)
            })(),
            _ => return Err(Fault::Unsupported("has a superblock of a later HDF5")),
        };
        if widths.ok_or(CUT)? != [8, 8] {
            return Err(Fault::Unsupported("has addresses of other than 8 bytes"));
        }
        (|| {
            // The base, and free space or an extension.
            fields.skip(16)?;
            let end = fields.word()?;
            if version < 2 {
                // The driver, and where the name of the root group would be.
                fields.skip(16)?;
            }
            Some((fields.word()?, end))
        })()
        .ok_or(CUT)
    }

    /// What begins at `address`, or `None` if that is beyond the end.
    pub(super) fn at(&self, address: u64) -> Option<Fields<'a>> {
        let start = usize::try_from(address).ok()?;
        self.bytes.get(start..).map(Fields)
    }

    /// Bytes from the superblock on.
    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }
}
