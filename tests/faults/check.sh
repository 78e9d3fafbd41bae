#!/usr/bin/env bash
# What a machine can do to a program that writes: a full disk, a size limit, a read-only folder, one that is deleted under way, two processes in
# one folder, a clock that is set back. Each gives a clear error, nothing finished is lost, and going on ends with the bytes of an undisturbed run.
#   usage: check.sh PHICAM     (as root: it mounts file systems in a mount namespace of its own; needs faketime)
set -euo pipefail
phicam=$(realpath "$1")
if [ "${FAULTS_INSIDE:-}" != 1 ]; then
    FAULTS_INSIDE=1 exec unshare --mount -- "$0" "$phicam"
fi
command -v faketime >/dev/null || { echo "faults: faketime is missing; apt-get install faketime" >&2; exit 1; }
work=$(mktemp -d)
trap 'cd /; umount -q "$work"/mnt* 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"

fail() { echo "faults: $*" >&2; [ ! -s said ] || cat said >&2; exit 1; }
# ends CODES WORDS COMMAND...: exit code one of CODES, WORDS in what it says, no panic.
ends() {
    local codes=$1 words=$2 code=0
    shift 2
    "$@" >said 2>&1 || code=$?
    [[ " $codes " == *" $code "* ]] || fail "exit code $code in place of $codes: $*"
    grep -q "$words" said || fail "no \"$words\" in what it says: $*"
    ! grep -q panicked said || fail "a panic: $*"
}
same() { diff -r --exclude=run.json --exclude=merged.json "$1" "$2" >said || fail "$1 and $2 differ"; }
# A folder that counts on nothing but the space that it is given.
space() { mkdir -p "$1"; mount -t tmpfs -o "size=$2" tmpfs "$1"; }

sed 's/per_side = 30/per_side = 6/' <("$phicam" scene export bench) >bench.toml
paths="--samples 2048 --estimator shared"
"$phicam" -q render bench.toml -o whole $paths >/dev/null
plan() { "$phicam" -q plan bench.toml -o "$1" $paths --shards 8 >/dev/null; }
each() { for k in 0 1 2 3 4 5 6 7; do "$phicam" -q shard "$1" --index $k >/dev/null; done; }

echo "a full disk"
space mnt-shards 700k
plan mnt-shards/job
code=0
for k in 0 1 2 3 4 5 6 7; do
    "$phicam" -q shard mnt-shards/job --index $k >said 2>&1 || { code=$?; break; }
done
[ $code = 74 ] || fail "a shard on a full disk ends with $code in place of 74"
grep -q "the disk or the quota is full; free some space" said || fail "no cause"
[ $k -gt 0 ] || fail "no shard was finished before the disk was full"
before=$(sha256sum mnt-shards/job/shards/*.phs)
mount -o remount,size=64m mnt-shards
each mnt-shards/job
sha256sum --quiet -c <<<"$before" || fail "a finished shard has changed"
ends 0 merged "$phicam" merge mnt-shards/job -o merged
same merged whole
space mnt-render 400k
ends 2 "full; free some space" "$phicam" render bench.toml -o mnt-render/out $paths
mount -o remount,size=64m mnt-render
ends 0 "of 24 spots" "$phicam" render bench.toml -o mnt-render/out $paths
same mnt-render/out whole

echo "a limit on the size of files"
plan limited
limit() { (ulimit -f 16; "$@"); }
ends 74 "larger than files may be" limit "$phicam" shard limited --index 0
ends 2 "larger than files may be" limit "$phicam" render bench.toml -o small $paths
[ -z "$(ls limited/shards)" ] || fail "something was left behind"
each limited
ends 0 merged "$phicam" merge limited -o limited-merged
same limited-merged whole

echo "a read-only folder"
plan closed
"$phicam" -q shard closed --index 0 >/dev/null
mkdir -p mnt-closed
mount --bind closed mnt-closed
mount -o remount,bind,ro mnt-closed
ends 74 "read-only" "$phicam" shard mnt-closed --index 1
ends 0 "is there" "$phicam" shard mnt-closed --index 0
ends 3 "1 of 8" "$phicam" status mnt-closed
ends 2 "read-only" "$phicam" render bench.toml -o mnt-closed/out $paths
ends 74 "read-only" "$phicam" plan bench.toml -o mnt-closed/job $paths
umount mnt-closed

echo "a folder that is deleted under way"
long="--samples 4194304 --estimator shared"
"$phicam" -q plan bench.toml -o gone $long --shards 1 >/dev/null
"$phicam" shard gone --index 0 >said 2>&1 & shard=$!
"$phicam" render bench.toml -o gone-out $long >said-render 2>&1 & render=$!
while [ -z "$(ls gone/shards gone-out/partial 2>/dev/null | grep -v :)" ]; do sleep 0.05; done
sleep 1
rm -rf gone gone-out
code=0; wait $shard || code=$?
[ $code = 74 ] || fail "the shard ended with $code in place of 74"
grep -q "its folder does not exist" said || fail "no cause"
code=0; wait $render || code=$?
[ $code = 2 ] || fail "the render ended with $code in place of 2"
grep -q "its folder does not exist" said-render || fail "no cause for the render"

echo "two processes in one folder"
plan both
for k in 0 1 2 3 4 5 6 7; do
    "$phicam" -q shard both --index $k >/dev/null & first=$!
    "$phicam" -q shard both --index $k >/dev/null
    wait $first
done
ends 0 merged "$phicam" merge both -o both-merged
same both-merged whole
more="--samples 65536 --estimator shared"
"$phicam" -q render bench.toml -o alone $more >/dev/null
for _ in 1 2 3; do
    rm -rf together
    mkdir together
    codes=
    "$phicam" render bench.toml -o together $more >said-first 2>&1 & first=$!
    code=0; "$phicam" render bench.toml -o together $more >said 2>&1 || code=$?
    codes+=" $code"
    code=0; wait $first || code=$?
    codes+=" $code"
    ! grep -q panicked said said-first || fail "a panic"
    [[ "$codes" == *" 0"* ]] || fail "neither of two renders ended well:$codes"
    for s in said said-first; do ! grep -q "^error:" $s || grep -q "is being written" $s || fail "an error without a cause"; done
    "$phicam" -q render bench.toml -o together $more >/dev/null
    same together alone
done

echo "a clock that is set back"
plan late
"$phicam" -q shard late --index 0 >/dev/null
touch -d '2040-01-01' late/shards/* late/plan.json
export FAKETIME_DONT_FAKE_MONOTONIC=1
for k in 1 2 3 4 5 6 7; do faketime '1999-12-31 23:59:59' "$phicam" -q shard late --index $k >/dev/null; done
faketime '1971-01-01' "$phicam" -q merge late -o late-merged >/dev/null
same late-merged whole
timeout -s KILL 0.3 "$phicam" -q render bench.toml -o back $more >/dev/null 2>&1 || true
find back -type f -exec touch -d '2040-01-01' {} +
ends 0 "of 24 spots" faketime '1999-12-31 23:59:59' "$phicam" render bench.toml -o back $more
same back alone
echo "faults: all as they should be"
