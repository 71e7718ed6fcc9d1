#!/usr/bin/env bash
# Makes the README's pictures again: scenes/pictures. Takes about half an hour.
#
#   scripts/make_pictures.sh [VIDEOS_DIR]
#
# VIDEOS_DIR (default: out) holds the frames that scripts/render_videos.sh rendered, for the contact
# sheets; they are rendered first if they are not there.
set -euo pipefail
cd "$(dirname "$0")/.."
videos=${1:-out}
pictures=scenes/pictures
mkdir -p "$pictures"
[ -f "$videos/zoom.mp4" ] || scripts/render_videos.sh "$videos"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# still NAME SCENE PATH OPTIONS...: one frame, as $work/NAME.png
still() {
    local name=$1 scene=$2 path=$3
    shift 3
    target/release/flythrough render "scenes/$scene.ron" "paths/$path.ron" --quiet --force \
        --out "$work/frames" "$@"
    mv "$work"/frames/frame_*.png "$work/$name.png"
}
filter() { # filter OUTPUT GRAPH INPUT...
    local output=$1 graph=$2 inputs=()
    shift 2
    for input in "$@"; do inputs+=(-i "$input"); done
    ffmpeg -nostdin -v error -y "${inputs[@]}" -filter_complex "$graph" -frames:v 1 -update 1 \
        "$pictures/$output"
}
sheet() { # sheet OUTPUT FRAMES LAST: 12 frames from 0 to LAST
    ffmpeg -nostdin -v error -y -framerate 24 -i "$videos/$2/frame_%05d.png" -frames:v 1 -update 1 \
        -vf "select='lt(mod(n*11,$3),11)',scale=320:-2,tile=4x3:padding=4" "$pictures/$1"
}

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

sheet translate_rotate.png translate_rotate 240
sheet zoom.png zoom 54
still gallery gallery gallery --frames 66 --size 960x540
filter gallery.png null "$work/gallery.png"
target/release/flythrough path plot scenes/gallery.ron paths/gallery.ron --out "$pictures/path.svg"
for name in test3 gallery; do
    target/release/flythrough report "scenes/$name.ron" "paths/$name.ron" --out "$work/$name" --quiet
    cp "$work/$name/curves.png" "$pictures/curves_$name.png"
done
echo "$pictures:"
ls "$pictures"
