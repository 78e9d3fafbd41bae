//! A frame as an OpenEXR file. Pictures for textures, which come from other programs, are read by
//! `image/exr`; these two are the doors of the crate `exr`: a frame's reader is strict in every
//! attribute, a picture's knows none.
//!
//! One part, scan lines, every channel f32 (FLOAT), ZIP compression in blocks of 16 lines:
//! lossless, and its checksum notices damaged pixels. What the frame knows of its origin stands in
//! the header, see the table in `attributes.rs`. The same frame always gives the same bytes.
//!
//! A reader trusts no number in a file: before it takes memory for pixels, it compares their size
//! with the length of the file (deflate shrinks at most by [`DEFLATE_RATIO_MAX`]) and with
//! [`PIXEL_BYTES_MAX`], and finds every block of lines where it should be.

mod attributes;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use exr::meta::attribute::LineOrder;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, IntegerBounds, Layer, SampleType, Vec2,
    WritableImage,
};

use super::{Channel, Frame};
use crate::image::DEFLATE_RATIO_MAX;
use crate::image::exr::{channels, envelope};
use crate::store::{self, ReadError, StoreError};

/// Most bytes that the pixels of a frame may take, all channels together: 1 GiB, sixteen channels
/// of 4096 × 4096.
pub const PIXEL_BYTES_MAX: usize = 1 << 30;
/// What a frame's file takes at most beside its pixels: header, and by line offset, place and size.
const HEADER_MAX: u64 = 1 << 20;
const LINE_MAX: u64 = 16;
/// Longest channel name that every OpenEXR reader accepts, bytes.
const NAME_MAX: usize = 31;

/// Why a frame cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The file cannot be read, or is larger than any frame.
    #[error(transparent)]
    Unreadable(#[from] ReadError),
    /// A whole OpenEXR file perhaps, but no frame of this program.
    #[error("{} is not a frame of phicam: {reason}; use the files that `phicam render` wrote, unchanged", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Cut short or altered.
    #[error("the frame {} is damaged: {reason}; delete the file and render its spot again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The frame to be written contradicts itself.
    #[error("cannot write the frame {}: {reason}; give every pixel of every channel one value", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong with the frame.
        reason: String,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Writes `frame` to `path`, whole or not at all; it is safe from a power cut after the next
/// [`flush`](store::flush) of its folder. Every bit of every value is kept, of NaN and infinity
/// too.
///
/// # Errors
/// [`FrameError::Malformed`] if a channel has not columns·rows values, if names are empty, double,
/// longer than 31 bytes or not printable ASCII, or if the frame has no pixels or more than
/// [`PIXEL_BYTES_MAX`]; [`FrameError::Store`] if the file cannot be written.
pub fn write(path: &Path, frame: &Frame) -> Result<(), FrameError> {
    let bytes = encode(frame).map_err(|reason| FrameError::Malformed {
        path: path.into(),
        reason,
    })?;
    Ok(store::write_soon(path, |file| file.write_all(&bytes))?)
}

/// Bytes that the file of a frame of `columns` × `rows` pixels has at most: what deflate does not
/// shrink is stored as it is.
pub fn file_max([columns, rows]: [usize; 2], channels: usize) -> u64 {
    let [columns, rows, channels] = [columns, rows, channels].map(|n| n as u64);
    let line = columns.saturating_mul(4).saturating_mul(channels);
    let pixels = rows.saturating_mul(line.saturating_add(LINE_MAX));
    pixels.saturating_add(HEADER_MAX)
}

/// Reads the frame at `path`; its channels come in order of name. NaN and infinity are passed on:
/// stacking refuses them.
///
/// # Errors
/// [`FrameError::Unreadable`], [`FrameError::Foreign`] or [`FrameError::Damaged`].
pub fn read(path: &Path) -> Result<Frame, FrameError> {
    read_within(path, PIXEL_BYTES_MAX as u64)
}

/// The same for a frame whose file has at most `most` bytes: see [`file_max`].
///
/// # Errors
/// Those of [`read`].
pub fn read_within(path: &Path, most: u64) -> Result<Frame, FrameError> {
    let foreign = |reason| FrameError::Foreign {
        path: path.into(),
        reason,
    };
    let damaged = |reason| FrameError::Damaged {
        path: path.into(),
        reason,
    };
    let bytes = store::read(path, most)?;

    if bytes.is_empty() {
        return Err(damaged("it is empty".into()));
    }
    let table = envelope::check_list(&bytes).map_err(|fault| {
        if bytes.starts_with(b"v/1\x01") {
            damaged(fault.into())
        } else {
            foreign(fault.into())
        }
    })?;
    let metadata =
        MetaData::read_from_buffered(bytes.as_slice(), true).map_err(|e| damaged(e.to_string()))?;
    let [header] = metadata.headers.as_slice() else {
        return Err(foreign("it has more than one part".into()));
    };
    check_header(header, bytes.len()).map_err(foreign)?;
    let meta = attributes::recall(&header.own_attributes).map_err(foreign)?;
    let Vec2(columns, rows) = header.layer_size;
    let lines = header.compression.scan_lines_per_block();
    envelope::check_blocks(&bytes, table, [rows, lines], 0)
        .map_err(|fault| damaged(fault.into()))?;
    let channels = decode(&bytes).map_err(damaged)?;
    Ok(Frame {
        columns,
        rows,
        channels,
        meta,
    })
}

/// The file of a frame; the error says what is wrong with the frame.
fn encode(frame: &Frame) -> Result<Vec<u8>, String> {
    let Frame {
        columns,
        rows,
        channels,
        meta,
    } = frame;
    let pixels = columns
        .checked_mul(*rows)
        .filter(|&n| n > 0)
        .ok_or("it has no pixels, or too many")?;
    let bytes = pixels
        .checked_mul(4 * channels.len())
        .filter(|&n| n <= PIXEL_BYTES_MAX);
    bytes.filter(|&n| n > 0).ok_or(format!(
        "it has no channels, or more than {PIXEL_BYTES_MAX} bytes of pixels"
    ))?;
    let mut names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("it has two channels `{}`", pair[0]));
    }
    for Channel { name, values } in channels {
        if name.is_empty() || name.len() > NAME_MAX || !name.bytes().all(|b| b.is_ascii_graphic()) {
            return Err(format!(
                "`{name}` is no name of a channel: 1 to {NAME_MAX} printable ASCII characters"
            ));
        }
        if values.len() != pixels {
            return Err(format!(
                "its channel {name} has {} values for {pixels} pixels",
                values.len()
            ));
        }
    }
    let list = channels.iter().map(|c| {
        AnyChannel::new(
            attributes::text(&c.name),
            FlatSamples::F32(c.values.clone()),
        )
    });
    let channels = AnyChannels::sort(list.collect());
    let layer = Layer::new(
        (*columns, *rows),
        attributes::record(meta)?,
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let mut file = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .map_err(|e| e.to_string())?;
    let mut file = file.into_inner();
    envelope::sort_attributes(&mut file)?;
    Ok(file)
}

/// Checks that a header describes f32 pixels of one plain image that `length` bytes of file can
/// hold.
fn check_header(header: &Header, length: usize) -> Result<(), String> {
    use exr::meta::attribute::Compression;
    let Vec2(columns, rows) = header.layer_size;
    if header.deep
        || header.blocks != BlockDescription::ScanLines
        || header.line_order != LineOrder::Increasing
    {
        return Err("its pixels are not plain scan lines from the first to the last".into());
    }
    if !matches!(header.compression, Compression::ZIP1 | Compression::ZIP16) {
        return Err(format!(
            "its compression is {}, not ZIP",
            header.compression
        ));
    }
    let window = IntegerBounds::from_dimensions((columns, rows));
    if header.data_window() != window || header.shared_attributes.display_window != window {
        return Err(
            "it is cropped or shifted: its data window is not its display window from (0, 0)"
                .into(),
        );
    }
    let channels = &header.channels.list;
    for channel in channels {
        if channel.sample_type != SampleType::F32 || channel.sampling != Vec2(1, 1) {
            return Err(format!(
                "its channel {} is not f32 (FLOAT) at every pixel",
                channel.name
            ));
        }
    }
    let bytes = columns
        .checked_mul(rows)
        .and_then(|n| n.checked_mul(4 * channels.len()));
    let limit = length
        .saturating_mul(DEFLATE_RATIO_MAX)
        .min(PIXEL_BYTES_MAX);
    match bytes {
        Some(n) if n > 0 && n <= limit => Ok(()),
        _ => Err(format!(
            "it claims {columns} × {rows} pixels in {} channels, and its {length} bytes hold at most {limit} bytes of pixels",
            channels.len()
        )),
    }
}

/// The channels of a file whose header and blocks have been checked; the error says what is
/// damaged.
fn decode(bytes: &[u8]) -> Result<Vec<Channel>, String> {
    let channel = |c: AnyChannel<FlatSamples>| {
        let name = String::from_utf8(c.name.as_slice().to_vec())
            .map_err(|_| "a channel has no readable name")?;
        match c.sample_data {
            FlatSamples::F32(values) => Ok(Channel { name, values }),
            _ => Err(format!("its channel {name} is not f32")),
        }
    };
    channels(bytes)?.map(channel).collect()
}

#[cfg(test)]
mod tests;
