#!/usr/bin/env bash
# Runs scripts/openjd.yaml with the `openjd` command line, kills it in the middle of a chunk, picks up what is
# missing, and compares the frames with those of a local run.
#
# Needs ffmpeg and Python's venv.
#
#   tests/farm/openjd.sh [LOCAL]
#
# The local run's frames are kept in the folder LOCAL, and taken from there if they are there.
set -euo pipefail
cd "$(dirname "$0")/../.."

fail() { echo "openjd: $*" >&2; exit 1; }

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
export PATH=$PWD/target/release:$PATH
input=(scenes/test2.ron paths/zoom.ron)
options="--mode montecarlo --size 128x72 --samples 32"
local=${1:-$dir/local}
# shellcheck disable=SC2086 # they are several
flythrough render "${input[@]}" --out "$local" $options --quiet

frames=$dir/frames
run() {
    .ci/tool openjd-cli==0.8.0 openjd run scripts/openjd.yaml -p Scene="${input[0]}" -p Path="${input[1]}" -p Frames="$1" \
        -p Out="$frames" -p Video="$dir/zoom.mp4" -p Options="$options" > "$dir/log" 2>&1
}
run 0-54 &
for ((i = 0; i < 6000; i++)); do
    [ ! -f "$frames/frame_00023.png" ] || break
    sleep 0.02
done
pkill -KILL -f "render .* --out $frames" || fail "the third chunk was not rendering: $(tail -n 30 "$dir/log")"
if wait $!; then fail "it did not notice that a chunk was killed"; fi
[ ! -e "$dir/zoom.mp4" ] || fail "there is a video of frames that are missing"
missing=$(flythrough missing --quiet "$frames" --format openjd)
[[ $missing == 2*-54 ]] || fail "missing are $missing"
run "$missing" || fail "the second run: $(tail -n 30 "$dir/log")"
grep -q "openjd_progress: 100.0" "$dir/log" || fail "no progress was told: $(tail -n 30 "$dir/log")"
flythrough verify --quiet "$frames"
for frame in "$local"/frame_*; do
    cmp "$frame" "$frames/${frame##*/}"
done
[ -s "$dir/zoom.mp4" ] || fail "there is no video"
echo "openjd: one chunk killed, $missing picked up, all frames as of a local run"
