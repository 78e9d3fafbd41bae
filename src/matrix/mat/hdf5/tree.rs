//! B-trees of version 1: addresses in the order of their keys.

use super::fault::{CUT, Fault};
use super::fields::Fields;
use super::file::File;

/// The tree of the file that has the members of a group, or the chunks of an array.
pub(super) struct Tree<'a> {
    pub(super) file: File<'a>,
    /// 0 for a group, 1 for chunks.
    pub(super) kind: u8,
    /// Bytes of a key.
    pub(super) key: usize,
}

/// What is done with a key and the address that it stands for.
pub(super) type Visit<'v, 'a> = dyn FnMut(Fields<'a>, u64) -> Result<(), Fault> + 'v;

impl<'a> Tree<'a> {
    /// Shows every leaf below the node at `address`, in order.
    ///
    /// # Errors
    /// [`Fault`] for a tree that reaches beyond the file or is no tree, and what `visit` returns.
    pub(super) fn walk(&self, address: u64, visit: &mut Visit<'_, 'a>) -> Result<(), Fault> {
        // More entries than the file has room for are some of them twice.
        let mut left = self.file.len() / (self.key + 8);
        self.node(address, None, &mut left, visit)
    }

    /// The node at `address`, which is nearer to the leaves than one of level `above`.
    fn node(
        &self,
        address: u64,
        above: Option<u8>,
        left: &mut usize,
        visit: &mut Visit<'_, 'a>,
    ) -> Result<(), Fault> {
        let mut fields = self.file.at(address).ok_or(CUT)?;
        let head = (|| {
            fields.expect(b"TREE")?;
            fields.expect(&[self.kind])?;
            let head = (fields.byte()?, fields.count(2)?);
            // The nodes beside this one.
            fields.skip(16)?;
            Some(head)
        })();
        let (level, entries) = head.ok_or(Fault::Damaged("has no B-tree where it should be"))?;
        if above.is_some_and(|above| level >= above) {
            return Err(Fault::Damaged("has a B-tree that does not go down"));
        }
        for _ in 0..entries {
            *left = left
                .checked_sub(1)
                .ok_or(Fault::Damaged("has a B-tree without an end"))?;
            let key = fields.take(self.key).ok_or(CUT)?;
            let child = fields.word().ok_or(CUT)?;
            if level == 0 {
                visit(Fields(key), child)?;
            } else {
                self.node(child, Some(level), left, visit)?;
            }
        }
        Ok(())
    }
}
