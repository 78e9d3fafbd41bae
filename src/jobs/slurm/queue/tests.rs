use super::*;
use crate::jobs::slurm::fake::Cluster;

fn message(failure: JobError) -> String {
    match failure {
        JobError::System(message) => message,
        other => panic!("{other:?}"),
    }
}

#[test]
fn jobs_are_read_and_those_that_have_ended_are_not() {
    let cluster = Cluster::new();
    cluster.program(
        "squeue",
        "[ \"$*\" = '-h -r -a --me -o %t|%F|%K|%j' ] || exit 9\n\
         printf '%s\\n' 'CLUSTER: big' 'PD|17|3|one' 'R|17|4|one' 'CG|17|5|one' 'PD|18|N/A|onetwo' 'R|19|1|two'",
    );
    let jobs = cluster.slurm().jobs("one").unwrap();
    let job = |name: &str, id: &str, task| Job {
        name: name.into(),
        id: id.into(),
        task,
    };
    assert_eq!(
        jobs,
        [
            job("one", "17", Some(3)),
            job("one", "17", Some(4)),
            job("onetwo", "18", None)
        ]
    );
    cluster.program("squeue", "echo '<html>Maintenance</html>'");
    let words = message(cluster.slurm().jobs("").unwrap_err());
    assert!(
        words.contains("<html>Maintenance") && words.contains("not understood"),
        "{words}"
    );
}

#[test]
fn the_size_of_arrays_is_asked_for() {
    let cluster = Cluster::new();
    let size = |answer: &str| {
        cluster.program("scontrol", &format!("printf '%s\\n' {answer}"));
        cluster.slurm().array_size()
    };
    assert_eq!(
        size("'MaxArraySize            = 4001' 'MaxJobCount = 10'").unwrap(),
        4001
    );
    assert_eq!(size("'MaxJobCount = 10'").unwrap(), 1001);
    let words = message(size("'MaxArraySize = 0'").unwrap_err());
    assert!(
        words.contains("no arrays") && words.contains("phicam shard"),
        "{words}"
    );
}

#[test]
fn the_number_of_the_job_is_read_from_what_sbatch_says() {
    let cluster = Cluster::new();
    let submit = |lines: &str| {
        cluster.program("sbatch", lines);
        cluster.slurm().submit(&["--parsable".into()])
    };
    assert_eq!(submit("echo 17").unwrap(), "17");
    assert_eq!(submit("echo '17;big'").unwrap(), "17");
    assert_eq!(
        submit("echo 'Welcome to the cluster'; echo 17").unwrap(),
        "17"
    );
    for nonsense in ["echo Hello", "echo", "true", "echo 17x", "echo -17"] {
        let words = message(submit(nonsense).unwrap_err());
        assert!(
            words.contains("not understood") && words.contains("squeue --me"),
            "{words}"
        );
    }
    let words = message(
        submit("echo 'sbatch: error: invalid partition specified: gpu' >&2; exit 1").unwrap_err(),
    );
    for word in [
        "refuses",
        "exit status: 1",
        "invalid partition specified: gpu",
        "cure: correct the options",
    ] {
        assert!(words.contains(word), "no `{word}` in {words}");
    }
}

#[test]
fn a_machine_without_slurm_is_told_so() {
    let cluster = Cluster::new();
    let slurm = Slurm {
        sbatch: "/nowhere/sbatch".into(),
        ..cluster.slurm()
    };
    let words = message(slurm.submit(&[]).unwrap_err());
    for word in [
        "there is no `/nowhere/sbatch`",
        "cure: ",
        "login node",
        "--dry-run",
    ] {
        assert!(words.contains(word), "no `{word}` in {words}");
    }
    assert!(
        !Slurm {
            squeue: "/nowhere/squeue".into(),
            ..cluster.slurm()
        }
        .is_there()
    );
    assert!(cluster.slurm().is_there());
}
