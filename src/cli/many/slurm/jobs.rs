//! The jobs of a plan as commands: what sbatch is called with, and where the scripts and what the jobs say is kept.

use std::path::Path;

use super::script::{self, quote};
use super::submission::{Array, Names};
use crate::cli::failure::Failure;
use crate::cli::indices::array_syntax;
use crate::store::{StoreError, ensure_writable, write_whole};

/// Scripts and logs of the jobs, below the plan's folder.
const FOLDER: &str = "slurm";

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

/// What sbatch is called with: between the two halves stands what the job waits for.
pub(super) struct Call {
    front: Vec<String>,
    back: Vec<String>,
}

impl Jobs {
    /// `executable`, `dir` and `output` must be absolute.
    pub(super) fn new(
        executable: &Path,
        dir: &Path,
        output: &Path,
        options: &[String],
        names: Names,
    ) -> Result<Self, Failure> {
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

    pub(super) fn write_scripts(&self) -> Result<(), StoreError> {
        ensure_writable(Path::new(&self.folder))?;
        for script in &self.scripts {
            write_whole(Path::new(&script.path), |w| {
                w.write_all(script.text.as_bytes())
            })?;
        }
        Ok(())
    }

    pub(super) fn array(&self, array: &Array) -> Call {
        let tasks = array_syntax(&array.tasks);
        let own = vec![
            format!("--job-name={}", self.names.array(array.offset)),
            format!("--array={tasks}"),
        ];
        self.call(
            "shard-%A_%a.log",
            own,
            [&self.scripts[0].path, &array.offset.to_string()],
        )
    }

    pub(super) fn merge(&self) -> Call {
        let own = vec![format!("--job-name={}", self.names.merge())];
        self.call("merge-%j.log", own, [&self.scripts[1].path])
    }

    /// The user's options stand after what they may replace and before what they must not.
    fn call<const N: usize>(&self, log: &str, own: Vec<String>, script: [&str; N]) -> Call {
        let log = format!("--output={}/{log}", self.pattern);
        let first = [
            "--parsable".to_owned(),
            format!("--chdir={}", self.dir),
            log,
        ];
        Call {
            front: [&first[..], &self.options, &own].concat(),
            back: script.map(str::to_owned).to_vec(),
        }
    }
}

impl Call {
    /// The arguments, waiting for these jobs to end, however they end.
    pub(super) fn arguments(&self, after: &[String]) -> Vec<String> {
        [&self.front[..], dependency(after).as_slice(), &self.back].concat()
    }

    /// The command for a shell; `after` may be expressions of the shell, which need no quotes.
    pub(super) fn line(&self, after: &[String]) -> String {
        let quoted = |words: &[String]| words.iter().map(|w| quote(w)).collect::<Vec<_>>();
        let words = [
            &quoted(&self.front)[..],
            dependency(after).as_slice(),
            &quoted(&self.back),
        ]
        .concat();
        format!("sbatch {}", words.join(" "))
    }
}

/// Slurm's word for: start when these have ended, however they ended.
fn dependency(after: &[String]) -> Option<String> {
    (!after.is_empty()).then(|| format!("--dependency=afterany:{}", after.join(":")))
}

/// A path that can stand in a script and in an option.
fn text(path: &Path) -> Result<&str, Failure> {
    path.to_str().ok_or_else(|| {
        let cause = format!("the path {} is no UTF-8 text", path.display());
        Failure::usage(cause, "rename the folder")
    })
}

/// A folder as Slurm reads it in the name of a log: `%` starts a pattern there, and a backslash ends all patterns.
fn log_pattern(dir: &str) -> Result<String, Failure> {
    if dir.contains('\\') {
        let cause = format!("Slurm cannot write its logs to {dir}, because of the backslash");
        return Err(Failure::usage(cause, "rename the folder"));
    }
    Ok(dir.replace('%', "%%"))
}
