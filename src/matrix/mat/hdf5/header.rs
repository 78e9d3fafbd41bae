//! The header of an object: a list of messages, each a property of the object.

use super::fault::{CUT, Fault};
use super::fields::Fields;
use super::file::File;

/// Most messages of an object. MATLAB writes about ten.
const MOST_MESSAGES: usize = 1024;

/// A property of an object.
pub(super) struct Message<'a> {
    kind: u16,
    /// Whether `body` only says where the property is.
    is_shared: bool,
    body: &'a [u8],
}

/// The properties of an object.
pub(in super::super) struct Header<'a>(Vec<Message<'a>>);

impl Header<'_> {
    /// Kinds of messages.
    pub(super) const DATASPACE: u16 = 1;
    pub(super) const LINK_INFO: u16 = 2;
    pub(super) const DATATYPE: u16 = 3;
    pub(super) const LINK: u16 = 6;
    pub(super) const LAYOUT: u16 = 8;
    pub(super) const FILTERS: u16 = 11;
    pub(super) const ATTRIBUTE: u16 = 12;
    const CONTINUATION: u16 = 16;
    pub(super) const SYMBOL_TABLE: u16 = 17;
}

impl<'a> Header<'a> {
    /// The header at `address`.
    ///
    /// # Errors
    /// [`Fault`] for one that reaches beyond the file, more than 1024 messages, and later versions.
    pub(in super::super) fn at(file: &File<'a>, address: u64) -> Result<Self, Fault> {
        let start = file.at(address).ok_or(CUT)?;
        if start.0.starts_with(b"OHDR") {
            Self::version2(file, start)
        } else {
            Self::version1(file, start)
        }
    }

    fn version1(file: &File<'a>, mut fields: Fields<'a>) -> Result<Self, Fault> {
        if fields.byte() != Some(1) {
            return Err(Fault::Damaged("has no object header where it should be"));
        }
        let block = (|| {
            // How many messages and how many links, which the blocks say too.
            fields.skip(7)?;
            let length = fields.count(4)?;
            fields.skip(4)?;
            fields.take(length)
        })();
        let message = |fields: &mut Fields<'a>| {
            let kind = fields.number(2)? as u16;
            let length = fields.count(2)?;
            let flags = fields.byte()?;
            fields.skip(3)?;
            Some((kind, flags, fields.take(length)?))
        };
        Self::listed(block.ok_or(CUT)?, 8, message, |address, length| {
            file.at(address)?.take(length)
        })
    }

    fn version2(file: &File<'a>, mut fields: Fields<'a>) -> Result<Self, Fault> {
        fields.skip(4).ok_or(CUT)?;
        if fields.byte() != Some(2) {
            return Err(Fault::Unsupported("has object headers of a later HDF5"));
        }
        let flags = fields.byte().ok_or(CUT)?;
        let block = (|| {
            // Times, and how many attributes stand in the header.
            fields.skip(if flags & 0x20 != 0 { 16 } else { 0 })?;
            fields.skip(if flags & 0x10 != 0 { 4 } else { 0 })?;
            let length = fields.count(1 << (flags & 3))?;
            fields.take(length)
        })();
        let order = if flags & 4 != 0 { 2 } else { 0 };
        let message = |fields: &mut Fields<'a>| {
            let kind = u16::from(fields.byte()?);
            let length = fields.count(2)?;
            let flags = fields.byte()?;
            fields.skip(order)?;
            Some((kind, flags, fields.take(length)?))
        };
        Self::listed(block.ok_or(CUT)?, 4 + order, message, |address, length| {
            let mut block = file.at(address)?;
            block.expect(b"OCHK")?;
            // A checksum comes last.
            block.take(length.checked_sub(8)?)
        })
    }

    /// The messages of `first` and of the blocks that go on from it. Fewer than `least` bytes at
    /// the end of a block are a gap.
    fn listed(
        first: &'a [u8],
        least: usize,
        message: impl Fn(&mut Fields<'a>) -> Option<(u16, u8, &'a [u8])>,
        block: impl Fn(u64, usize) -> Option<&'a [u8]>,
    ) -> Result<Self, Fault> {
        let mut messages = Vec::new();
        let mut blocks = vec![first];
        let mut taken = 0;
        while let Some(&next) = blocks.get(taken) {
            taken += 1;
            let mut rest = Fields(next);
            while rest.0.len() >= least {
                let (kind, flags, body) = message(&mut rest).ok_or(CUT)?;
                if messages.len() + blocks.len() > MOST_MESSAGES {
                    return Err(Fault::Damaged("has an object header without an end"));
                }
                if kind == Self::CONTINUATION {
                    let mut place = Fields(body);
                    let next = (|| block(place.word()?, place.count(8)?))();
                    blocks.push(next.ok_or(CUT)?);
                } else {
                    messages.push(Message {
                        kind,
                        is_shared: flags & 2 != 0,
                        body,
                    });
                }
            }
        }
        Ok(Self(messages))
    }

    /// The bodies of all messages of a kind that stand here themselves.
    pub(super) fn all(&self, kind: u16) -> impl Iterator<Item = &'a [u8]> {
        let of_kind = self.0.iter().filter(move |m| m.kind == kind);
        of_kind.filter(|m| !m.is_shared).map(|m| m.body)
    }

    /// The only message of a kind, if there is one.
    ///
    /// # Errors
    /// [`Fault`] for one that stands elsewhere.
    pub(super) fn one(&self, kind: u16) -> Result<Option<Fields<'a>>, Fault> {
        match self.0.iter().find(|m| m.kind == kind) {
            Some(message) if message.is_shared => {
                Err(Fault::Unsupported("shares a property with other objects"))
            }
            found => Ok(found.map(|m| Fields(m.body))),
        }
    }

    /// Whether the object is an array.
    pub(in super::super) fn is_dataset(&self) -> bool {
        self.0.iter().any(|m| m.kind == Self::DATASPACE)
    }
}
