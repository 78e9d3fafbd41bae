#!/usr/bin/env bash
# The same bytes on processors of other generations, emulated by qemu-user: without AVX, and with AVX2 but not AVX-512.
#   usage: processors.sh PHICAM
set -euo pipefail
phicam=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
small='s/per_side = 30/per_side = 2/; s/pixels = \[16, 16\]/pixels = [5, 4]/; s/max_bounces = 3/max_bounces = 5/'
for scene in bench satin; do
    "$phicam" scene export $scene | sed "$small" >$scene.toml
    for estimator in independent shared factored; do
        render=(-q render $scene.toml --samples 64 --estimator $estimator)
        "$phicam" "${render[@]}" -o here >/dev/null
        for processor in Nehalem Haswell; do
            qemu-x86_64 -cpu $processor "$phicam" "${render[@]}" -o there >/dev/null 2>said || { cat said >&2; exit 1; }
            diff -r --exclude=run.json here there || { echo "processors: $scene, $estimator: other bytes on $processor" >&2; exit 1; }
            rm -r there
        done
        rm -r here
    done
done
echo "processors: the same bytes on all"
