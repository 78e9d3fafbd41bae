use super::temporary::FORSAKEN;
use super::*;

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).unwrap();
    entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect()
}

#[test]
fn a_file_appears_whole_and_replaces_its_predecessor() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("phi.npy");
    write_whole(&path, |w| w.write_all(b"long first text")).unwrap();
    write_whole(&path, |w| w.write_all(b"second")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"second");
    assert_eq!(names(dir.path()), ["phi.npy"]);
}

#[test]
fn a_failure_midway_leaves_the_predecessor_and_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("phi.npy");
    write_whole(&path, |w| w.write_all(b"first")).unwrap();
    let full = write_whole(&path, |w| {
        w.write_all(&[1; 100_000])?;
        Err(ErrorKind::StorageFull.into())
    });
    assert!(
        matches!(&full, Err(StoreError::Failed { path: p, .. }) if *p == path),
        "{full:?}"
    );
    let said = full.unwrap_err().to_string();
    assert!(said.contains("is full; free some space"), "{said}");
    assert_eq!(fs::read(&path).unwrap(), b"first");
    assert_eq!(names(dir.path()), ["phi.npy"]);
}

#[test]
fn the_causes_are_told_apart() {
    let dir = tempfile::tempdir().unwrap();
    let write = |path: &Path| write_whole(path, |w| w.write_all(b"x"));
    let missing = write(&dir.path().join("nowhere/phi.npy"));
    let said = missing.unwrap_err().to_string();
    assert!(said.contains("its folder does not exist"), "{said}");
    let folder = write(dir.path());
    assert!(
        matches!(folder, Err(StoreError::NotAFile { .. })),
        "{folder:?}"
    );
    let file = dir.path().join("file");
    write(&file).unwrap();
    let below = write(&file.join("phi.npy"));
    assert!(
        matches!(&below, Err(StoreError::NotAFolder { path }) if *path == file),
        "{below:?}"
    );
    for (kind, word) in [
        (ErrorKind::PermissionDenied, "permission denied"),
        (ErrorKind::ReadOnlyFilesystem, "read-only"),
        (ErrorKind::FileTooLarge, "larger than files may be"),
        (ErrorKind::QuotaExceeded, "quota is full"),
    ] {
        let said = StoreError::new(&file, kind.into()).to_string();
        assert!(said.contains(word), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn a_device_is_never_replaced_and_a_file_is_readable_by_others() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt};
    // A socket stands for every device: a broken guard must not cost the machine its /dev/null.
    let dir = tempfile::tempdir().unwrap();
    let device = dir.path().join("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&device).unwrap();
    let refused = write_whole(&device, |w| w.write_all(b"x"));
    assert!(
        matches!(refused, Err(StoreError::NotAFile { .. })),
        "{refused:?}"
    );
    assert!(fs::metadata(&device).unwrap().file_type().is_socket());
    let (ours, plain) = (dir.path().join("ours"), dir.path().join("plain"));
    write_whole(&ours, |w| w.write_all(b"x")).unwrap();
    fs::write(&plain, b"x").unwrap();
    let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}

#[test]
fn ensure_writable_creates_parents_and_leaves_them_empty() {
    let dir = tempfile::tempdir().unwrap();
    let deep = dir.path().join("a/b/c");
    ensure_writable(&deep).unwrap();
    ensure_writable(&deep).unwrap();
    assert!(names(&deep).is_empty());
}

#[test]
fn ensure_writable_never_touches_a_file_and_cleans_up() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, b"precious").unwrap();
    for target in [
        file.clone(),
        file.join("below"),
        dir.path().join("new/../file/below"),
    ] {
        let refused = ensure_writable(&target);
        assert!(
            matches!(refused, Err(StoreError::NotAFolder { .. })),
            "{target:?}: {refused:?}"
        );
    }
    assert_eq!(fs::read(&file).unwrap(), b"precious");
    assert_eq!(names(dir.path()), ["file"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_a_dead_process_left_is_told_from_what_a_living_one_writes() {
    let dir = tempfile::tempdir().unwrap();
    let own = temporary(dir.path()).unwrap();
    assert!(!is_abandoned(own.path()));
    // The number of a process that has ended and was waited for is free.
    let mut child = std::process::Command::new("true").spawn().unwrap();
    let dead = child.id();
    child.wait().unwrap();
    let named = |name: String| {
        let path = dir.path().join(name);
        fs::write(&path, b"half").unwrap();
        path
    };
    assert!(is_abandoned(&named(format!(
        ".phicam-{}-{dead}-Xy.part",
        machine()
    ))));
    // Of another machine only the age tells; one from the future is left alone.
    let foreign = named(format!(".phicam-elsewhere0-{dead}-Xy.part"));
    assert!(!is_abandoned(&foreign));
    let set = |time| {
        File::options()
            .write(true)
            .open(&foreign)
            .unwrap()
            .set_modified(time)
            .unwrap();
    };
    let now = fs::metadata(&foreign).unwrap().modified().unwrap();
    set(now - 2 * FORSAKEN);
    assert!(is_abandoned(&foreign));
    set(now + 2 * FORSAKEN);
    assert!(!is_abandoned(&foreign));
    for name in ["phi.npy", ".phicam-", "x.part"] {
        assert!(!is_abandoned(&named(name.to_owned())));
    }
}

/// A folder with two files of an older result and one of somebody else.
fn older() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for name in ["joint.npy", "joint.bias.npy", "notes.txt"] {
        fs::write(dir.path().join(name), "older").unwrap();
    }
    dir
}

/// The files in `dir` with what is in them, in the order of their names.
fn told(dir: &Path) -> Vec<(String, String)> {
    let mut names = names(dir);
    names.sort();
    let read = |name: &String| fs::read_to_string(dir.join(name)).unwrap_or_default();
    let texts: Vec<String> = names.iter().map(read).collect();
    names.into_iter().zip(texts).collect()
}

#[test]
fn files_of_one_result_take_the_place_of_the_older_ones_together() {
    let dir = older();
    write_together(dir.path(), |staged| {
        fs::create_dir(staged.join("copies")).unwrap();
        write_whole(&staged.join("copies/a.ply"), |w| w.write_all(b"newer"))?;
        write_whole(&staged.join("joint.npy"), |w| w.write_all(b"newer"))?;
        let there = fs::read_to_string(dir.path().join("joint.npy")).unwrap();
        assert_eq!(there, "older", "nothing is moved before all is written");
        Ok::<_, StoreError>(vec!["joint.bias.npy".to_owned(), "not.there".to_owned()])
    })
    .unwrap();
    let [none, newer, older] = ["", "newer", "older"].map(str::to_owned);
    let due = [
        ("copies", none),
        ("joint.npy", newer.clone()),
        ("notes.txt", older),
    ];
    assert_eq!(
        told(dir.path()),
        due.map(|(name, text)| (name.to_owned(), text))
    );
    let copies = [("a.ply".to_owned(), newer)];
    assert_eq!(told(&dir.path().join("copies")), copies);
}

#[test]
fn a_result_that_cannot_be_written_leaves_the_older_one_and_nothing_else() {
    let dir = older();
    let before = told(dir.path());
    let full = write_together(dir.path(), |staged| {
        write_whole(&staged.join("joint.npy"), |w| w.write_all(b"newer"))?;
        write_whole(&staged.join("large.npy"), |_| {
            Err(ErrorKind::StorageFull.into())
        })?;
        Ok::<_, StoreError>(vec!["joint.bias.npy".to_owned()])
    });
    // It names the file that was to be, not where it was written first.
    let large = dir.path().join("large.npy");
    assert!(
        matches!(&full, Err(StoreError::Failed { path, .. }) if *path == large),
        "{full:?}"
    );
    assert_eq!(told(dir.path()), before);
    // A folder in the way of the last file stops them all.
    fs::create_dir(dir.path().join("x.npy")).unwrap();
    let before = told(dir.path());
    let stopped = write_together(dir.path(), |staged| {
        write_whole(&staged.join("joint.npy"), |w| w.write_all(b"newer"))?;
        write_whole(&staged.join("x.npy"), |w| w.write_all(b"newer"))?;
        Ok::<_, StoreError>(vec!["joint.bias.npy".to_owned()])
    });
    assert!(
        matches!(stopped, Err(StoreError::NotAFile { .. })),
        "{stopped:?}"
    );
    assert_eq!(told(dir.path()), before);
}
