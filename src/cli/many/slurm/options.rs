//! The options of sbatch that the user gives after `--`.

use crate::cli::failure::Failure;

/// Options that would undo what this command does with sbatch, and what to do instead.
const RESERVED: [(&[&str], &str); 7] = [
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
];

/// Refuses what cannot be passed on.
pub(super) fn check(options: &[String]) -> Result<(), Failure> {
    if let Some(first) = options.first().filter(|o| !o.starts_with('-')) {
        let cause = format!("`{first}` after `--` is no option of sbatch");
        return Err(Failure::usage(
            cause,
            "write options only, e.g. `-- --partition=cpu --time=2:00:00`",
        ));
    }
    for option in options {
        for (names, cure) in RESERVED {
            if names.iter().any(|name| is(option, name)) {
                return Err(Failure::usage(
                    format!("`{option}` cannot be passed on to sbatch"),
                    cure,
                ));
            }
        }
    }
    Ok(())
}

/// Whether `option` is the option `name`, alone or with its value: `--array=1`, `-a1`.
fn is(option: &str, name: &str) -> bool {
    match option.strip_prefix(name) {
        Some(value) if name.starts_with("--") => value.is_empty() || value.starts_with('='),
        Some(_) => true,
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(words: &[&str]) -> Option<String> {
        let options: Vec<String> = words.iter().map(ToString::to_string).collect();
        match check(&options) {
            Err(Failure::Usage(message)) => Some(message),
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
        ] {
            let message = refusal(&["--time=10", option]).unwrap_or_default();
            assert!(
                message.contains(option) && message.contains(cure),
                "{option}: {message}"
            );
        }
        let script = refusal(&["job.sh"]).unwrap_or_default();
        assert!(script.contains("`job.sh`"), "{script}");
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
