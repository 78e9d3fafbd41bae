use std::fs;

use super::replacing::{INCOMING, REPLACEMENT};
use super::*;
use crate::cli::output;
use crate::folder::{Origin, Photographs};

const QUIET: Console<'static> = Console {
    quiet: true,
    also_read: &[],
    define: &[],
};

fn scene(name: &str) -> Scene {
    QUIET.load_any_scene(name).unwrap()
}

fn imported(scene: &Scene) -> Record {
    let photographs = Photographs {
        settings: "all".to_owned(),
        flux_unit: "counts".to_owned(),
        shares_by_pixel: false,
        noise_unknown: 0.0,
        frame_gain: None,
        sources: Vec::new(),
    };
    let origin = Origin::Imported {
        imported: photographs,
    };
    Record::new(scene, origin, scene.laser.spots.len(), 1, 0.0)
}

/// Writes an import whose Φcam is `phi` into `dir`.
fn fill(dir: &Path, record: &Record, phi: &[u8]) {
    output::write(&dir.join(PHI), phi).unwrap();
    record.write(dir).unwrap();
}

fn put(dir: &Path, scene: &Scene, replace: bool) -> Result<(), Failure> {
    let _lock = RunFolder::lock(dir, "test")?;
    RunFolder::at(dir).put(scene, QUIET, replace, |staged| {
        fill(staged, &imported(scene), b"new");
        Ok(())
    })
}

/// `--replace` is for imports: a Φcam of unknown origin and the scene of others stay.
#[test]
fn what_is_no_import_is_not_replaced_by_one() {
    let bench = scene("bench");
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::write(at(PHI), b"old").unwrap();
    for replace in [false, true] {
        assert!(put(dir.path(), &bench, replace).is_err());
        assert_eq!(fs::read(at(PHI)).unwrap(), b"old");
    }
    fs::remove_file(at(PHI)).unwrap();
    fs::write(at(SCENE), "of others").unwrap();
    assert!(put(dir.path(), &bench, true).is_err());
    assert_eq!(fs::read(at(SCENE)).unwrap(), b"of others");
    fs::remove_file(at(SCENE)).unwrap();
    // An import, and of another scene too.
    put(dir.path(), &bench, false).unwrap();
    fill(dir.path(), &imported(&scene("card")), b"old");
    put(dir.path(), &bench, true).unwrap();
    assert_eq!(fs::read(at(PHI)).unwrap(), b"new");
}

/// A process that ended after the old import's record was removed, and one that ended while it
/// moved the new one in: who takes the lock next goes on.
#[test]
fn an_interrupted_replacement_is_finished_under_the_lock() {
    let bench = scene("bench");
    for folder in [REPLACEMENT, INCOMING] {
        let dir = tempfile::tempdir().unwrap();
        let staged = dir.path().join(folder);
        fs::create_dir(&staged).unwrap();
        fill(&staged, &imported(&bench), b"new");
        fs::write(dir.path().join(PHI), b"old").unwrap();
        let _lock = RunFolder::lock(dir.path(), "test").unwrap();
        assert_eq!(fs::read(dir.path().join(PHI)).unwrap(), b"new");
        assert!(Record::read(dir.path()).unwrap().unwrap().is_imported());
        assert!(!staged.exists());
    }
}
