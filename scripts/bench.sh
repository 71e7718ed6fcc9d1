#!/usr/bin/env bash
# Benchmarks, as Markdown tables.
#
#   scripts/bench.sh [--rays DIR] [--mitsuba SCRIPT] [--povray SCRIPT]
#
# --rays DIR        a folder of ray sets (tests/bench/rays.rs says which files). If it holds a program
#                   `embree_rays` that times Embree on them (`embree_rays bench NAME`), both run in
#                   turn, so that both see the same machine.
# --mitsuba SCRIPT  a Python script that renders the scene of scenes/test3.ron with Mitsuba 3 and
#                   prints its seconds per frame (taking --spp and --frames); in turn with ours.
# --povray SCRIPT   a Python script that renders it with POV-Ray and direct light only and prints its
#                   seconds per frame (taking --frames and --radiosity ''); in turn with ours.
# PYTHON chooses the interpreter of both.
set -euo pipefail
cd "$(dirname "$0")/.."

rays='' mitsuba='' povray=''
while [ $# -gt 0 ]; do
    case $1 in
        --rays) rays=$(cd "${2:?--rays needs a folder}" && pwd) ;;
        --mitsuba) mitsuba=${2:?--mitsuba needs a script} ;;
        --povray) povray=${2:?--povray needs a script} ;;
        *) echo "bench: unknown option $1" >&2; exit 2 ;;
    esac
    shift 2
done

echo "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $(nproc) cores"
cargo bench --quiet --bench frames
cargo bench --quiet --bench features
cargo bench --quiet --bench growth
cargo bench --quiet --bench paths
if [ -n "$rays" ]; then
    embree=$(mktemp)
    trap 'rm -f "$embree"' EXIT
    for _ in 1 2; do
        if [ -x "$rays/embree_rays" ]; then
            for scene in "$rays"/*.tri; do
                (cd "$rays" && ./embree_rays bench "$(basename "$scene" .tri)") >>"$embree"
            done
        fi
        cargo bench --quiet --bench rays -- "$rays" "$embree"
    done
fi
if [ -n "$mitsuba" ]; then
    for _ in 1 2 3; do
        cargo bench --quiet --bench frames -- test3 "64 paths" | tail -n 2
        echo "Mitsuba, 64 samples per pixel: $("${PYTHON:-python3}" "$mitsuba" --spp 64 --frames 4)"
    done
fi
if [ -n "$povray" ]; then
    for _ in 1 2 3; do
        cargo bench --quiet --bench frames -- test3 ray | tail -n 1
        echo "POV-Ray, direct light only: $("${PYTHON:-python3}" "$povray" --frames 8 --radiosity '')"
    done
fi
