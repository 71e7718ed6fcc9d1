#!/usr/bin/env bash
# Fuzzes what reads input files, and the ray traversal: scripts/fuzz.sh [SECONDS [TARGET...]].
# Each target runs for so many seconds (300). What it finds is kept, and makes the status 1.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-300}
shift || true
targets=("$@")
[ $# -gt 0 ] || targets=(scene camera_path cameras model jpeg traversal)

rustup toolchain list | grep -q ^nightly || rustup toolchain install nightly --profile minimal
cargo fuzz --version >/dev/null 2>&1 || cargo install --quiet cargo-fuzz

fuzz() {
    local command=$1 target=$2
    shift 2
    cargo +nightly fuzz "$command" --fuzz-dir tests/fuzz --target-dir target/fuzz "$target" "$@"
}

# What the fuzzer learns goes to a folder of its own: the inputs in tests/fuzz are only read.
out=$(mktemp -d)
# On a disk, the files that the loaders read would make it fifty times slower.
[ ! -d /dev/shm ] || export TMPDIR=/dev/shm
status=0
for target in "${targets[@]}"; do
    printf '\n== %s, for %s seconds\n' "$target" "$seconds"
    fuzz build "$target"
    mkdir -p "$out/$target/corpus"
    fuzz run "$target" "$out/$target/corpus" "tests/fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=8192 \
        -artifact_prefix="$out/$target/" -print_final_stats=1 >"$out/$target.log" 2>&1 || {
        status=1
        grep -E 'panicked|ERROR|SUMMARY' -A 1 "$out/$target.log" || true
        echo "Found; the input that shows it:"
        find "$out/$target" -maxdepth 1 -type f
    }
    grep -E 'number_of_executed_units' "$out/$target.log" || true
done
echo "Logs and inputs: $out"
exit $status
