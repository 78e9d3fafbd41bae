//! An array of elements.

use std::borrow::Cow;

use super::chunks::Grid;
use super::datatype::Datatype;
use super::fault::{CUT, Fault};
use super::fields::Fields;
use super::file::File;
use super::filters::Filters;
use super::header::Header;
use super::layout::Layout;

/// An array, as its header describes it.
pub(in super::super) struct Dataset<'h, 'a> {
    file: File<'a>,
    header: &'h Header<'a>,
    /// Its lengths; the last index runs fastest.
    pub(in super::super) shape: Vec<usize>,
    /// What its elements are.
    pub(in super::super) datatype: Datatype,
}

impl<'h, 'a> Dataset<'h, 'a> {
    /// The array with this header.
    ///
    /// # Errors
    /// [`Fault`] if it is none, for lengths beyond those of this machine, and for damage.
    pub(in super::super) fn new(file: File<'a>, header: &'h Header<'a>) -> Result<Self, Fault> {
        let space = header.one(Header::DATASPACE)?.ok_or(CUT)?;
        let datatype = header.one(Header::DATATYPE)?.ok_or(CUT)?;
        Ok(Self {
            file,
            shape: lengths(space).ok_or(CUT)?,
            datatype: Datatype::of(datatype)?,
            header,
        })
    }

    /// All of its elements of `element` bytes each, of which there is at least one.
    ///
    /// # Errors
    /// [`Fault`] for fewer bytes than that, for storage that is not read, and for damage.
    pub(in super::super) fn bytes(&self, element: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let layout = self.header.one(Header::LAYOUT)?.ok_or(CUT)?;
        match Layout::of(&self.file, layout)? {
            Layout::Whole(whole) => {
                let entries = self
                    .shape
                    .iter()
                    .try_fold(element, |n, l| n.checked_mul(*l));
                let whole = entries.and_then(|n| whole.get(..n));
                whole.map(Cow::Borrowed).ok_or(CUT)
            }
            Layout::Chunked { tree, lengths } => {
                let filters = self.header.one(Header::FILTERS)?;
                let filters = filters.map(Filters::of).transpose()?.unwrap_or_default();
                let grid = Grid::new(&self.shape, &lengths, element)?;
                grid.gathered(&self.file, tree, &filters).map(Cow::Owned)
            }
        }
    }
}

/// The lengths that a dataspace has, of which a single number has none.
fn lengths(mut space: Fields<'_>) -> Option<Vec<usize>> {
    let version = space.byte()?;
    let rank = space.byte()?;
    // Whether it has most lengths, and its kind.
    space.skip(match version {
        1 => 6,
        2 => 2,
        _ => return None,
    })?;
    (0..rank).map(|_| space.count(8)).collect()
}
