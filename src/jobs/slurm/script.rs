//! The texts of the job scripts.

use crate::store::shell_word;

/// Restarts that a shard may ask for after an error of the disk (exit code 74).
const RESTARTS_DISK: u32 = 2;
/// Restarts that a shard may ask for after the warning that its time is over (exit code 75).
const RESTARTS_TIME: u32 = 20;

/// `text` as one word of bash. What is not printable ASCII is spelled by its bytes: a terminal
/// might obey it, and a line feed could end the document that a script is printed in.
pub(super) fn quote(text: &str) -> String {
    if !text.bytes().all(|b| matches!(b, b' '..=b'~')) {
        let byte = |b: u8| match b {
            b'\'' | b'\\' => format!("\\{}", char::from(b)),
            b' '..=b'~' => char::from(b).to_string(),
            _ => format!("\\x{b:02x}"),
        };
        return format!("$'{}'", text.bytes().map(byte).collect::<String>());
    }
    shell_word(text)
}

/// The script of the array. Its argument is what the task's number in the array is added to, since
/// no such number may reach Slurm's MaxArraySize.
///
/// Slurm warns a minute before the time limit: with USR1, and only the shell, so that the shell can
/// tell this from the TERM which every process of the job gets when the job is cancelled. It passes
/// the warning on as TERM; the shard then finishes what it has begun, keeps it and exits with 75,
/// and the shell asks for another slice of time. After 74 (the disk) it asks to be started again,
/// too, on any node. `wait` returns early when a signal comes, and gives the exit code of a process
/// that has ended any number of times: so it is called again as long as one came.
pub(super) fn shard(executable: &str, dir: &str) -> String {
    let (executable, dir) = (quote(executable), quote(dir));
    format!(
        r#"#!/bin/bash
# Written by `phicam slurm`: one shard of a plan.
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@60
shard=
warned=
trap 'warned=yes; again=yes; [ -z "$shard" ] || kill -TERM "$shard"' USR1
trap 'again=yes' TERM

index=$((${{1:-0}} + SLURM_ARRAY_TASK_ID))
{executable} shard {dir} --index "$index" --threads "${{SLURM_CPUS_ON_NODE:-1}}" &
shard=$!
[ -z "$warned" ] || kill -TERM "$shard"
again=yes
while [ "$again" ]; do
    again=
    wait "$shard"
    code=$?
done

restarts=0
case $code in
74) restarts={RESTARTS_DISK} ;;
75) [ -z "$warned" ] || restarts={RESTARTS_TIME} ;;
esac
# What is being cancelled is not to be revived.
state=$(scontrol --oneliner show job "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID" 2>/dev/null)
case $state in
*JobState=CANCELLED* | *JobState=COMPLETING*) restarts=0 ;;
esac
if [ "${{SLURM_RESTART_COUNT:-0}}" -lt "$restarts" ]; then
    echo "shard $index ended with $code: to be started again" >&2
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
"#
    )
}

/// The script of the merge.
pub(super) fn merge(executable: &str, dir: &str, output: &str) -> String {
    let [executable, dir, output] = [executable, dir, output].map(quote);
    format!(
        r#"#!/bin/bash
# Written by `phicam slurm`: the merge of a plan's shards.
#SBATCH --requeue
#SBATCH --open-mode=append
exec {executable} merge {dir} -o {output}
"#
    )
}

#[cfg(all(test, unix))]
mod tests;
