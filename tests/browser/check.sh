#!/usr/bin/env bash
# The pages in a real browser: check.sh PHICAM RUN PICTURES. PHICAM is the program, RUN the folder of a run of `bench`; screenshots and a PDF of its report are
# left in PICTURES.
set -euo pipefail
phicam=$(realpath "$1")
run=$(realpath "$2")
mkdir -p "$3"
pictures=$(realpath "$3")
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

npm ci --no-audit --no-fund --silent
# The libraries inside of the pages are what their packages give; the page's own script is typed and linted.
node vendor.js --check
npm run --silent lint

PHICAM=$phicam PHICAM_RUN=$run PHICAM_PICTURES=$pictures node --test --test-timeout=300000 --test-concurrency=1 ./*.test.js

# A large run: below 10 MB, and how fast it opens and answers.
sed 's/per_side = 30/per_side = 63/; s/pixels = \[16, 16\]/pixels = [64, 64]/' ../../scenes/bench.toml >"$work/large.toml"
"$phicam" run "$work/large.toml" -o "$work/large" --samples 64 2>&1 >/dev/null | while read -r line; do
    echo "$SECONDS $line"
done | grep "writing the report" | cut -d' ' -f1 >"$work/began"
echo "written within $((SECONDS - $(cat "$work/began") + 1)) s"
size=$(stat -c %s "$work/large/report.html")
echo "report of 252 spots × 64 × 64 pixels: $size bytes"
[ "$size" -lt 10000000 ]
node speed.js "$run/report.html" "$work/large/report.html"
