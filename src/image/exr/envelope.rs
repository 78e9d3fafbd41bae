//! The bytes of an OpenEXR file around its pixels: the list of attributes and the table of blocks.
//!
//! Layout of a single-part scan-line file: magic number and version (4 + 4 bytes), attributes
//! (name, NUL, type, NUL, size as i32, value), a NUL, one u64 offset a block of lines, the blocks
//! (y as i32, size as i32, data). All little-endian.
//!
//! The crate `exr` needs help with these bytes twice. It keeps attributes in a hash map, so that
//! the same frame gives other bytes at each writing: [`sort_attributes`] puts them in order of
//! name. And it believes what a file says of itself, leaving lines that no block covers black
//! without a word: [`check_list`] and [`check_blocks`] look first.

/// Magic number, then version 2 of a single-part scan-line file; bit 10 (names longer than 31
/// bytes) may be set.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const VERSION: u32 = 2;
const LONG_NAMES: u32 = 1 << 10;
const LIST_START: usize = 8;

/// One attribute as it stands in the file.
struct Attribute<'a> {
    name: &'a [u8],
    bytes: &'a [u8],
}

/// What is wrong with the bytes of a file, as the end of a sentence that begins with the file.
pub(crate) type Fault = &'static str;

/// The attributes of `file` in their order, and the position after the NUL that ends them.
fn attributes(file: &[u8]) -> Result<(Vec<Attribute<'_>>, usize), Fault> {
    const CUT: Fault = "its header is cut short or damaged";
    if !file.starts_with(&MAGIC) {
        return Err("its first bytes are not those of OpenEXR");
    }
    let version = file.get(4..LIST_START).ok_or(CUT)?;
    let version = u32::from_le_bytes([version[0], version[1], version[2], version[3]]);
    if version & !LONG_NAMES != VERSION {
        return Err("it is not a single-part scan-line file of OpenEXR version 2");
    }
    let mut list = Vec::new();
    let mut rest = &file[LIST_START..];
    while *rest.first().ok_or(CUT)? != 0 {
        let text_end = |from: usize| rest[from..].iter().position(|&b| b == 0).map(|n| from + n);
        let name_end = text_end(0).ok_or(CUT)?;
        let kind_end = text_end(name_end + 1).ok_or(CUT)?;
        let size = rest.get(kind_end + 1..kind_end + 5).ok_or(CUT)?;
        let size = i32::from_le_bytes([size[0], size[1], size[2], size[3]]);
        let end = usize::try_from(size)
            .ok()
            .and_then(|size| size.checked_add(kind_end + 5))
            .ok_or(CUT)?;
        let bytes = rest.get(..end).ok_or(CUT)?;
        list.push(Attribute {
            name: &rest[..name_end],
            bytes,
        });
        rest = &rest[end..];
    }
    Ok((list, file.len() - rest.len() + 1))
}

/// What an OpenEXR file of version 2 is beyond one part of scan lines, and how to save it instead.
pub(super) fn other_kind(file: &[u8]) -> Option<&'static str> {
    let version = file
        .get(4..LIST_START)
        .filter(|_| file.starts_with(&MAGIC))?;
    let version = u32::from_le_bytes(version.try_into().ok()?);
    let kinds = [
        (1 << 12, "it has more than one part; save the first alone"),
        (1 << 11, "it has deep pixels; save one value a pixel"),
        (1 << 9, "it is tiled; save it in scan lines"),
    ];
    let known = LONG_NAMES | kinds.iter().fold(0, |all, kind| all | kind.0);
    let is_ours = version & !known == VERSION;
    let found = kinds.iter().find(|kind| version & kind.0 != 0);
    found.filter(|_| is_ours).map(|kind| kind.1)
}

/// Checks that the attribute list lies within the file and names nothing twice; returns the
/// position after it, where the table of blocks begins.
pub(crate) fn check_list(file: &[u8]) -> Result<usize, Fault> {
    let (list, end) = attributes(file)?;
    let mut names: Vec<&[u8]> = list.iter().map(|a| a.name).collect();
    names.sort_unstable();
    if names.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("its header has an attribute twice");
    }
    Ok(end)
}

/// Puts the attributes of a file in order of name. Nothing after them moves.
pub(crate) fn sort_attributes(file: &mut [u8]) -> Result<(), Fault> {
    let (mut list, end) = attributes(file)?;
    list.sort_by_key(|a| a.name);
    let sorted: Vec<u8> = list.iter().flat_map(|a| a.bytes).copied().collect();
    file[LIST_START..end - 1].copy_from_slice(&sorted);
    Ok(())
}

/// Checks that the table at `table` leads to one block for each `lines` of the `rows` lines, each
/// with the y it should have, counted from `first`, and wholly within the file.
pub(crate) fn check_blocks(
    file: &[u8],
    table: usize,
    [rows, lines]: [usize; 2],
    first: i32,
) -> Result<(), Fault> {
    const CUT: Fault = "it ends before its last line";
    let word = |at: usize| {
        file.get(at..at.checked_add(4)?)
            .map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    };
    for block in 0..rows.div_ceil(lines) {
        let entry = table + 8 * block;
        let offset = file
            .get(entry..entry + 8)
            .and_then(|b| <[u8; 8]>::try_from(b).ok())
            .ok_or(CUT)?;
        let at = usize::try_from(u64::from_le_bytes(offset)).map_err(|_| CUT)?;
        let y = word(at).ok_or(CUT)?;
        let size = at.checked_add(4).and_then(word).ok_or(CUT)?;
        if i64::from(y) != i64::from(first) + (block * lines) as i64 {
            return Err("its lines are out of order");
        }
        let end = usize::try_from(size)
            .ok()
            .and_then(|size| at.checked_add(8)?.checked_add(size))
            .ok_or(CUT)?;
        if size == 0 || end > file.len() {
            return Err(CUT);
        }
    }
    Ok(())
}
