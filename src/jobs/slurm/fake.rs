//! A cluster for tests: `sbatch`, `squeue` and `scontrol` are small scripts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::queue::Slurm;

pub(super) struct Cluster {
    root: tempfile::TempDir,
}

impl Cluster {
    /// Arrays of at most 5, an empty queue, and an sbatch that writes down how it is called and
    /// answers 101, 102, …
    pub(super) fn new() -> Self {
        let root = tempfile::Builder::new()
            .prefix("a %cluster's")
            .tempdir()
            .unwrap();
        let cluster = Self { root };
        cluster.program("scontrol", "echo 'MaxArraySize = 5'");
        cluster.program("squeue", "[ \"$1\" = --version ] || cat \"${0%/*}/queue\"");
        cluster.program(
            "sbatch",
            "calls=\"${0%/*}/calls\"\n\
             printf '%s\\n' \"$@\" . >>\"$calls\"\n\
             echo $((100 + $(grep -cx '\\.' \"$calls\")))",
        );
        fs::write(cluster.path("queue"), "").unwrap();
        cluster
    }

    pub(super) fn program(&self, name: &str, lines: &str) {
        program(&self.path(name), lines);
    }

    pub(super) fn folder(&self) -> &Path {
        self.root.path()
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    pub(super) fn slurm(&self) -> Slurm {
        Slurm {
            sbatch: self.path("sbatch"),
            squeue: self.path("squeue"),
            scontrol: self.path("scontrol"),
            hidden: Vec::new(),
        }
    }

    /// How sbatch was called, call by call; forgotten then.
    pub(super) fn calls(&self) -> Vec<Vec<String>> {
        let text = fs::read_to_string(self.path("calls")).unwrap_or_default();
        let _ = fs::remove_file(self.path("calls"));
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines
            .split(|line| line == ".")
            .filter(|call| !call.is_empty())
            .map(<[String]>::to_vec)
            .collect()
    }
}

/// Writes an executable script. A process of its own does: a file that this one had open for
/// writing could still be so in a program that another thread has just started, and then the system
/// does not run it.
pub(super) fn program(path: &Path, lines: &str) {
    let write = r#"printf '#!/bin/bash\n%s\n' "$2" >"$1" && chmod 755 "$1""#;
    let status = Command::new("sh")
        .args(["-c", write, "sh"])
        .arg(path)
        .arg(lines)
        .status();
    assert!(status.unwrap().success());
}
