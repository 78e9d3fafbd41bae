use std::fs;
use std::process::Command;

use super::*;
use crate::jobs::slurm::fake::Cluster;

/// The names of the array and of the merge of [`request`].
fn names(cluster: &Cluster) -> [String; 2] {
    let array = format!("phicam-0123456789ab-{}.12", short(&cluster.path("plan")));
    let merge = format!("{array}-merge-{}", short(&cluster.path("plan/merged")));
    [array, merge]
}

fn request(
    cluster: &Cluster,
    missing: impl IntoIterator<Item = usize>,
    options: &[&str],
) -> Request {
    fs::create_dir_all(cluster.path("plan")).unwrap();
    Request {
        plan: "0123456789ab".to_owned(),
        shards: 12,
        missing: missing.into_iter().collect(),
        merged: false,
        executable: "/opt/phi cam/bin/phicam".into(),
        dir: cluster.path("plan"),
        output: cluster.path("plan/merged"),
        options: options.iter().map(ToString::to_string).collect(),
    }
}

fn submit(request: &Request, cluster: &Cluster) -> Result<String, (String, String)> {
    let mut said = String::new();
    let mut say = |line: &str| {
        said.push_str(line);
        Ok(())
    };
    match request.submit::<JobError>(&cluster.slurm(), &mut say) {
        Ok(()) => Ok(said),
        Err(JobError::Usage(message) | JobError::System(message)) => Err((said, message)),
        Err(other) => panic!("{other:?}"),
    }
}

/// What sbatch is to be called with, for one job.
fn call(
    cluster: &Cluster,
    log: &str,
    options: &[&str],
    own: &[&str],
    script: &[&str],
) -> Vec<String> {
    let dir = cluster.path("plan").display().to_string();
    let first = [
        "--parsable".to_owned(),
        format!("--chdir={dir}"),
        format!("--output={}/slurm/{log}", dir.replace('%', "%%")),
    ];
    let script = script.iter().enumerate().map(|(i, s)| match i {
        0 => format!("{dir}/slurm/{s}"),
        _ => (*s).to_owned(),
    });
    let words = options.iter().chain(own).map(ToString::to_string);
    first.into_iter().chain(words).chain(script).collect()
}

#[test]
fn arrays_within_the_limit_and_a_merge_after_them() {
    let cluster = Cluster::new();
    let options = ["--partition=cpu", "-t", "2:00:00"];
    let request = request(&cluster, [0, 1, 2, 7, 10, 11], &options);
    let said = submit(&request, &cluster).unwrap();
    let array = |offset: &str, tasks: &str| {
        let name = if offset == "0" {
            names(&cluster)[0].clone()
        } else {
            format!("{}+{offset}", names(&cluster)[0])
        };
        let own = [format!("--job-name={name}"), format!("--array={tasks}")];
        let own: Vec<&str> = own.iter().map(String::as_str).collect();
        call(
            &cluster,
            "shard-%A_%a.log",
            &options,
            &own,
            &["shard.sh", offset],
        )
    };
    let merge = [
        format!("--job-name={}", names(&cluster)[1]),
        "--dependency=afterany:101:102:103".to_owned(),
    ];
    let merge: Vec<&str> = merge.iter().map(String::as_str).collect();
    assert_eq!(
        cluster.calls(),
        [
            array("0", "0-2"),
            array("5", "2"),
            array("10", "0-1"),
            call(&cluster, "merge-%j.log", &options, &merge, &["merge.sh"])
        ]
    );
    for line in [
        "shards 0-2: array of jobs 101",
        "shards 7: array of jobs 102",
        "shards 10-11: array of jobs 103",
    ] {
        assert!(said.contains(line), "no `{line}` in {said}");
    }
    assert!(
        said.contains("job 104, when 101 and 102 and 103 have ended"),
        "{said}"
    );
    for script in ["shard.sh", "merge.sh"] {
        let text = fs::read_to_string(cluster.path("plan/slurm").join(script)).unwrap();
        assert!(
            text.starts_with("#!/bin/bash\n") && text.contains("'/opt/phi cam/bin/phicam' "),
            "{text}"
        );
    }
}

#[test]
fn a_second_call_submits_only_what_is_neither_there_nor_queued() {
    let cluster = Cluster::new();
    let [array, merge] = names(&cluster);
    fs::write(
        cluster.path("queue"),
        format!("PD|51|1|{array}\nR|52|2|{array}+5\nCG|51|2|{array}\nPD|54|N/A|{merge}\n"),
    )
    .unwrap();
    let said = submit(&request(&cluster, [1, 2, 7], &[]), &cluster).unwrap();
    assert!(
        said.contains("shards 1,7: queued or running already"),
        "{said}"
    );
    let calls = cluster.calls();
    assert_eq!(calls.len(), 2, "{calls:?}");
    assert!(calls[0].contains(&"--array=2".to_owned()), "{calls:?}");
    assert!(
        calls[1].contains(&"--dependency=afterany:101:51:52:54".to_owned()),
        "{calls:?}"
    );
    // All queued: nothing is submitted, nothing written.
    fs::remove_dir_all(cluster.path("plan/slurm")).unwrap();
    let said = submit(&request(&cluster, [1, 7], &[]), &cluster).unwrap();
    assert!(
        said.contains("the merge is queued or running already: job 54"),
        "{said}"
    );
    assert!(cluster.calls().is_empty());
    assert!(!cluster.path("plan/slurm").exists());
}

#[test]
fn nothing_missing_is_merged_once() {
    let cluster = Cluster::new();
    let mut request = request(&cluster, [], &[]);
    let said = submit(&request, &cluster).unwrap();
    assert!(said.contains("job 101\n"), "{said}");
    let calls = cluster.calls();
    assert!(
        calls.len() == 1 && !calls[0].iter().any(|w| w.contains("afterany")),
        "{calls:?}"
    );
    request.merged = true;
    let said = submit(&request, &cluster).unwrap();
    assert!(said.contains("nothing to submit"), "{said}");
    assert!(cluster.calls().is_empty());
}

#[test]
fn what_was_submitted_before_a_refusal_is_said() {
    let cluster = Cluster::new();
    let sbatch = fs::read_to_string(cluster.path("sbatch")).unwrap();
    let full = "[ -e \"${0%/*}/calls\" ] && { echo 'sbatch: error: QOSMaxSubmitJobPerUserLimit' >&2; exit 1; }";
    cluster.program("sbatch", &format!("{full}\n{sbatch}"));
    let (said, message) = submit(&request(&cluster, 0..12, &[]), &cluster).unwrap_err();
    assert_eq!(said, "shards 0-4: array of jobs 101\n");
    for word in [
        "QOSMaxSubmitJobPerUserLimit",
        "cure: ",
        "not submitted twice",
    ] {
        assert!(message.contains(word), "no `{word}` in {message}");
    }
}

#[test]
fn the_rehearsal_is_a_script_that_does_the_same() {
    let cluster = Cluster::new();
    let [array, merge] = names(&cluster);
    let options = ["--comment=it's $HOME", "--time=10"];
    fs::write(
        cluster.path("queue"),
        format!("PD|55|3|{array}\nPD|56|N/A|{merge}\n"),
    )
    .unwrap();
    let request = request(&cluster, [0, 3, 4, 8], &options);
    let text = request.rehearsal(Some(&cluster.slurm())).unwrap();
    assert!(cluster.calls().is_empty() && !cluster.path("plan/slurm").exists());
    let status = Command::new("bash")
        .args(["-c", &format!("PATH=$0:$PATH\n{text}")])
        .arg(cluster.folder())
        .status()
        .unwrap();
    assert!(status.success(), "{text}");
    let scripts = || {
        ["shard", "merge"]
            .map(|s| fs::read_to_string(cluster.path(&format!("plan/slurm/{s}.sh"))).unwrap())
    };
    let (rehearsed, written) = (cluster.calls(), scripts());
    fs::remove_dir_all(cluster.path("plan/slurm")).unwrap();
    submit(&request, &cluster).unwrap();
    assert_eq!(rehearsed, cluster.calls());
    assert_eq!(written, scripts());
    assert_eq!(rehearsed.len(), 3);
    // Without a Slurm: one array, as if nothing were queued.
    let text = request.rehearsal(None).unwrap();
    assert!(text.contains("--array=0,3-4,8 "), "{text}");
}

#[test]
fn folders_that_slurm_cannot_name_are_refused() {
    let cluster = Cluster::new();
    let mut request = request(&cluster, [0], &[]);
    request.dir = cluster.path("back\\slash");
    let (_, message) = submit(&request, &cluster).unwrap_err();
    assert!(
        message.contains("backslash") && message.contains("rename"),
        "{message}"
    );
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt;
        request.dir = std::ffi::OsString::from_vec(b"/tmp/\xff".to_vec()).into();
        let (_, message) = submit(&request, &cluster).unwrap_err();
        assert!(message.contains("UTF-8"), "{message}");
    }
    assert!(cluster.calls().is_empty());
}
