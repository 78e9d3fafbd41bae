use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::*;
use crate::jobs::slurm::fake::program;

/// A folder whose name needs quotes everywhere, with a `phicam` and a `scontrol` that write down
/// how they are called.
struct Node {
    root: tempfile::TempDir,
}

impl Node {
    /// `phicam` does what the lines of `shard` say.
    fn new(shard: &str) -> Self {
        let root = tempfile::Builder::new()
            .prefix("it's a $(touch pwned) \"node\" %j")
            .tempdir()
            .unwrap();
        let node = Self { root };
        node.program(
            "phicam",
            &format!("printf '%s\\n' \"$@\" >\"${{0%/*}}/called\"\n{shard}"),
        );
        node.program(
            "scontrol",
            "case $1 in --oneliner) cat \"${0%/*}/state\"; exit ;; esac\nprintf '%s\\n' \"$@\" >>\"${0%/*}/requeued\"",
        );
        fs::write(node.root.path().join("state"), "JobId=17 JobState=RUNNING").unwrap();
        fs::write(
            node.root.path().join("job.sh"),
            super::shard(&node.path("phicam"), &node.path("plan")),
        )
        .unwrap();
        node
    }

    fn program(&self, name: &str, lines: &str) {
        program(&self.root.path().join(name), lines);
    }

    fn path(&self, name: &str) -> String {
        self.root.path().join(name).to_str().unwrap().to_owned()
    }

    fn lines(&self, name: &str) -> Vec<String> {
        let text = fs::read_to_string(self.path(name)).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }

    /// The job as Slurm would start it: task 3 of array 17, started again `restarts` times.
    fn job(&self, restarts: u32) -> Command {
        let mut job = Command::new("bash");
        job.args(["-c", "PATH=$0:$PATH exec bash \"$@\""])
            .arg(self.root.path())
            .arg(self.path("job.sh"))
            .arg("1000")
            .current_dir(self.root.path())
            .envs([
                ("SLURM_ARRAY_JOB_ID", "17"),
                ("SLURM_ARRAY_TASK_ID", "3"),
                ("SLURM_CPUS_ON_NODE", "6"),
            ])
            .env_remove("SLURM_RESTART_COUNT")
            .stderr(Stdio::null());
        if restarts > 0 {
            job.env("SLURM_RESTART_COUNT", restarts.to_string());
        }
        job
    }

    /// Runs the job, sending its shell `signals` as soon as the shard has begun; its exit code.
    fn run(&self, restarts: u32, signals: &[&str]) -> Option<i32> {
        let _ = fs::remove_file(self.path("requeued"));
        let _ = fs::remove_file(self.path("begun"));
        let mut child = self.job(restarts).spawn().unwrap();
        for signal in signals {
            for _ in 0..4000 {
                if Path::new(&self.path("begun")).exists() {
                    break;
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            let line = format!("kill -{signal} {}", child.id());
            assert!(
                Command::new("sh")
                    .args(["-c", &line])
                    .status()
                    .unwrap()
                    .success()
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        child.wait().unwrap().code()
    }
}

/// A shard that goes on until it is told to stop, then takes a while for the block it has begun.
const STOPPABLE: &str =
    "trap 'sleep 0.3; exit 75' TERM\n: >\"${0%/*}/begun\"\nfor i in {1..200}; do sleep 0.05; done";

#[test]
fn words_survive_the_shell() {
    for text in [
        "plain-1.2/x",
        "",
        "a b",
        "it's",
        "$(rm -rf .)",
        "a\nb",
        "`x`",
        "*",
        "ä",
        "!",
        "\\",
        "-n",
    ] {
        let echoed = Command::new("bash")
            .arg("-c")
            .arg(format!("printf %s {}", quote(text)))
            .output()
            .unwrap();
        assert_eq!(String::from_utf8(echoed.stdout).unwrap(), text);
    }
}

#[test]
fn the_shard_is_called_with_its_index_and_the_nodes_share_of_threads() {
    let node = Node::new("exit 0");
    assert_eq!(node.run(0, &[]), Some(0));
    let plan = node.path("plan");
    assert_eq!(
        node.lines("called"),
        ["shard", plan.as_str(), "--index", "1003", "--threads", "6"]
    );
    assert!(!Path::new(&node.path("pwned")).exists());
}

#[test]
fn a_disk_error_is_tried_again_twice_and_nothing_else_is() {
    for (code, restarts, again) in [
        (74, 0, true),
        (74, 1, true),
        (74, 2, false),
        (74, 3, false),
        (0, 0, false),
        (2, 0, false),
        (64, 0, false),
        (65, 0, false),
        (75, 0, false),
        (137, 0, false),
    ] {
        let node = Node::new(&format!("exit {code}"));
        assert_eq!(node.run(restarts, &[]), Some(code));
        let expected: &[&str] = if again { &["requeue", "17_3"] } else { &[] };
        assert_eq!(
            node.lines("requeued"),
            expected,
            "code {code} after {restarts} restarts"
        );
    }
}

#[test]
fn the_warning_reaches_the_shard_which_goes_on_later() {
    let node = Node::new(STOPPABLE);
    for (restarts, again) in [(0, true), (19, true), (20, false)] {
        assert_eq!(node.run(restarts, &["USR1"]), Some(75));
        assert_eq!(
            !node.lines("requeued").is_empty(),
            again,
            "after {restarts} restarts"
        );
    }
    // A second warning, while the shard is finishing its block, changes nothing.
    let node = Node::new(&STOPPABLE.replace("exit 75", "trap '' TERM; exit 75"));
    assert_eq!(node.run(0, &["USR1", "TERM"]), Some(75));
}

#[test]
fn a_cancelled_job_waits_for_its_shard_and_is_not_started_again() {
    // TERM goes to every process of a job: here to the shell alone, which must neither die of it
    // nor pass it on.
    let node = Node::new(": >\"${0%/*}/begun\"\nsleep 0.5\nexit 75");
    assert_eq!(node.run(0, &["TERM"]), Some(75));
    assert!(node.lines("requeued").is_empty());
}

#[test]
fn the_merge_is_the_job_itself() {
    let node = Node::new("echo $$ >\"${0%/*}/pid\"\nexit 66");
    fs::write(
        node.path("merge.sh"),
        merge(
            &node.path("phicam"),
            &node.path("plan"),
            &node.path("out put"),
        ),
    )
    .unwrap();
    let mut child = Command::new("bash")
        .arg(node.path("merge.sh"))
        .spawn()
        .unwrap();
    let id = child.id().to_string();
    assert_eq!(child.wait().unwrap().code(), Some(66));
    assert_eq!(
        node.lines("called"),
        ["merge", &node.path("plan"), "-o", &node.path("out put")]
    );
    assert_eq!(node.lines("pid"), [id]);
}
