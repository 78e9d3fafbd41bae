//! Which spots a folder holds frames of, told from the names of its files.

use std::path::{Path, PathBuf};

use super::StackError;

/// The files of `folder` that are named as frames, by spot.
pub(super) fn frame_files(folder: &Path) -> Result<Vec<(u32, PathBuf)>, StackError> {
    let unreadable = |source| StackError::Unreadable {
        path: folder.into(),
        source,
    };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        let digits = name
            .to_str()
            .and_then(|n| n.strip_prefix("spot-")?.strip_suffix(".exr"));
        let digits = digits.filter(|d| d.bytes().all(|b| b.is_ascii_digit()));
        if let Some(spot) = digits.and_then(|d| d.parse().ok()) {
            files.push((spot, folder.join(&name)));
        }
    }
    files.sort();
    match files.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some([(spot, first), (_, second)]) => Err(StackError::Duplicate {
            spot: *spot,
            first: first.clone(),
            second: second.clone(),
        }),
        _ => Ok(files),
    }
}

/// Checks that `files`, sorted by spot and without doubles, are of the spots 0 to `spot_count` − 1,
/// all of them.
pub(super) fn check_spots(
    folder: &Path,
    files: &[(u32, PathBuf)],
    spot_count: u32,
) -> Result<(), StackError> {
    if let Some((spot, path)) = files.iter().find(|(spot, _)| *spot >= spot_count) {
        return Err(StackError::Surplus {
            path: path.clone(),
            spot: *spot,
            spot_count,
        });
    }
    let mut next = 0;
    let mut gaps = Vec::new();
    for spot in files.iter().map(|(spot, _)| *spot).chain([spot_count]) {
        if spot > next {
            gaps.push((next, spot - 1));
        }
        next = spot.saturating_add(1);
    }
    if gaps.is_empty() {
        return Ok(());
    }
    let count = gaps.iter().map(|(from, to)| to - from + 1).sum();
    Err(StackError::Missing {
        path: folder.into(),
        count,
        spot_count,
        spots: ranges(&gaps),
    })
}

/// `3, 7-9` for the ranges (3, 3) and (7, 9); a long list ends in an ellipsis.
fn ranges(gaps: &[(u32, u32)]) -> String {
    const SHOWN: usize = 20;
    let one = |&(from, to): &(u32, u32)| {
        if from == to {
            from.to_string()
        } else {
            format!("{from}-{to}")
        }
    };
    let shown: Vec<String> = gaps.iter().take(SHOWN).map(one).collect();
    shown.join(", ") + if gaps.len() > SHOWN { ", …" } else { "" }
}
