#!/usr/bin/env bash
# Renders the two videos: the translate-and-rotate one (ray traced) and the zoom one (Monte Carlo).
#
#   scripts/render_videos.sh [OUT_DIR [flythrough render options]]
#
# Frames and videos go to OUT_DIR (default: out), where the videos are called translate_rotate.mp4 and zoom.mp4. An
# interrupted run is taken up where it stopped.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out}
shift || true

command -v cargo >/dev/null || { echo "cargo is missing: install Rust first" >&2; exit 2; }
scripts/install_missing.sh ffmpeg
cargo build --release --quiet

for name in translate_rotate zoom; do
    echo "Rendering $name"
    target/release/flythrough render scenes/test2.ron "paths/$name.ron" --out="$out/$name" "$@"
    scripts/make_video.sh -- "$out/$name" "$out/$name.mp4"
done
