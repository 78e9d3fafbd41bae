#!/usr/bin/env bash
# A plan on a real Slurm of two nodes, with accidents: a task is killed in the middle of its write, a node dies with its job. Nothing may be lost, nothing be
# computed twice, and the bits must be those of one process.
#
#   use: tests/slurm/check.sh [PHICAM]        # target/release/phicam unless given
#
# Fails where Slurm is missing: a check that can be skipped will be.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
phicam=$(realpath "${1:-$here/../../target/release/phicam}")
SECONDS=0
say() { printf '%3d s  %s\n' "$SECONDS" "$*"; }
fail() { printf 'check.sh: %s\n' "$*" >&2; exit 1; }
expect() { # code, command …
    local code=0 wanted=$1
    shift
    "$@" >"$work/out" 2>"$work/err" || code=$?
    [ "$code" = "$wanted" ] || { cat "$work/out" "$work/err" >&2; fail "exit code $code in place of $wanted: $*"; }
}

work=$(mktemp -d)
finish() {
    code=$?
    if [ "$code" != 0 ] && [ "${SLURM_TEST_DIR:-}" ]; then
        squeue -r -t all -o '%i %j %T %r %N' >&2 || true
        tail -n 5 "$plan"/slurm/*.log >&2 || true
    fi
    [ -z "${SLURM_TEST_DIR:-}" ] || "$here/down.sh"
    rm -rf "$work"
    exit "$code"
}
plan=$work/plan
trap finish EXIT
# The shorter timeout is how long a dead node goes unnoticed.
settings=$(SLURMD_TIMEOUT=5 "$here/up.sh")
eval "$settings"
say "two nodes are up"

# 32 blocks, four for each shard; 192 × 192 pixels for 8 spots make every shard a file of 9 MB, whose write can be met.
"$phicam" scene export bench |
    sed 's/pixels = .*/pixels = [192, 192]/; s/per_side = .*/per_side = 2/' >"$work/scene.toml"
samples=(--samples 2048 --sampler pcg --estimator shared)
expect 0 "$phicam" -q render "$work/scene.toml" -o "$work/straight" "${samples[@]}"
say "one process has rendered it"
expect 0 "$phicam" -q plan "$work/scene.toml" -o "$plan" "${samples[@]}" --shards 8
expect 0 "$phicam" slurm "$plan" -- --mem=400M
first=$(sed -n 's/^shards 0-7: array of jobs \([0-9]*\)$/\1/p' "$work/out")
[ "$first" ] || fail "no array of 0 to 7 was submitted: $(cat "$work/out")"
say "array $first is submitted"

# The processes of this Slurm's jobs whose environment has a line, e.g. SLURMD_NODENAME=n2.
processes() {
    local proc line own found
    for proc in /proc/[0-9]*; do
        own= found=
        while IFS= read -r -d '' line; do
            if [ "$line" = "SLURM_CONF=$SLURM_CONF" ]; then own=yes; fi
            if [ "$line" = "$1" ]; then found=yes; fi
        done 2>/dev/null <"$proc/environ" || continue
        if [ "$own$found" = yesyes ]; then printf '%s\n' "${proc#/proc/}"; fi
    done
}
program() { cat "/proc/$1/comm" 2>/dev/null || true; }

# Whether all threads of a process have stopped, or it is gone.
stopped() {
    local stat state
    for stat in "/proc/$1/task"/*/stat; do
        { read -r state <"$stat"; } 2>/dev/null || continue
        [[ ${state##*) } == [TZX]* ]] || return 1
    done
}
# Kills the process in the middle of the write of a shard: it is stopped every other moment and looked at. That a large unfinished file is open in it
# is certain then, and stays so.
kill_in_write() {
    local part fd
    while kill -STOP "$1" 2>/dev/null; do
        until stopped "$1"; do :; done
        for part in "$plan"/shards/.phicam-*.part; do
            for fd in "/proc/$1/fd"/*; do
                [ "$fd" -ef "$part" ] && [ "$(stat -c %s "$part")" -gt 100000 ] || continue
                kill -9 "$1"
                return 0
            done
        done
        kill -CONT "$1" 2>/dev/null || return 1
        sleep 0.001
    done
    return 1
}
killed=
while [ -z "$killed" ]; do
    [ "$SECONDS" -lt 300 ] || fail "no task was met in its write"
    for pid in $(processes SLURMD_NODENAME=n1); do
        [ "$(program "$pid")" = phicam ] || continue
        index=$(tr '\0' '\n' <"/proc/$pid/environ" | sed -n 's/^SLURM_ARRAY_TASK_ID=//p')
        if kill_in_write "$pid"; then killed=$index; fi
        break
    done
    sleep 0.05
done
wreck=$(find "$plan/shards" -name '.phicam-*.part' -size +50k)
[ "$wreck" ] || fail "task $killed was killed, and left no unfinished file"
say "task $killed was killed in the middle of its write: $(stat -c %s "$wreck") bytes of a file that does not count"

# A node dies: its daemon, the daemon's step and the job, all at once, so that nobody is left to report.
lost=
while [ -z "$lost" ]; do
    [ "$SECONDS" -lt 320 ] || fail "no task was met on the second node"
    lost=$(squeue -h -r -j "$first" -t running -o '%K %N' | sed -n 's/ n2$//p')
done
job=$(processes SLURMD_NODENAME=n2)
steps=$(for pid in $job; do sed -n 's/^PPid:\t//p' "/proc/$pid/status" 2>/dev/null; done | sort -u)
daemon=$(cat "$SLURM_TEST_DIR/n2.pid")
doomed=$daemon
for pid in $steps; do if [ "$(program "$pid")" = slurmstepd ]; then doomed+=" $pid"; fi; done
# shellcheck disable=SC2086 # numbers
kill -9 $doomed $job 2>/dev/null || true
say "node n2 died with task $lost"

expect 66 "$phicam" merge "$plan" -o "$work/early"
missing=$("$phicam" -q status "$plan") && fail "status calls the plan complete"
grep -q ": $missing (blocks" "$work/err" || fail "merge does not name $missing: $(cat "$work/err")"
[ ! -e "$work/early/phi.npy" ] || fail "merge has written what it refuses"
say "merge refuses: $missing are missing"

expect 0 "$phicam" slurm "$plan" -- --mem=400M
second=$(sed -n "s/^shards $killed: array of jobs \([0-9]*\)\$/\1/p" "$work/out")
[ "$second" ] || fail "not shard $killed alone was submitted again: $(cat "$work/out")"
tasks=$(squeue -h -r -t all -j "$second" -o %K | sort -n | paste -sd,)
[ "$tasks" = "$killed" ] || fail "array $second has the tasks $tasks in place of $killed"
grep -q "queued or running already" "$work/out" || fail "the shards that wait are not named: $(cat "$work/out")"
say "phicam slurm again: $(paste -sd';' "$work/out")"
expect 0 "$phicam" slurm "$plan" -- --mem=400M
! grep -q "array of jobs" "$work/out" || fail "a third call has submitted again: $(cat "$work/out")"

while [ "$(squeue -h | wc -l)" != 0 ]; do
    [ "$SECONDS" -lt 600 ] || fail "the jobs do not end"
    sleep 0.1
done
say "all jobs have ended"
expect 0 "$phicam" -q status "$plan"
[ ! -s "$work/out" ] || fail "status names $(cat "$work/out")"

# What Slurm has written down: every shard was computed to its end once.
completed() { sed -n "s/.*JobState=COMPLETED .*ArrayJobId=\($1\) ArrayTaskId=\([0-9]*\) .*/\2/p" "$SLURM_TEST_DIR/log/jobcomp.txt"; }
[ "$(completed "$first\|$second" | sort -n | paste -sd,)" = 0,1,2,3,4,5,6,7 ] || fail "completed were $(completed '.*' | paste -sd,)"
[ "$(completed "$second")" = "$killed" ] || fail "the second array has computed more than shard $killed"

compared=0
for file in phi.npy phi.stderr.npy $(cd "$work/straight" && ls frames/*.exr); do
    cmp "$work/straight/$file" "$plan/merged/$file" || fail "$file differs from that of one process"
    compared=$((compared + 1))
done
[ "$compared" = 10 ] || fail "$compared files were compared in place of 10"
[ "$(ls "$plan/merged/frames")" = "$(ls "$work/straight/frames")" ] || fail "the frames are not the same"
say "phi.npy, phi.stderr.npy and 8 frames are those of one process, byte for byte"

jobs=$(squeue -h -r -t all | wc -l)
expect 0 "$phicam" slurm "$plan" -- --mem=400M
grep -q "nothing to submit" "$work/out" && [ "$(squeue -h -r -t all | wc -l)" = "$jobs" ] || fail "a complete plan was submitted again"
say "done"
