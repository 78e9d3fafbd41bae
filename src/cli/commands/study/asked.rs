//! study.json: by which command the results in a folder came.

use std::path::Path;

use crate::cli::failure::Failure;
use crate::jobs::Identity;
use crate::store::{harmless_json, read, write_whole};

/// Its name.
const FILE: &str = "study.json";
/// Most bytes of one.
const LARGEST: u64 = 16 << 20;
/// What to do where the folder is taken.
pub(super) const CURE: &str =
    "give the same settings, choose another folder (-o), or replace them (--replace)";

/// Leaves it, before the first result of a study that is finished.
pub(super) fn keep(folder: &Path, asked: &Identity) -> Result<(), Failure> {
    let text = harmless_json(&serde_json::to_string_pretty(asked)?) + "\n";
    Ok(write_whole(&folder.join(FILE), |w| {
        w.write_all(text.as_bytes())
    })?)
}

/// Refuses a folder with results of another study, of another scene or of other settings.
pub(super) fn refuse_other(folder: &Path, asked: &Identity) -> Result<(), Failure> {
    let path = folder.join(FILE);
    let text = match read(&path, LARGEST) {
        Err(e) if e.is_missing() => return Ok(()),
        text => text?,
    };
    let Ok(there) = serde_json::from_slice::<Identity>(&text) else {
        let cause = format!("{} is damaged", path.display());
        return Err(Failure::new(cause, CURE));
    };
    match there.difference(asked) {
        None => Ok(()),
        Some((name, found, wanted)) => Err(Failure::new(
            format!(
                "{} holds results of another study (its {name} is {found}; now asked for: {wanted})",
                folder.display()
            ),
            CURE,
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same is asked again; other settings, another scene and another study are refused, and so
    /// is what is none.
    #[test]
    fn results_of_another_study_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let of = |scene: &str, study: &str, noise: &str| {
            let of_scene = Identity::default().with("scene", scene);
            of_scene.with("study", study).with("--noise", noise)
        };
        let asked = of("bench", "sweep", "0.01");
        refuse_other(folder.path(), &asked).unwrap();
        keep(folder.path(), &asked).unwrap();
        refuse_other(folder.path(), &asked).unwrap();
        for (other, word) in [
            (of("bench", "sweep", "0.02"), "--noise is 0.01"),
            (of("thesis", "sweep", "0.01"), "scene is bench"),
            (of("bench", "power", "0.01"), "study is sweep"),
        ] {
            let refused = refuse_other(folder.path(), &other).unwrap_err();
            assert!(format!("{refused:?}").contains(word), "{refused:?}");
        }
        std::fs::write(folder.path().join(FILE), "a letter").unwrap();
        assert!(refuse_other(folder.path(), &asked).is_err());
    }
}
