//! A folder of its own to run the program in.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use phicam::matrix::{Matrix, npy};

/// A temporary folder, the working directory of every command run in it.
pub(crate) struct Workspace {
    dir: tempfile::TempDir,
}

/// No command of these tests takes longer.
const LONG: Duration = Duration::from_secs(900);

/// `phicam`, started by a shell that has done `limit` before.
fn limited(limit: &str) -> assert_cmd::Command {
    let mut shell = assert_cmd::Command::new("sh");
    let line = format!("{limit} && exec \"$0\" \"$@\"");
    shell.args(["-c", &line]).arg(env!("CARGO_BIN_EXE_phicam"));
    shell
}

/// How a command ended.
#[must_use]
pub(crate) struct Ended {
    line: String,
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

/// Every file below a folder with its bytes; folders have no bytes and a name that ends in `/`.
pub(crate) type Contents = BTreeMap<String, Vec<u8>>;

impl Workspace {
    pub(crate) fn new() -> Self {
        let dir = tempfile::tempdir().expect("a temporary folder");
        Self { dir }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.text(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn matrix(&self, name: &str) -> Matrix {
        npy::read_finite(&self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Runs `phicam` with the words of `line`. A panic of the program fails the test, whatever else
    /// it expects.
    pub(crate) fn phicam(&self, line: &str) -> Ended {
        self.end(line, assert_cmd::cargo::cargo_bin_cmd!("phicam"), LONG)
    }

    /// The same, with an answer wanted in two seconds and 200 MB of memory of its own. Seconds of its
    /// processor: on a busy machine the clock runs on. One that waits for ever is ended, too.
    pub(crate) fn answers(&self, line: &str) -> Ended {
        let limit = "ulimit -d 195312 && ulimit -t 2";
        self.end(line, limited(limit), Duration::from_secs(60))
    }

    /// The same with `memory` KiB of address space.
    pub(crate) fn phicam_within(&self, memory: u64, line: &str) -> Ended {
        self.phicam_after(&format!("ulimit -v {memory}"), line)
    }

    /// The same in a shell that has done `limit` before.
    pub(crate) fn phicam_after(&self, limit: &str, line: &str) -> Ended {
        self.end(line, limited(limit), LONG)
    }

    fn end(&self, line: &str, mut command: assert_cmd::Command, most: Duration) -> Ended {
        let output = command
            .args(line.split_whitespace())
            .current_dir(self.dir.path())
            .timeout(most)
            .output()
            .expect("the program starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let ended = Ended {
            line: line.to_owned(),
            code: output.status.code().unwrap_or(-1),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        };
        assert!(!ended.stderr.contains("panicked"), "{}", ended.account());
        assert!(ended.code >= 0, "ended by a signal: {}", ended.account());
        ended
    }

    /// Runs a command that must be refused: exit code 2, every one of `words` on standard error,
    /// nothing on standard output, and not a byte of the workspace changed.
    pub(crate) fn refuses(&self, line: &str, words: &[&str]) {
        let before = self.contents("");
        self.refused(self.phicam(line), line, words, &before);
    }

    /// The same with `memory` KiB of address space.
    pub(crate) fn refuses_within(&self, memory: u64, line: &str, words: &[&str]) {
        let before = self.contents("");
        self.refused(self.phicam_within(memory, line), line, words, &before);
    }

    fn refused(&self, ended: Ended, line: &str, words: &[&str], before: &Contents) {
        let ended = ended.exits(2);
        for word in words {
            assert!(
                ended.stderr.contains(word),
                "no `{word}` in {}",
                ended.account()
            );
        }
        assert_eq!(ended.stdout, "", "{}", ended.account());
        assert_same(before, &self.contents(""), line);
    }

    /// Starts `phicam` with the words of `line`, and does not wait for it.
    #[cfg(unix)]
    pub(crate) fn begins(&self, line: &str) -> std::process::Child {
        use std::process::{Command, Stdio};
        Command::new(env!("CARGO_BIN_EXE_phicam"))
            .args(line.split_whitespace())
            .current_dir(self.dir.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts")
    }

    /// What a render leaves in `folder`, but for the record, which has times.
    pub(crate) fn rendered(&self, folder: &str) -> Contents {
        let mut contents = self.contents(folder);
        assert!(contents.remove("run.json").is_some(), "{folder}");
        contents
    }

    /// Lets the run in `folder` vouch for nothing any more, so that its files can be changed.
    pub(crate) fn disown(&self, folder: &str) {
        let file = format!("{folder}/run.json");
        let mut record = self.json(&file);
        let keys = record.as_object_mut().expect("a record");
        assert!(keys.remove("files").is_some() && keys.remove("digest").is_some());
        self.write(&file, record.to_string());
    }

    /// Every file below `folder`; an empty list if there is no such folder.
    pub(crate) fn contents(&self, folder: &str) -> Contents {
        fn walk(root: &Path, dir: &Path, found: &mut Contents) {
            for entry in fs::read_dir(dir).into_iter().flatten() {
                let path = entry.expect("a folder's entry").path();
                let name = path.strip_prefix(root).expect("it is below").display();
                if path.is_dir() {
                    found.insert(format!("{name}/"), Vec::new());
                    walk(root, &path, found);
                } else {
                    found.insert(name.to_string(), fs::read(&path).expect("a file"));
                }
            }
        }
        let root = self.path(folder);
        let mut found = Contents::new();
        walk(&root, &root, &mut found);
        found
    }
}

/// Two folders hold the same files with the same bytes; says which differ.
pub(crate) fn assert_same(a: &Contents, b: &Contents, what: &str) {
    let differ: Vec<&String> = a
        .keys()
        .chain(b.keys())
        .filter(|name| a.get(*name) != b.get(*name))
        .collect();
    assert!(differ.is_empty(), "{what}: {differ:?} differ");
}

impl Ended {
    /// The command ended with `code`.
    pub(crate) fn exits(self, code: i32) -> Self {
        assert_eq!(self.code, code, "{}", self.account());
        self
    }

    /// What happened, for a failing test.
    pub(crate) fn account(&self) -> String {
        format!(
            "`phicam {}`, exit code {}\n--- standard output\n{}\n--- standard error\n{}",
            self.line, self.code, self.stdout, self.stderr
        )
    }
}
