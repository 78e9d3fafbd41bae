//! OpenEXR bytes to pictures. Frames of the simulated camera have their own, stricter reader in
//! `film/exr`, which shares [`envelope`] with this one; these two are the doors of the crate `exr`.
//!
//! Single-part scan lines of any compression that the crate reads; R, G, B, or Y, each with or
//! without A, at every pixel. Other channels are passed over. The picture is the display window:
//! what of it lies outside the data window is 0, black and transparent, and data outside it are
//! left out (*Technical Introduction to OpenEXR*, ILM).

pub(crate) mod envelope;

use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{AnyChannel, FlatSamples, IntegerBounds, ReadChannels, ReadLayers, Vec2};

use super::{
    Channel, DEFLATE_RATIO_MAX, Encoding, Image, ImageError, checked_size, damaged, unsupported,
};

/// Most bytes of a pixel, all channels of a file together: eight of f32.
const MOST_BYTES: usize = 32;

/// Names of the channels in a file.
const NAMES: [(&str, Channel); 5] = [
    ("Y", Channel::Grey),
    ("R", Channel::Red),
    ("G", Channel::Green),
    ("B", Channel::Blue),
    ("A", Channel::Alpha),
];

pub(super) fn read_exr(name: &str, bytes: &[u8], most: usize) -> Result<Image, ImageError> {
    if let Some(kind) = envelope::other_kind(bytes) {
        return Err(unsupported(name, kind));
    }
    let table = envelope::check_list(bytes).map_err(|e| {
        damaged(
            name,
            format!("{e} (only single-part scan-line files are read)"),
        )
    })?;
    let metadata = MetaData::read_from_buffered(bytes, true).map_err(|e| damaged(name, e))?;
    let [header] = metadata.headers.as_slice() else {
        return Err(unsupported(
            name,
            "it has more than one part; save the first alone",
        ));
    };
    let Vec2(width, height) = header.layer_size;
    let list = &header.channels.list;
    let bits: usize = list
        .iter()
        .map(|c| 8 * c.sample_type.bytes_per_sample())
        .sum();
    let held = bytes.len().saturating_mul(8 * DEFLATE_RATIO_MAX) / bits.max(1);
    checked_size(name, [width, height], held, most)?;
    let display = header.shared_attributes.display_window;
    checked_size(name, [display.size.0, display.size.1], usize::MAX, most)?;
    // What lies outside the data takes memory too, and no bytes of the file.
    if display.size.area() > held {
        let reason =
            "its data window is a small part of its display window; crop the display window to it";
        return Err(unsupported(name, reason));
    }
    if header.deep || list.iter().any(|c| c.sampling != Vec2(1, 1)) {
        return Err(unsupported(
            name,
            "it has deep or subsampled channels; save it with one value of each channel a pixel",
        ));
    }
    // Channels that are passed over take memory too.
    if bits > 8 * MOST_BYTES {
        let reason = format!(
            "it has {} bytes a pixel in {} channels; save R, G and B or Y alone",
            bits / 8,
            list.len()
        );
        return Err(unsupported(name, reason));
    }
    let lines = header.compression.scan_lines_per_block();
    let first = header.data_window().position.y();
    envelope::check_blocks(bytes, table, [height, lines], first).map_err(|e| damaged(name, e))?;
    let found = planes(bytes).map_err(|e| damaged(name, e))?;
    let image = interleaved(name, [width, height], found)?;
    Ok(displayed(image, header.data_window(), display))
}

/// The data window's pixels in their places on the display window.
fn displayed(image: Image, data: IntegerBounds, display: IntegerBounds) -> Image {
    if data == display {
        return image;
    }
    let n = image.channels.len();
    let Vec2(width, height) = display.size;
    let mut values = vec![0.0; width * height * n];
    let shift = |d: IntegerBounds, s: IntegerBounds| {
        let [d, s] = [d, s].map(|b| b.position);
        [d.0, d.1]
            .into_iter()
            .zip([s.0, s.1])
            .map(|(d, s)| i64::from(d) - i64::from(s))
    };
    let shift: Vec<i64> = shift(data, display).collect();
    let inside = |at: usize, by: i64, most: usize| {
        let at = usize::try_from(at as i64 + by).ok()?;
        (at < most).then_some(at)
    };
    for (i, pixel) in image.values.chunks_exact(n).enumerate() {
        let column = inside(i % image.width, shift[0], width);
        let row = inside(i / image.width, shift[1], height);
        if let (Some(column), Some(row)) = (column, row) {
            let at = (column + row * width) * n;
            values[at..at + n].copy_from_slice(pixel);
        }
    }
    Image {
        width,
        height,
        values,
        ..image
    }
}

/// Columns and rows of the display window.
pub(super) fn exr_size(bytes: &[u8]) -> Option<[usize; 2]> {
    envelope::check_list(bytes).ok()?;
    let metadata = MetaData::read_from_buffered(bytes, true).ok()?;
    let display = metadata.headers.first()?.shared_attributes.display_window;
    Some([display.size.0, display.size.1])
}

/// Whether its header says that the data fill the display window.
pub(super) fn is_whole(bytes: &[u8]) -> bool {
    let metadata = MetaData::read_from_buffered(bytes, true);
    let header = metadata.ok().and_then(|m| m.headers.into_iter().next());
    header.is_none_or(|h| h.data_window() == h.shared_attributes.display_window)
}

/// Pixels of a file of `length` bytes by its first ones, and bytes of all of them in memory; no
/// more than the file can hold. `None` if its header is not whole in `start`.
#[cfg(feature = "cli")]
pub(crate) fn claimed(start: &[u8], length: u64) -> Option<[f64; 2]> {
    envelope::check_list(start).ok()?;
    let metadata = MetaData::read_from_buffered(start, true).ok()?;
    let header = metadata.headers.first()?;
    let Vec2(width, height) = header.layer_size;
    let channels = header.channels.list.iter();
    let bytes: usize = channels.map(|c| c.sample_type.bytes_per_sample()).sum();
    let bytes = bytes.max(1) as f64;
    let held = length as f64 * DEFLATE_RATIO_MAX as f64 / bytes;
    let pixels = (width as f64 * height as f64).min(held);
    Some([pixels, pixels * bytes])
}

/// All channels of a file whose header and blocks have been checked.
pub(crate) fn channels(
    bytes: &[u8],
) -> Result<impl Iterator<Item = AnyChannel<FlatSamples>>, String> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .pedantic()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    Ok(image.layer_data.channel_data.list.into_iter())
}

/// The known channels of a file whose header and blocks have been checked.
fn planes(bytes: &[u8]) -> Result<Vec<(Channel, Vec<f32>)>, String> {
    let known = |c: AnyChannel<FlatSamples>| {
        let (_, channel) = NAMES
            .into_iter()
            .find(|(name, _)| c.name.as_slice() == name.as_bytes())?;
        let values: Vec<f32> = match c.sample_data {
            FlatSamples::F16(values) => values.iter().map(|v| v.to_f32()).collect(),
            FlatSamples::F32(values) => values,
            FlatSamples::U32(_) => return None,
        };
        Some((channel, values))
    };
    Ok(channels(bytes)?.filter_map(known).collect())
}

fn interleaved(
    name: &str,
    [width, height]: [usize; 2],
    found: Vec<(Channel, Vec<f32>)>,
) -> Result<Image, ImageError> {
    let get = |channel| {
        found
            .iter()
            .find(|(c, _)| *c == channel)
            .map(|(c, values)| (*c, values.as_slice()))
    };
    let colours = [Channel::Red, Channel::Green, Channel::Blue].map(get);
    let mut planes: Vec<(Channel, &[f32])> = match (colours, get(Channel::Grey)) {
        ([Some(r), Some(g), Some(b)], _) => vec![r, g, b],
        ([None, None, None], Some(grey)) => vec![grey],
        _ => {
            let reason = "it has neither R, G and B nor Y as channels of floating-point numbers (integers are no light); save it with one or the other";
            return Err(unsupported(name, reason));
        }
    };
    planes.extend(get(Channel::Alpha));
    let pixels = width * height;
    if planes.iter().any(|(_, values)| values.len() != pixels) {
        return Err(damaged(name, "it has fewer values than pixels"));
    }
    Ok(Image {
        width,
        height,
        channels: planes.iter().map(|(c, _)| *c).collect(),
        values: (0..pixels)
            .flat_map(|i| planes.iter().map(move |(_, values)| values[i]))
            .collect(),
        encoding: Encoding::Float,
    })
}
