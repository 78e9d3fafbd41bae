//! Photographs as text and as pictures of counts.

use super::axis::significant;
use super::encode::{PictureError, grey16};
use crate::sensor::Summary;

/// What an exposure came to, as plain text of at most 80 columns; `times` in s, the longest first.
pub fn exposure_table(summary: &Summary, times: &[f64]) -> String {
    let ratio = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(x, 3));
    let share = |n: usize| {
        let part = 100.0 * n as f64 / summary.entries as f64;
        format!("{n} of {} ({} %)", summary.entries, significant(part, 3))
    };
    let mut lines = vec![
        (
            "electrons",
            format!(
                "{} on average, {} at most, in a frame of {} s",
                significant(summary.electrons_mean, 4),
                significant(summary.electrons_max, 4),
                times.first().map_or(String::new(), |t| significant(*t, 3))
            ),
        ),
        (
            "signal/noise",
            format!(
                "{} on average, {} at most",
                ratio(summary.snr_mean),
                ratio(summary.snr_max)
            ),
        ),
        ("saturated", share(summary.saturated)),
        ("cut off below", share(summary.floored)),
    ];
    if times.len() > 1 {
        for (time, n) in times.iter().zip(&summary.taken) {
            lines.push((
                "taken from",
                format!("{} s: {}", significant(*time, 3), share(*n)),
            ));
        }
    }
    lines
        .iter()
        .map(|(key, text)| format!("{key:<13} {text}\n"))
        .collect()
}

/// A frame of counts as 16-bit grey PNG, row 0 on top as in the EXR file beside it; 65535 stands for `white`. With `white` = 65535 the
/// pixels are the counts, rounded.
///
/// # Errors
/// [`PictureError`] if the picture would be absurdly large.
pub fn counts_png(
    [columns, rows]: [usize; 2],
    counts: &[f64],
    white: f64,
) -> Result<Vec<u8>, PictureError> {
    let scale = if white > 0.0 { 65535.0 / white } else { 0.0 };
    let pixels: Vec<u16> = counts.iter().map(|c| (c * scale).round() as u16).collect();
    grey16([columns, rows], &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_keeps_to_80_columns_and_says_what_is_cut_off() {
        let summary = Summary {
            entries: 30_720_000,
            electrons_mean: 1.234_567e-12,
            electrons_max: 1.234_567e12,
            saturated: 3_072_000,
            floored: 12,
            taken: vec![27_648_000, 3_072_000],
            pedestal: 0.0,
            common: 0.0,
            snr_mean: Some(12.345),
            snr_max: None,
        };
        let table = exposure_table(&summary, &[1.0, 0.01]);
        assert!(table.lines().all(|l| l.chars().count() <= 80), "{table}");
        for words in [
            "3072000 of 30720000 (10.0 %)",
            "12.3 on average, – at most",
            "0.0100 s: ",
        ] {
            assert!(table.contains(words), "no `{words}` in {table}");
        }
    }

    /// The pixels of a PNG, read with the crate, are the counts.
    #[test]
    fn counts_are_stored_as_they_are() {
        let counts = [0.0, 1.0, 100.4, 65535.0, 256.0, 4095.0];
        let bytes = counts_png([3, 2], &counts, 65535.0).unwrap();
        let image = crate::image::decode("counts", &bytes).unwrap();
        assert_eq!(image.channels, [crate::image::Channel::Grey]);
        assert_eq!((image.width, image.height), (3, 2));
        let codes = image
            .values
            .iter()
            .map(|v| (65535.0 * f64::from(*v)).round() as u16);
        let values: Vec<u16> = codes.collect();
        assert_eq!(values, [0, 1, 100, 65535, 256, 4095]);
        // A scale for counts without end, and a black frame.
        assert!(counts_png([1, 1], &[3e9], 3e9).is_ok());
        assert!(counts_png([1, 1], &[0.0], 0.0).is_ok());
    }
}
