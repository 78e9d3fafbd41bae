use super::*;

fn take(folder: &Path, parts: Range<u64>) -> Result<FolderLock, LockError> {
    let none = || Ok::<(), LockError>(());
    FolderLock::take(folder, &parts, "a render", none).map(|(lock, ())| lock)
}

#[test]
fn disjoint_parts_are_written_side_by_side_and_no_part_twice() {
    let dir = tempfile::tempdir().unwrap();
    let first = take(dir.path(), 0..5).unwrap();
    let second = take(dir.path(), 5..9).unwrap();
    for parts in [0..1, 4..6, 8..20, 0..u64::MAX] {
        let error = take(dir.path(), parts).unwrap_err().to_string();
        assert!(
            error.contains("is being written: a render, process"),
            "{error}"
        );
    }
    drop(first);
    drop(take(dir.path(), 0..5).unwrap());
    drop(second);
    drop(take(dir.path(), 0..u64::MAX).unwrap());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn the_file_of_a_process_that_is_gone_is_removed() {
    let dir = tempfile::tempdir().unwrap();
    // Nobody holds it locked: its process has ended.
    let stale = dir
        .path()
        .join(format!("{PREFIX}{}-1-0-7{SUFFIX}", machine()));
    fs::write(&stale, "a render").unwrap();
    let lock = take(dir.path(), 3..4).unwrap();
    assert!(!stale.exists());
    drop(lock);
}

#[test]
fn who_changes_what_all_share_is_alone() {
    let dir = tempfile::tempdir().unwrap();
    let inside = std::sync::atomic::AtomicUsize::new(0);
    let locks: Vec<FolderLock> = (0..4)
        .map(|k| take(dir.path(), k..k + 1).unwrap())
        .collect();
    let most_seen = std::thread::scope(|scope| {
        let inside = &inside;
        let work = |lock: FolderLock| {
            scope.spawn(move || {
                let count = || {
                    use std::sync::atomic::Ordering::SeqCst;
                    let now = inside.fetch_add(1, SeqCst) + 1;
                    sleep(Duration::from_millis(5));
                    inside.fetch_sub(1, SeqCst);
                    Ok::<usize, LockError>(now)
                };
                (0..5).map(|_| lock.alone(count).unwrap()).max()
            })
        };
        let threads: Vec<_> = locks.into_iter().map(work).collect();
        threads.into_iter().filter_map(|t| t.join().unwrap()).max()
    });
    assert_eq!(most_seen, Some(1));
}

#[test]
fn what_is_done_first_is_refused_with_its_own_words() {
    let dir = tempfile::tempdir().unwrap();
    #[derive(Debug)]
    struct Other;
    impl From<LockError> for Other {
        fn from(_: LockError) -> Self {
            Self
        }
    }
    assert!(FolderLock::take(dir.path(), &(0..1), "a render", || Err::<(), Other>(Other)).is_err());
    // The right is given back.
    drop(take(dir.path(), 0..1).unwrap());
}
