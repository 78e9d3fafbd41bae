//! Where the numbers of an array lie.

use super::fault::{CUT, Fault};
use super::fields::{Fields, NOWHERE};
use super::file::File;

/// In one piece, or in chunks.
pub(super) enum Layout<'a> {
    /// All of them, in order.
    Whole(&'a [u8]),
    /// In chunks.
    Chunked {
        /// The address of the tree that finds them.
        tree: u64,
        /// Their lengths along each index of the array, and the bytes of an element.
        lengths: Vec<usize>,
    },
}

impl<'a> Layout<'a> {
    /// Of a message.
    ///
    /// # Errors
    /// [`Fault`] for what lies outside the file, was never written, or has an index of HDF5 1.10.
    pub(super) fn of(file: &File<'a>, mut fields: Fields<'a>) -> Result<Self, Fault> {
        let (version, class) = (|| Some((fields.byte()?, fields.byte()?)))().ok_or(CUT)?;
        match (version, class) {
            (3 | 4, 0) => {
                let length = fields.count(2).ok_or(CUT)?;
                Ok(Self::Whole(fields.take(length).ok_or(CUT)?))
            }
            (3 | 4, 1) => {
                let place = (|| Some((fields.word()?, fields.count(8)?)))();
                let (address, length) = place.ok_or(CUT)?;
                written(address)?;
                let whole = file.at(address).and_then(|mut all| all.take(length));
                Ok(Self::Whole(whole.ok_or(CUT)?))
            }
            (3, 2) => {
                let (tree, lengths) = (|| {
                    let count = usize::from(fields.byte()?);
                    let tree = fields.word()?;
                    let lengths = (0..count).map(|_| fields.count(4)).collect::<Option<_>>()?;
                    Some((tree, lengths))
                })()
                .ok_or(CUT)?;
                written(tree)?;
                Ok(Self::Chunked { tree, lengths })
            }
            (4, 2) => Err(Fault::Unsupported("has an index of chunks of HDF5 1.10")),
            _ => Err(Fault::Unsupported("has a layout that MATLAB does not use")),
        }
    }
}

/// Refuses the address of what was never written.
fn written(address: u64) -> Result<(), Fault> {
    if address == NOWHERE {
        return Err(Fault::Damaged("was never written"));
    }
    Ok(())
}
