#!/usr/bin/env bash
# Runs scripts/openjd.yaml with the `openjd` command line, kills it in the middle of a chunk, picks up what is
# missing, and compares the frames with those of a local run. All names hold what a shell or ffmpeg might take for
# something else.
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
options="--mode montecarlo --size 128x72 --samples 32"
local=${1:-$dir/local}
# 55 frames.
sed "s/2\.75/1.125/; s/5\.5/2.25/" paths/zoom.ron > "$dir/short.ron"
# shellcheck disable=SC2086 # they are several
flythrough render scenes/test2.ron "$dir/short.ron" --out "$local" $options --quiet
local=$(cd "$local" && pwd)

repository=$PWD
cd "$dir"
# shellcheck disable=SC2016 # never expanded
name='-it'"'"'s 100%d \ "$(touch RUN)" *é'
cp "$repository/scenes/test2.ron" "./$name.ron"
cp "$dir/short.ron" "./$name.path"
ln -s "$repository/scenes/models" "$repository/scenes/textures" .
frames=$name.frames video=$name.mp4
run() {
    "$repository/.ci/tool" openjd-cli==0.8.0 openjd run "$repository/scripts/openjd.yaml" -p Scene="$name.ron" \
        -p Path="$name.path" -p Frames="$1" -p Out="$frames" -p Video="$video" \
        -p Options="$options --gi-cache '\$(touch RUN).cache'" > log 2>&1
}
run 0-54 &
for ((i = 0; i < 6000; i++)); do
    [ ! -f "$frames/frame_00023.png" ] || break
    sleep 0.02
done
# Of this test alone: other tests of the machine have other folders.
kill -KILL "$(pgrep -f "render .* --out=$dir/")" || fail "the third chunk was not rendering: $(tail -n 30 log)"
if wait $!; then fail "it did not notice that a chunk was killed"; fi
[ ! -e "./$video" ] || fail "there is a video of frames that are missing"
missing=$(flythrough missing --quiet --format openjd -- "$frames")
[[ $missing == 2*-54 ]] || fail "missing are $missing"
run "$missing" || fail "the second run: $(tail -n 30 log)"
grep -q "openjd_progress: 100.0" log || fail "no progress was told: $(tail -n 30 log)"
flythrough verify --quiet -- "$frames"
for frame in "$local"/frame_*; do
    cmp "$frame" "./$frames/${frame##*/}"
done
[ -s "./$video" ] || fail "there is no video"
[ -z "$(find . ~ -maxdepth 2 -name RUN)" ] || fail "a name was run"
echo "openjd: one chunk killed, $missing picked up, all frames as of a local run"
