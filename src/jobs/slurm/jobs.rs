//! The jobs of a plan as commands: what sbatch is called with, and where the scripts and what the
//! jobs say is kept.

use std::path::Path;

use super::script::{self, quote};
use super::submission::{Array, Names};
use crate::jobs::JobError;
use crate::jobs::indices::array_syntax;
use crate::store::{ensure_writable, write_whole};

/// Scripts and logs of the jobs, below the plan's folder.
const FOLDER: &str = "slurm";
const DEPENDENCY: &str = "--dependency=afterany:";

/// All that is the same for each job of one call. Paths are absolute: a job starts somewhere else.
pub(super) struct Jobs {
    dir: String,
    /// DIR/slurm.
    folder: String,
    /// The same, as Slurm reads the names of logs.
    pattern: String,
    scripts: [Script; 2],
    options: Vec<String>,
    names: Names,
}

/// A job script.
pub(super) struct Script {
    pub path: String,
    pub text: String,
}

impl Jobs {
    /// `executable`, `dir` and `output` must be absolute.
    pub(super) fn new(
        executable: &Path,
        dir: &Path,
        output: &Path,
        options: &[String],
        names: Names,
    ) -> Result<Self, JobError> {
        let [executable, dir, output] = [text(executable)?, text(dir)?, text(output)?];
        let folder = format!("{dir}/{FOLDER}");
        let script = |name: &str, text: String| Script {
            path: format!("{folder}/{name}.sh"),
            text,
        };
        let scripts = [
            script("shard", script::shard(executable, dir)),
            script("merge", script::merge(executable, dir, output)),
        ];
        Ok(Self {
            dir: dir.to_owned(),
            pattern: log_pattern(&folder)?,
            folder,
            scripts,
            options: options.to_vec(),
            names,
        })
    }

    pub(super) fn folder(&self) -> &str {
        &self.folder
    }

    pub(super) fn scripts(&self) -> &[Script] {
        &self.scripts
    }

    pub(super) fn write_scripts(&self) -> Result<(), JobError> {
        ensure_writable(Path::new(&self.folder))?;
        for script in &self.scripts {
            write_whole(Path::new(&script.path), |w| {
                w.write_all(script.text.as_bytes())
            })?;
        }
        Ok(())
    }

    /// What sbatch is called with for an array of shards.
    pub(super) fn array(&self, array: &Array) -> Vec<String> {
        let own = vec![
            format!("--job-name={}", self.names.array(array.offset)),
            format!("--array={}", array_syntax(&array.tasks)),
        ];
        let script = [&self.scripts[0].path, &array.offset.to_string()].map(Clone::clone);
        self.call("shard-%A_%a.log", own, script)
    }

    /// What sbatch is called with for the merge, which starts when the jobs `after` have ended,
    /// however they ended.
    pub(super) fn merge(&self, after: &[String]) -> Vec<String> {
        let mut own = vec![format!("--job-name={}", self.names.merge())];
        if !after.is_empty() {
            own.push(format!("{DEPENDENCY}{}", after.join(":")));
        }
        self.call("merge-%j.log", own, [self.scripts[1].path.clone()])
    }

    /// The user's options stand after what they may replace and before what they must not.
    fn call<const N: usize>(
        &self,
        log: &str,
        own: Vec<String>,
        script: [String; N],
    ) -> Vec<String> {
        let first = [
            "--parsable".to_owned(),
            format!("--chdir={}", self.dir),
            format!("--output={}/{log}", self.pattern),
        ];
        [&first, &self.options[..], &own, &script].concat()
    }
}

/// The call of sbatch for a shell. What a job waits for may be expressions of the shell, which need
/// no quotes.
pub(super) fn line(arguments: &[String]) -> String {
    let word = |w: &String| {
        if w.starts_with(DEPENDENCY) {
            w.clone()
        } else {
            quote(w)
        }
    };
    let words: Vec<String> = arguments.iter().map(word).collect();
    format!("sbatch {}", words.join(" "))
}

/// A path that can stand in a script and in an option.
fn text(path: &Path) -> Result<&str, JobError> {
    path.to_str().ok_or_else(|| {
        let cause = format!("the path {} is no UTF-8 text", path.display());
        JobError::usage(cause, "rename the folder")
    })
}

/// A folder as Slurm reads it in the name of a log: `%` starts a pattern there, and a backslash
/// ends all patterns.
fn log_pattern(dir: &str) -> Result<String, JobError> {
    if dir.contains('\\') {
        let cause = format!("Slurm cannot write its logs to {dir}, because of the backslash");
        return Err(JobError::usage(cause, "rename the folder"));
    }
    Ok(dir.replace('%', "%%"))
}
