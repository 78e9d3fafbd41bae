//! How a camera was held: the orientation of EXIF (tag 274), noted in PNG (chunk eXIf), JPEG
//! (segment APP1) and TIFF.
//!
//! Source: CIPA DC-008 (Exif 2.32), 4.6.4 A, Orientation: of the rows and columns of the stored
//! picture it says on which side of the scene the first of each lies.

/// The orientation of a picture, 1 to 8; 1 is upright.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Orientation(u16);

/// The tag of the orientation.
const TAG: u16 = 274;
/// Its type: SHORT.
const SHORT: u16 = 3;

impl Orientation {
    /// The orientation `code`, if there is one of that number.
    pub(super) fn new(code: u16) -> Option<Self> {
        (1..=8).contains(&code).then_some(Self(code))
    }

    /// What a PNG, JPEG or TIFF notes; upright where it notes nothing. The error is a number that
    /// has no meaning.
    pub(super) fn of_file(bytes: &[u8]) -> Result<Self, u16> {
        let noted = match bytes {
            [0x89, b'P', b'N', b'G', ..] => of_png(bytes).and_then(of_exif),
            [0xff, 0xd8, ..] => of_jpeg(bytes).and_then(of_exif),
            _ => None,
        };
        noted.map_or(Ok(Self(1)), |code| Self::new(code).ok_or(code))
    }

    /// Whether nothing is to be turned.
    pub(super) fn is_upright(self) -> bool {
        self.0 == 1
    }

    /// The upright picture of `width` × `height` stored pixels with `channels` values each: its
    /// width, height and values.
    pub(super) fn turned(
        self,
        [width, height]: [usize; 2],
        channels: usize,
        values: &[f64],
    ) -> ([usize; 2], Vec<f64>) {
        let size = if self.0 < 5 {
            [width, height]
        } else {
            [height, width]
        };
        let mut turned = vec![0.0; values.len()];
        for (k, pixel) in values.chunks_exact(channels).enumerate() {
            let [i, j] = [k % width, k / width];
            let [last_i, last_j] = [width - 1 - i, height - 1 - j];
            let [column, row] = match self.0 {
                2 => [last_i, j],
                3 => [last_i, last_j],
                4 => [i, last_j],
                5 => [j, i],
                6 => [last_j, i],
                7 => [last_j, last_i],
                8 => [j, last_i],
                _ => [i, j],
            };
            let at = (column + row * size[0]) * channels;
            turned[at..at + channels].copy_from_slice(pixel);
        }
        (size, turned)
    }
}

/// The chunk eXIf: each chunk is its length (u32, big-endian), four letters, content, checksum.
fn of_png(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes.get(8..)?;
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let end = length.checked_add(8)?;
        let content = rest.get(8..end)?;
        if &rest[4..8] == b"eXIf" {
            return Some(content);
        }
        rest = rest.get(end.checked_add(4)?..)?;
    }
}

/// The segment APP1 that begins with `Exif`: each segment is 0xff, its kind, and its length (u16,
/// big-endian, itself included).
fn of_jpeg(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes.get(2..)?;
    while let [0xff, kind, high, low, ..] = *rest {
        let end = 2 + usize::from(u16::from_be_bytes([high, low]));
        let content = rest.get(4..end)?;
        match kind {
            0xe1 if content.starts_with(b"Exif\0\0") => return content.get(6..),
            // The pixels begin.
            0xda => return None,
            _ => rest = &rest[end..],
        }
    }
    None
}

/// The orientation in the first directory of EXIF, which is laid out as TIFF.
fn of_exif(exif: &[u8]) -> Option<u16> {
    let big = match exif.get(..4)? {
        [b'M', b'M', 0, 42] => true,
        [b'I', b'I', 42, 0] => false,
        _ => return None,
    };
    let short = |at: usize| -> Option<u16> {
        let bytes = [*exif.get(at)?, *exif.get(at.checked_add(1)?)?];
        Some(if big {
            u16::from_be_bytes(bytes)
        } else {
            u16::from_le_bytes(bytes)
        })
    };
    let long = |at: usize| -> Option<usize> {
        let [a, b] = [short(at)?, short(at.checked_add(2)?)?].map(usize::from);
        Some(if big { a << 16 | b } else { b << 16 | a })
    };
    let directory = long(4)?;
    for entry in 0..usize::from(short(directory)?) {
        let at = directory.checked_add(2 + 12 * entry)?;
        if short(at)? == TAG && short(at.checked_add(2)?)? == SHORT {
            return short(at.checked_add(8)?);
        }
    }
    None
}
