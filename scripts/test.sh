#!/usr/bin/env bash
# Everything that proves the project: format, lints, docs, tests, both videos made small, and two farms.
set -euo pipefail
cd "$(dirname "$0")/.."

missing=()
command -v ffmpeg >/dev/null || missing+=(ffmpeg)
command -v slurmctld >/dev/null || missing+=(munge slurmctld slurmd slurm-client)
command -v pgrep >/dev/null || missing+=(procps)
python3 -c "import ensurepip" 2>/dev/null || missing+=(python3-venv)
if [ ${#missing[@]} -gt 0 ]; then
    root=; [ "$(id -u)" -eq 0 ] || root=sudo
    $root apt-get update -qq
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "${missing[@]}" >/dev/null
fi

step() { printf '\n== %s\n' "$*"; }
step Format
cargo fmt --check
cargo fmt --check --manifest-path tests/fuzz/Cargo.toml
step Lints
cargo clippy --quiet --all-targets -- -D warnings
step Documentation
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps --document-private-items
step Tests
cargo test --quiet --release
step "Random hostile scenes, for ${FUZZ_SECONDS:=20} seconds"
FUZZ_SECONDS=$FUZZ_SECONDS cargo test --quiet --release --lib fuzz -- --ignored
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
step "Debug build: its checks hold, and its frames are the release build's"
cargo run --quiet -- selftest
for build in "" --release; do
    cargo run --quiet $build -- render scenes/test2.ron paths/zoom.ron --out "$out/build$build" \
        --frames 0,40 --size 96x54 --mode montecarlo-supersampling --splits 2 --quiet
done
for frame in "$out"/build/*.png; do
    cmp "$frame" "$out/build--release/${frame##*/}"
done
step "Both videos, small"
scripts/render_videos.sh "$out" --size 160x90 --splits 4
for name in translate_rotate zoom; do
    ffprobe -v error -show_entries format=duration -of "csv=p=0:s=,:nk=1" "$out/$name.mp4" \
        | sed "s/^/$name.mp4 lasts, in seconds: /"
done
step "A farm: Slurm"
tests/farm/slurm.sh
step "A farm: Open Job Description"
openjd=target/openjd
[ -x $openjd/bin/openjd ] || { python3 -m venv $openjd && $openjd/bin/pip install --quiet openjd-cli; }
PATH=$PWD/$openjd/bin:$PATH tests/farm/openjd.sh
step "All passed"
