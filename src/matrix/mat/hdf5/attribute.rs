//! A named value of an object.

use super::fields::Fields;
use super::header::Header;

/// A value that stands in the header of an object.
pub(in super::super) struct Attribute<'a> {
    /// Whether it is a text of fixed length.
    is_text: bool,
    value: &'a [u8],
}

impl<'a> Attribute<'a> {
    /// The attribute `name` of an object, or `None` if it has none that can be read.
    pub(in super::super) fn of(header: &Header<'a>, name: &str) -> Option<Self> {
        let mut all = header.all(Header::ATTRIBUTE).filter_map(Self::parsed);
        let found = all.find(|(own, _)| *own == name.as_bytes());
        found.map(|(_, attribute)| attribute)
    }

    /// Name and value of a message.
    fn parsed(body: &'a [u8]) -> Option<(&'a [u8], Self)> {
        let mut fields = Fields(body);
        let version = fields.byte()?;
        fields.skip(1)?;
        let lengths = [fields.count(2)?, fields.count(2)?, fields.count(2)?];
        // Version 1 pads to 8 bytes; version 3 says how the name is encoded.
        let lengths = match version {
            1 => lengths.map(|n| n.next_multiple_of(8)),
            2 => lengths,
            3 => {
                fields.skip(1)?;
                lengths
            }
            _ => return None,
        };
        let name = fields.take(lengths[0])?;
        let name = name.split(|b| *b == 0).next()?;
        let mut datatype = Fields(fields.take(lengths[1])?);
        let class = datatype.byte()? & 15;
        datatype.skip(3)?;
        let length = datatype.count(4)?;
        fields.skip(lengths[2])?;
        let attribute = Self {
            is_text: class == 3,
            value: fields.take(length)?,
        };
        Some((name, attribute))
    }

    /// The text, or `None` if it is none of fixed length in ASCII.
    pub(in super::super) fn text(&self) -> Option<&'a str> {
        let text = self.value.split(|b| *b == 0).next()?;
        let text = std::str::from_utf8(text).ok().filter(|_| self.is_text)?;
        Some(text.trim_end())
    }

    /// Whether it is a number other than zero.
    pub(in super::super) fn is_set(&self) -> bool {
        self.value.iter().any(|b| *b != 0)
    }
}
