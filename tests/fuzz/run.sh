#!/usr/bin/env bash
# Fuzzes phicam's readers, each for so many seconds: tests/fuzz/run.sh SECONDS [TARGET…]
# As many at a time as there are processors; for 0 s they are built only. What is found is in tests/fuzz/artifacts/TARGET, and any
# finding ends it. src/lib.rs says more.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:?how many seconds for each target}
shift
if [ $# = 0 ]; then
    for file in src/bin/*.rs; do set -- "$@" "$(basename "$file" .rs)"; done
fi

# What cargo-fuzz hands to LLVM, without a sanitizer, which would need a nightly compiler.
host=$(rustc -vV | sed -n 's/^host: //p')
flags="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0"
RUSTFLAGS="$flags" cargo build --locked --quiet --target "$host" --bins --examples
export built=target/$host/debug seconds
if [ "$seconds" = 0 ]; then exit; fi

"$built/examples/seeds" corpus
# Files go to memory where there is such a place.
if [ -w /dev/shm ]; then export TMPDIR=/dev/shm; fi
one() {
    local target=$1 dictionary=()
    mkdir -p "corpus/$target" "found/$target" "artifacts/$target"
    if [ -f "$target.dict" ]; then dictionary=("-dict=$target.dict"); fi
    "$built/$target" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=1024 -max_len=16384 -print_final_stats=1 \
        -artifact_prefix="artifacts/$target/" "${dictionary[@]}" "corpus/$target" "found/$target" 2>"artifacts/$target/log" ||
        { echo "-- $target"; tail -40 "artifacts/$target/log"; return 1; }
    local told
    told=$(grep -E "DONE|^stat::(number_of_executed_units|peak_rss_mb)" "artifacts/$target/log") || return 1
    echo "-- $target, $seconds s"$'\n'"$told"
}
export -f one
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'one {}'
