#!/usr/bin/env bash
# Tests the project.
#
#   scripts/test.sh [quick|default|thorough]
#
#   quick     before each commit, under 2 minutes once it is built: format, and all tests at their smallest
#   default   what CI runs: lints, documentation, tests, the release build beside the checked one, both videos
#             small, and two farms
#   thorough  before a release: all of it at full size, processes killed by the hundred, hours of random input
#
# Tests run in the release build with overflow checks and debug assertions (tests/checked.toml). Everything is built in
# target/release, so that dependencies are compiled once. The program that is there after the quick tier is the
# checked one: it makes the same frames, but slower.
set -euo pipefail
cd "$(dirname "$0")/.."

export FLYTHROUGH_TEST_TIER=${1:-default}
tier=$FLYTHROUGH_TEST_TIER
case $tier in
    quick | default | thorough) ;;
    *) echo "usage: $0 [quick|default|thorough]" >&2; exit 2 ;;
esac

checked=(--release --config tests/checked.toml)

# Says what begins, and how long it took in the end.
step() {
    [ -z "${name:-}" ] || printf '   %s: %d s\n' "$name" $((SECONDS - start))
    name=$* start=$SECONDS
    printf '\n== %s\n' "$name"
}

if [ "$tier" = quick ]; then
    step Format
    cargo fmt --check
    step Tests
    cargo test --quiet "${checked[@]}"
    step "All passed"
    exit
fi

step Tools
tools=(ffmpeg shellcheck djpeg=libjpeg-turbo-progs pgrep=procps munged=munge slurmctld slurmd sinfo=slurm-client)
python3 -c "import ensurepip" 2>/dev/null || tools+=(ensurepip=python3-venv)
scripts/install_missing.sh "${tools[@]}"
step Format
cargo fmt --check
cargo fmt --check --manifest-path tests/fuzz/Cargo.toml
step Lints
shellcheck .ci/{run,tool,dependencies,minimum_rust} scripts/*.sh tests/farm/*.sh
cargo clippy --quiet --release --all-targets -- -D warnings
step "The library without the program's features"
cargo check --quiet --release --no-default-features --lib
step "Dependencies: licences, sources, advisories, notices"
.ci/dependencies
step Documentation
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --release --no-deps --document-private-items
step "Tests, built"
cargo test --quiet "${checked[@]}" --no-run
step Tests
if [ "$tier" = thorough ]; then
    FUZZ_SECONDS=${FUZZ_SECONDS:-300} cargo test --quiet "${checked[@]}" -- --include-ignored
else
    cargo test --quiet "${checked[@]}"
fi
out=$(mktemp -d)
# shellcheck disable=SC2046 # none, or one
trap 'kill $(jobs -p) 2>/dev/null && wait; rm -rf "$out"' EXIT
cp target/release/flythrough "$out/checked"
step "The release build, built"
cargo build --quiet --release
# It waits more than it works.
tests/farm/slurm.sh "$out/local" >"$out/slurm.log" 2>&1 &
slurm=$!
step "The release build: its self-test, and its frames are those of the checked build"
target/release/flythrough selftest
for program in "$out/checked" target/release/flythrough; do
    "$program" render scenes/test2.ron paths/zoom.ron --out "$out/of_${program##*/}" \
        --frames 0,40 --size 96x54 --mode montecarlo-supersampling --splits 2 --samples 4 --quiet
done
for frame in "$out"/of_checked/*.png; do
    cmp "$frame" "$out/of_flythrough/${frame##*/}"
done
step "Both videos, small"
scripts/render_videos.sh "$out" --size 96x54 --target-error 0.004
for video in translate_rotate zoom; do
    ffprobe -v error -show_entries format=duration -of "csv=p=0:s=,:nk=1" "$out/$video.mp4" \
        | sed "s/^/$video.mp4 lasts, in seconds: /"
done
step "A farm: Slurm"
wait "$slurm" || { cat "$out/slurm.log" >&2; exit 1; }
cat "$out/slurm.log"
step "A farm: Open Job Description"
tests/farm/openjd.sh "$out/local"
if [ "$tier" = thorough ]; then
    step "The minimum version of Rust"
    .ci/minimum_rust
    step "Fuzzing"
    scripts/fuzz.sh "${FUZZ_SECONDS:-300}"
fi
step "All passed"
