#!/usr/bin/env bash
# Makes the pictures of the documents again: scenes/pictures. Takes about half an hour.
set -euo pipefail
cd "$(dirname "$0")/.."
pictures=scenes/pictures
mkdir -p "$pictures"

command -v cargo >/dev/null || { echo "cargo is missing: install Rust first" >&2; exit 2; }
scripts/install_missing.sh ffmpeg img2webp=webp
cargo build --release --quiet
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

render() { # render SCENE PATH OPTIONS...
    local scene=$1 path=$2
    shift 2
    target/release/flythrough render "scenes/$scene.ron" "paths/$path.ron" --quiet "$@"
}
# still NAME SCENE PATH OPTIONS...: one frame, as $work/NAME.png
still() {
    local name=$1
    shift
    render "$@" --force --out "$work/frames"
    mv "$work"/frames/frame_*.png "$work/$name.png"
}
filter() { # filter OUTPUT GRAPH INPUT...
    local output=$1 graph=$2 inputs=()
    shift 2
    for input in "$@"; do inputs+=(-i "$input"); done
    ffmpeg -nostdin -v error -y "${inputs[@]}" -filter_complex "$graph" -frames:v 1 -update 1 \
        "$pictures/$output"
}

# The moving picture: every fourth frame of the walk, at twice the speed. Each is encoded by itself:
# differences between frames would show blocks on the walls.
render gallery gallery --mode montecarlo --samples 4 --exposure -0.3 --size 360x202 \
    --frames 0-432:4 --out "$work/walk"
img2webp -loop 0 -kmin 0 -kmax 1 -lossy -q 40 -m 6 -d 83 "$work"/walk/frame_*.png \
    -o "$pictures/walk.webp"

still test test test --mode supersampling
still test1 test1 test --mode supersampling
still test2 test2 translate_rotate --mode supersampling --frames 0
filter test.png null "$work/test.png"
filter test1.png null "$work/test1.png"
filter test2.png null "$work/test2.png"

# The sphere's edge, eight times enlarged: without and with supersampling.
still rough test2 translate_rotate --mode raytracing --frames 0
edge='crop=60:50:665:285,scale=480:400:flags=neighbor'
filter edge.png "[0]${edge}[a];[1]${edge}[b];[a]pad=iw+8[a];[a][b]hstack" \
    "$work/rough.png" "$work/test2.png"

# Green light on the white wall, in the corner behind the sphere.
still direct test2 zoom --mode raytracing --samples 8 --frames 0 --size 720x405
still gathered test2 zoom --mode montecarlo --samples 8 --frames 0 --size 720x405
corner='crop=400:340:250:20'
filter bleeding.png "[0]$corner,pad=iw+8[a];[1]${corner}[b];[a][b]hstack" \
    "$work/direct.png" "$work/gathered.png"

# Two shadows and their darker overlap.
still test3 test3 test3 --mode montecarlo --samples 4 --frames 0
filter test3.png null "$work/test3.png"

still sunroom sunroom sunroom --mode montecarlo --gi cached --samples 64 --frames 0 --size 640x360
cp "$work/sunroom.png" "$pictures"

still gallery gallery gallery --frames 66 --size 960x540
filter gallery.png null "$work/gallery.png"
target/release/flythrough path plot scenes/gallery.ron paths/gallery.ron --out "$pictures/path.svg"
for name in test3 gallery; do
    target/release/flythrough report "scenes/$name.ron" "paths/$name.ron" --out "$work/$name" --quiet
    cp "$work/$name/curves.png" "$pictures/curves_$name.png"
done
echo "$pictures:"
ls "$pictures"
