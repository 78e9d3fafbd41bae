#!/usr/bin/env bash
# Ends exactly the daemons that tests/slurm/up.sh started, by their pid files, and removes the folder; with KEEP=1 the folder stays.
set -u
dir=${SLURM_TEST_DIR:?set SLURM_TEST_DIR to what up.sh printed}
[ -e "$dir/.slurm-test" ] || { printf 'down.sh: %s was not made by up.sh\n' "$dir" >&2; exit 1; }
export SLURM_CONF=$dir/slurm.conf

# A zombie is dead: the first process of a container may collect it late, or never.
gone() {
    case "$(sed 's/.*) //' "/proc/$1/stat" 2>/dev/null)" in "" | Z* | X*) return 0 ;; esac
    return 1
}
# A number may belong to another program by now, which is left alone.
is() { [ "$(cat "/proc/$1/comm" 2>/dev/null)" = "$2" ]; }
stop() { # pid file, program
    local pid
    pid=$(cat "$1" 2>/dev/null) || return 0
    is "$pid" "$2" || return 0
    kill "$pid"
    for _ in $(seq 100); do
        gone "$pid" && return 0
        sleep 0.1
    done
    kill -9 "$pid"
}

# First the jobs: a slurmd that ends leaves its running slurmstepd behind.
if is "$(cat "$dir/ctld.pid" 2>/dev/null)" slurmctld; then
    scancel -u "$(id -un)" 2>/dev/null
    for _ in $(seq 100); do
        [ -z "$(squeue -h 2>/dev/null)" ] && break
        sleep 0.1
    done
fi
for file in "$dir"/n*.pid; do [ -e "$file" ] && stop "$file" slurmd; done
stop "$dir/ctld.pid" slurmctld
stop "$dir/munge/munged.pid" munged
[ "${KEEP:-}" ] || rm -rf -- "$dir"
