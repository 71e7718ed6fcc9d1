#!/usr/bin/env bash
# Benchmarks, as a Markdown table.
#
#   scripts/bench.sh [MITSUBA_SCRIPT]
#
# With the path of a Python script that renders the scene of scenes/test3.ron with Mitsuba 3 and
# prints its seconds per frame (taking --spp and --frames), it runs in turn with ours, so that both
# see the same machine. PYTHON chooses the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."
echo "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $(nproc) cores"
cargo bench --quiet --bench frames
if [ $# -eq 1 ]; then
    for round in 1 2 3; do
        cargo bench --quiet --bench frames -- test3 "64 paths" | tail -n 2
        echo "Mitsuba, 64 samples per pixel: $("${PYTHON:-python3}" "$1" --spp 64 --frames 4)"
    done
fi
