use proptest::prelude::*;

use super::*;

const ID: &str = "0123456789ab";

fn names(size: usize) -> Names {
    Names::new(ID, 8, "0a0b0c0d", size)
}

fn job(name: String, id: &str, task: Option<usize>) -> Job {
    Job {
        name,
        id: id.to_owned(),
        task,
    }
}

fn set<T: Ord>(items: impl IntoIterator<Item = T>) -> BTreeSet<T> {
    items.into_iter().collect()
}

#[test]
fn the_names_tell_plan_division_and_offset() {
    let names = names(1000);
    assert_eq!(names.array(0), "phicam-0123456789ab.8");
    assert_eq!(names.array(2000), "phicam-0123456789ab.8+2000");
    assert_eq!(names.merge(), "phicam-0123456789ab.8-merge-0a0b0c0d");
    let owns = |name: &str| names.owns(&job(name.to_owned(), "1", None));
    assert!(owns(&names.array(0)) && owns(&names.array(1000)) && owns(&names.merge()));
    // The merge into another folder is one of this division, and not this one.
    assert!(owns("phicam-0123456789ab.8-merge-ffffffff"));
    assert!(!owns("phicam-0123456789ab.80") && !owns("phicam-0123456789ab.4"));
    assert!(names.array(0).starts_with(names.prefix()));
}

/// The array of the second call was submitted, and its merge was refused by Slurm.
#[test]
fn a_merge_that_does_not_wait_for_all_is_followed_by_one_that_does() {
    let names = names(10);
    let jobs = [
        job(names.array(0), "1", Some(3)),
        job(names.merge(), "2", None),
        job(names.array(0), "6", Some(4)),
    ];
    let again = Submission::new(&set([3, 4]), &jobs, false, &names);
    assert!(again.arrays.is_empty());
    assert_eq!(
        again.merge,
        Merge::Submit(set(["1", "2", "6"].map(str::to_owned)))
    );
    let other = [job(
        "phicam-0123456789ab.8-merge-ffffffff".to_owned(),
        "9",
        None,
    )];
    let here = Submission::new(&set([]), &other, false, &names);
    assert_eq!(here.merge, Merge::Submit(set([])));
}

#[test]
fn a_fresh_plan_is_one_array_and_a_merge() {
    let fresh = Submission::new(&set(0..8), &[], false, &names(1001));
    assert_eq!(
        fresh.arrays,
        [Array {
            offset: 0,
            tasks: set(0..8)
        }]
    );
    assert_eq!(fresh.merge, Merge::Submit(set([])));
    assert!(fresh.waiting.is_empty());
}

#[test]
fn what_is_queued_is_waited_for_and_not_submitted_again() {
    let names = names(10);
    let jobs = [
        job(names.array(0), "17", Some(3)),
        job(names.array(10), "18", Some(3)),
        job(names.array(0), "16", Some(9)),
        job(names.merge(), "19", None),
    ];
    // 9 runs for the second time somewhere, but is there: nobody waits for it.
    let again = Submission::new(&set([3, 5, 13]), &jobs, false, &names);
    assert_eq!(again.waiting, set([3, 13]));
    assert_eq!(
        again.arrays,
        [Array {
            offset: 0,
            tasks: set([5])
        }]
    );
    let before = ["17", "18", "19"].map(str::to_owned);
    assert_eq!(again.merge, Merge::Submit(set(before)));
    // Nothing new: the merge that is queued waits for the same jobs.
    let again = Submission::new(&set([3, 13]), &jobs, false, &names);
    assert!(again.arrays.is_empty());
    assert_eq!(again.merge, Merge::Queued("19".to_owned()));
    // The merge was cancelled.
    let again = Submission::new(&set([3, 13]), &jobs[..3], false, &names);
    assert_eq!(
        again.merge,
        Merge::Submit(set(["17", "18"].map(str::to_owned)))
    );
}

#[test]
fn nothing_missing_needs_a_merge_unless_it_is_there() {
    let names = names(10);
    let merge = |jobs: &[Job], merged| Submission::new(&set([]), jobs, merged, &names).merge;
    assert_eq!(merge(&[], false), Merge::Submit(set([])));
    assert_eq!(merge(&[], true), Merge::There);
    let queued = [job(names.merge(), "19", None)];
    assert_eq!(merge(&queued, false), Merge::Queued("19".to_owned()));
}

#[test]
fn foreign_names_are_no_shards() {
    let names = names(10);
    let stem = names.array(0);
    for name in [
        "x".to_owned(),
        format!("{stem}0"),
        format!("{stem}+x"),
        format!("x{stem}"),
        names.merge(),
    ] {
        assert_eq!(
            names.shard(&job(name.clone(), "1", Some(1))),
            None,
            "{name}"
        );
    }
    assert_eq!(
        names.shard(&job(format!("{stem}+{}", usize::MAX), "1", Some(1))),
        None
    );
    assert_eq!(names.shard(&job(stem, "1", None)), None);
}

proptest! {
    /// Missing = submitted + waiting, no shard twice, and no task's number reaches the size.
    #[test]
    fn every_missing_shard_is_submitted_or_waited_for(
        missing in prop::collection::btree_set(0_usize..200, 0..60),
        queued in prop::collection::btree_set(0_usize..200, 0..60),
        size in 1_usize..100,
    ) {
        let names = names(size);
        let jobs: Vec<Job> =
            queued.iter().map(|s| job(names.array(s - s % size), "5", Some(s % size))).collect();
        let submission = Submission::new(&missing, &jobs, false, &names);
        let mut seen = submission.waiting.clone();
        prop_assert!(seen.is_subset(&queued));
        for array in &submission.arrays {
            prop_assert!(!array.tasks.is_empty() && array.tasks.iter().all(|t| *t < size));
            for shard in array.shards() {
                prop_assert!(!queued.contains(&shard) && seen.insert(shard));
            }
        }
        prop_assert_eq!(seen, missing);
        for job in &jobs {
            prop_assert!(names.owns(job));
        }
    }
}
