//! The members of the root group.

use super::fault::{CUT, Fault};
use super::fields::{Fields, NOWHERE};
use super::file::File;
use super::header::Header;
use super::tree::Tree;

/// Most members, and most bytes of a name: MATLAB's have up to 63.
const MOST_MEMBERS: usize = 4096;
const LONGEST_NAME: usize = 256;
/// A name beyond [`LONGEST_NAME`], or without its end.
const ENDLESS: Fault = Fault::Damaged("has a name without an end");

/// An object by its name.
pub(in super::super) struct Member {
    /// Its name.
    pub(in super::super) name: String,
    /// The address of its header; `None` for one of another file or another name.
    pub(in super::super) header: Option<u64>,
}

/// All members of the root group, in the order of the file.
///
/// # Errors
/// [`Fault`] for damage, more than 4096 members, and links outside the header.
pub(in super::super) fn members(file: &File<'_>) -> Result<Vec<Member>, Fault> {
    let root = Header::at(file, file.root)?;
    let mut members = Vec::new();
    match root.one(Header::SYMBOL_TABLE)? {
        Some(mut table) => {
            let places = (|| Some((table.word()?, table.word()?)))();
            let (tree, heap) = places.ok_or(CUT)?;
            let heap = names(file, heap)?;
            let nodes = Tree {
                file: *file,
                kind: 0,
                key: 8,
            };
            nodes.walk(tree, &mut |_, node| symbols(file, node, heap, &mut members))?;
        }
        None => {
            if links_are_elsewhere(&root)? {
                return Err(Fault::Unsupported(
                    "keeps its variables in a heap of HDF5 1.8",
                ));
            }
            for body in root.all(Header::LINK) {
                add(&mut members, linked(Fields(body))?)?;
            }
        }
    }
    Ok(members)
}

fn add(members: &mut Vec<Member>, member: Member) -> Result<(), Fault> {
    if members.len() == MOST_MEMBERS {
        return Err(Fault::Unsupported("has more than 4096 variables"));
    }
    members.push(member);
    Ok(())
}

/// The local heap that has the names of the members.
fn names<'a>(file: &File<'a>, address: u64) -> Result<Fields<'a>, Fault> {
    let place = (|| {
        let mut fields = file.at(address)?;
        fields.expect(b"HEAP\0")?;
        fields.skip(3)?;
        let length = fields.count(8)?;
        // Where it is free.
        fields.skip(8)?;
        file.at(fields.word()?)?.take(length)
    })();
    let bytes = place.ok_or(Fault::Damaged("has no heap where it should be"))?;
    Ok(Fields(bytes))
}

/// Adds the members that the symbol table node at `address` lists.
fn symbols(
    file: &File<'_>,
    address: u64,
    heap: Fields<'_>,
    members: &mut Vec<Member>,
) -> Result<(), Fault> {
    let head = (|| {
        let mut fields = file.at(address)?;
        fields.expect(b"SNOD")?;
        fields.skip(2)?;
        Some((fields.count(2)?, fields))
    })();
    let (count, mut fields) = head.ok_or(Fault::Damaged("has no symbols where they should be"))?;
    for _ in 0..count {
        let entry = (|| {
            let entry = (fields.count(8)?, fields.word()?);
            // What other programs need not look up.
            fields.skip(24)?;
            Some(entry)
        })();
        let (name, header) = entry.ok_or(CUT)?;
        let mut name_on = heap;
        name_on.skip(name).ok_or(CUT)?;
        let start = &name_on.0[..name_on.0.len().min(LONGEST_NAME)];
        let end = start.iter().position(|b| *b == 0).ok_or(ENDLESS)?;
        let member = Member {
            name: String::from_utf8_lossy(&start[..end]).into_owned(),
            header: Some(header).filter(|at| *at != NOWHERE),
        };
        add(members, member)?;
    }
    Ok(())
}

/// Whether the links of a group do not stand in its header.
fn links_are_elsewhere(root: &Header<'_>) -> Result<bool, Fault> {
    let Some(mut info) = root.one(Header::LINK_INFO)? else {
        return Ok(false);
    };
    let heap = (|| {
        info.expect(&[0])?;
        let has_order = info.byte()? & 1 != 0;
        info.skip(if has_order { 8 } else { 0 })?;
        info.word()
    })();
    Ok(heap.ok_or(CUT)? != NOWHERE)
}

/// The member that a link is to.
fn linked(mut link: Fields<'_>) -> Result<Member, Fault> {
    let found = (|| {
        link.expect(&[1])?;
        let flags = link.byte()?;
        let kind = if flags & 8 != 0 { link.byte()? } else { 0 };
        // The order of creation, and the encoding of the name.
        link.skip(if flags & 4 != 0 { 8 } else { 0 })?;
        link.skip(if flags & 16 != 0 { 1 } else { 0 })?;
        let length = link.count(1 << (flags & 3))?;
        let name = link.take(length)?;
        let header = if kind == 0 { Some(link.word()?) } else { None };
        Some((name, header))
    })();
    let (name, header) = found.ok_or(CUT)?;
    if name.len() > LONGEST_NAME {
        return Err(ENDLESS);
    }
    Ok(Member {
        name: String::from_utf8_lossy(name).into_owned(),
        header,
    })
}
