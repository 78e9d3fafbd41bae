//! File names by pattern, in the order of their numbers.

use std::path::{Path, PathBuf};

use super::error::{PhotographError, refused};
use super::set::Files;

/// Most files of a set.
const MOST: usize = 1 << 20;

/// The files that `files` names below `folder`, in order.
///
/// # Errors
/// [`PhotographError::Refused`] for a pattern that no file has, for names without a number, and for
/// numbers that are missing or double.
pub(super) fn expanded(folder: &Path, files: &Files) -> Result<Vec<PathBuf>, PhotographError> {
    match files {
        Files::One(name) => matching(folder, name),
        Files::Several(names) => {
            let mut all = Vec::new();
            for name in names {
                all.extend(matching(folder, name)?);
            }
            Ok(all)
        }
    }
}

/// The file `name`, or those of the pattern by the last number in their names.
fn matching(folder: &Path, name: &str) -> Result<Vec<PathBuf>, PhotographError> {
    let path = folder.join(name);
    if !name.contains(['*', '?']) {
        return Ok(vec![path]);
    }
    let pattern = path.file_name().map(|n| n.to_string_lossy().into_owned());
    let (Some(pattern), Some(dir)) = (pattern, path.parent()) else {
        return Err(refused(
            format!("`{name}` is no pattern of files"),
            "end it with a file's name",
        ));
    };
    let dir = if dir.as_os_str().is_empty() {
        Path::new(".")
    } else {
        dir
    };
    if dir.to_string_lossy().contains(['*', '?']) {
        return Err(refused(
            format!("`{name}` has a pattern in the name of a folder"),
            "use * and ? in the name of the file only",
        ));
    }
    let cannot = |e: std::io::Error| {
        refused(
            format!("the folder {} cannot be read: {e}", dir.display()),
            "check that it exists",
        )
    };
    let mut found: Vec<(u64, PathBuf)> = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(cannot)? {
        let entry = entry.map_err(cannot)?;
        let own = entry.file_name().to_string_lossy().into_owned();
        if !fits(pattern.as_bytes(), own.as_bytes()) {
            continue;
        }
        let number = last_number(&own).ok_or_else(|| {
            refused(
                format!("`{own}` fits `{name}`, but has no number to order it by"),
                "give a narrower pattern, or a list of files",
            )
        })?;
        found.push((number, entry.path()));
        if found.len() > MOST {
            return Err(refused(
                format!("`{name}` fits more than {MOST} files"),
                "give a narrower pattern",
            ));
        }
    }
    if found.is_empty() {
        return Err(refused(
            format!("no file in {} fits `{pattern}`", dir.display()),
            "check the pattern and the folder (--from)",
        ));
    }
    found.sort();
    for pair in found.windows(2) {
        let ([a, b], [first, second]) = ([pair[0].0, pair[1].0], [&pair[0].1, &pair[1].1]);
        if a == b {
            return Err(refused(
                format!(
                    "{} and {} have the same number: the last one in a name orders the files",
                    first.display(),
                    second.display()
                ),
                "number all files on, repeats of a spot one after the other, or give a list of files ([[frame]])",
            ));
        }
        if b != a + 1 {
            return Err(refused(
                format!(
                    "between {} and {} files are missing",
                    first.display(),
                    second.display()
                ),
                "add them, or give a list of files that says which spot each is ([[frame]])",
            ));
        }
    }
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// The last number in a file's name, its extension left out.
fn last_number(name: &str) -> Option<u64> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end].rfind(|c: char| !c.is_ascii_digit());
    stem[start.map_or(0, |s| {
        s + stem[s..].chars().next().map_or(1, char::len_utf8)
    })..end]
        .parse()
        .ok()
}

/// Whether `name` fits `pattern`: `*` is any run of letters, `?` any one.
fn fits(pattern: &[u8], name: &[u8]) -> bool {
    let (mut p, mut n) = (0, 0);
    let mut again: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some(b'*') => {
                again = Some((p + 1, n));
                p += 1;
            }
            Some(c) if *c == b'?' || *c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => match again {
                Some((after, from)) => {
                    (p, n) = (after, from + 1);
                    again = Some((after, from + 1));
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fit_and_are_ordered_by_their_numbers() {
        for (pattern, name, due) in [
            ("a*.png", "a12.png", true),
            ("a*.png", "b12.png", false),
            ("a?.png", "a12.png", false),
            ("*_*.p*g", "in_put_3.png", true),
            ("a*", "a", true),
        ] {
            assert_eq!(
                fits(pattern.as_bytes(), name.as_bytes()),
                due,
                "{pattern} {name}"
            );
        }
        assert_eq!(last_number("IMG_0412_b.tif"), Some(412));
        assert_eq!(last_number("spot-3-b.png"), Some(3));
        assert_eq!(last_number("é7.png"), Some(7));
        assert_eq!(last_number("flat.png"), None);
        let dir = tempfile::tempdir().unwrap();
        let touch = |name: &str| std::fs::write(dir.path().join(name), b"").unwrap();
        for k in [10, 9, 11] {
            touch(&format!("i{k}.png"));
        }
        let all = |pattern: &str| expanded(dir.path(), &Files::One(pattern.to_owned()));
        let names: Vec<String> = all("i*.png")
            .unwrap()
            .iter()
            .map(|p| p.file_name().unwrap().to_string_lossy().into_owned())
            .collect();
        assert_eq!(names, ["i9.png", "i10.png", "i11.png"]);
        touch("i13.png");
        let words = |pattern: &str| all(pattern).unwrap_err().to_string();
        assert!(words("i*.png").contains("i11.png and") && words("i*.png").contains("missing"));
        touch("i013.png");
        assert!(words("i*3.png").contains("same number"));
        assert!(words("x*").contains("no file"));
        touch("other.png");
        assert!(words("*.png").contains("no number"));
    }
}
