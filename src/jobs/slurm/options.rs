//! The options of sbatch that the user gives after `--`.

use crate::jobs::JobError;

/// Options that would undo what this command does with sbatch, and what to do instead.
const RESERVED: [(&[&str], &str); 8] = [
    (
        &["-a", "--array"],
        "leave it out: the missing shards are the array",
    ),
    (
        &["-J", "--job-name"],
        "leave it out: by their names the jobs of a plan are found again",
    ),
    (
        &["-M", "--clusters", "--cluster"],
        "set SLURM_CLUSTERS in the environment instead, which squeue and scontrol read, too",
    ),
    (
        &["-Q", "--quiet"],
        "leave it out: sbatch has to say the job's number",
    ),
    (&["--parsable"], "leave it out: it is given already"),
    (&["--test-only"], "use `phicam slurm --dry-run`"),
    (&["--wrap"], "leave it out: the job scripts are phicam's"),
    (
        &["-W", "--wait"],
        "leave it out: the merge is submitted before the shards have ended",
    ),
];

/// Refuses what cannot be passed on.
pub fn check(options: &[String]) -> Result<(), JobError> {
    let dashed = |word: &String| word.starts_with('-');
    // One word may be the value of the option before it; the next would be taken for the job
    // script.
    let first = options.first().filter(|o| !dashed(o));
    let second = || {
        options
            .windows(2)
            .find(|w| !dashed(&w[0]) && !dashed(&w[1]))
    };
    if let Some(stray) = first.or_else(|| second().map(|w| &w[1])) {
        let cause = format!("`{stray}` after `--` is no option of sbatch");
        return Err(JobError::usage(
            cause,
            "write options only, e.g. `-- --partition=cpu --time=2:00:00`",
        ));
    }
    for option in options {
        for (names, cure) in RESERVED {
            if names.iter().any(|name| is(option, name)) {
                return Err(JobError::usage(
                    format!("`{option}` cannot be passed on to sbatch"),
                    cure,
                ));
            }
        }
    }
    Ok(())
}

/// Whether `option` is the option `name`, alone or with its value, or abridged as sbatch allows:
/// `--array=1`, `-a1`, `--arr=1`.
fn is(option: &str, name: &str) -> bool {
    match option.strip_prefix("--") {
        None => !name.starts_with("--") && option.starts_with(name),
        Some(long) => {
            let word = long.split('=').next().unwrap_or("");
            let own = name.strip_prefix("--");
            !word.is_empty() && own.is_some_and(|own| own.starts_with(word))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(words: &[&str]) -> Option<String> {
        let options: Vec<String> = words.iter().map(ToString::to_string).collect();
        match check(&options) {
            Err(JobError::Usage(message)) => Some(message),
            Err(other) => panic!("{other:?}"),
            Ok(()) => None,
        }
    }

    #[test]
    fn what_would_undo_the_submission_is_refused() {
        for (option, cure) in [
            ("--array=0-7", "missing shards"),
            ("-a0-7", "missing shards"),
            ("-Jmine", "found again"),
            ("--job-name", "found again"),
            ("-Mother", "SLURM_CLUSTERS"),
            ("--quiet", "job's number"),
            ("--test-only", "--dry-run"),
            ("--wrap=true", "phicam's"),
            ("--arr=0-3", "missing shards"),
            ("-W", "before the shards"),
        ] {
            let message = refusal(&["--time=10", option]).unwrap_or_default();
            assert!(
                message.contains(option) && message.contains(cure),
                "{option}: {message}"
            );
        }
        for words in [&["job.sh"][..], &["--time", "10", "job.sh"]] {
            let script = refusal(words).unwrap_or_default();
            assert!(script.contains("`job.sh`"), "{script}");
        }
    }

    #[test]
    fn other_options_pass() {
        let options = [
            "-pgpu",
            "-A",
            "lab",
            "--array-like",
            "--mem=4G",
            "--no-requeue",
            "-d",
            "singleton",
        ];
        assert_eq!(refusal(&options), None);
        assert_eq!(refusal(&[]), None);
    }
}
