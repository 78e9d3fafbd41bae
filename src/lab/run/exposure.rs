//! An exposure in words.

use super::summary::facts;
use crate::lab::finding::Finding;
use crate::num::digits::{figure, perhaps};
use crate::sensor::Summary;

/// What an exposure came to; `times` in s, the longest first.
pub fn describe_exposure(summary: &Summary, times: &[f64]) -> Finding {
    let share = |n: usize| {
        let part = 100.0 * n as f64 / summary.entries as f64;
        format!("{n} of {} ({} %)", summary.entries, figure(part, 3))
    };
    let electrons = format!(
        "{} on average, {} at most, in a frame of {} s",
        figure(summary.electrons_mean, 4),
        figure(summary.electrons_max, 4),
        times.first().map_or(String::new(), |t| figure(*t, 3))
    );
    let noise = format!(
        "{} on average, {} at most",
        perhaps(summary.snr_mean, 3),
        perhaps(summary.snr_max, 3)
    );
    let mut told = vec![
        ("electrons", electrons),
        ("signal/noise", noise),
        ("saturated", share(summary.saturated)),
        ("near an end", share(summary.near)),
        ("cut off below", share(summary.floored)),
    ];
    if times.len() > 1 {
        let taken = times.iter().zip(&summary.taken);
        told.extend(taken.map(|(time, n)| {
            let words = format!("{} s: {}", figure(*time, 3), share(*n));
            ("taken from", words)
        }));
    }
    Finding {
        tables: vec![facts(told)],
        ..Finding::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_says_what_is_cut_off_and_what_was_taken() {
        let summary = Summary {
            entries: 30_720_000,
            electrons_mean: 1.234_567e-12,
            electrons_max: 1.234_567e12,
            saturated: 3_072_000,
            near: 0,
            floored: 12,
            taken: vec![27_648_000, 3_072_000],
            pedestal: 0.0,
            common: 0.0,
            render: 0.0,
            snr_mean: Some(12.345),
            snr_max: None,
        };
        let told = format!("{:?}", describe_exposure(&summary, &[1.0, 0.01]));
        for words in [
            "3072000 of 30720000 (10.0 %)",
            "12.3 on average, – at most",
            "0.0100 s: ",
        ] {
            assert!(told.contains(words), "no `{words}` in {told}");
        }
    }
}
