//! OpenEXR bytes to pictures. Frames of the simulated camera have their own, stricter reader in
//! `film/exr`, which shares [`envelope`] with this one; these two are the doors of the crate `exr`.
//!
//! Single-part scan lines of any compression that the crate reads; R, G, B, or Y, each with or
//! without A, at every pixel. Other channels are passed over.

pub(crate) mod envelope;

use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers, Vec2};

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
    interleaved(name, [width, height], found)
}

/// Columns and rows.
pub(super) fn exr_size(bytes: &[u8]) -> Option<[usize; 2]> {
    envelope::check_list(bytes).ok()?;
    let metadata = MetaData::read_from_buffered(bytes, true).ok()?;
    let Vec2(width, height) = metadata.headers.first()?.layer_size;
    Some([width, height])
}

/// Pixels of a file of `length` bytes by its first ones, and bytes of all of them in memory; no more
/// than the file can hold. `None` if its header is not whole in `start`.
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
            let reason =
                "it has neither R, G and B nor Y as its channels; save it with one or the other";
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
