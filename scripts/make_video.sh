#!/usr/bin/env bash
# Makes a video of a folder of frames.
#
#   scripts/make_video.sh FRAMES_DIR VIDEO.mp4
#
# The frame rate is the sequence's (flythrough status). Refuses a folder in which a frame is not verified
# (flythrough verify) before it encodes, and counts the video's frames after. Colours are
# converted to BT.709, and the video says so; an odd width or height is padded by one black line.
#
# The program is $FLYTHROUGH, else the one that was built beside this script, else the one in $PATH.
set -euo pipefail

fail() { echo "make_video: $*" >&2; exit 2; }

[ $# -eq 2 ] || fail "usage: $0 FRAMES_DIR VIDEO.mp4"
frames=$1 video=$2
command -v ffmpeg >/dev/null || fail "ffmpeg is not installed (Debian: apt-get install ffmpeg)"
program=${FLYTHROUGH:-$(dirname "$0")/../target/release/flythrough}
[ -x "$program" ] || program=$(command -v flythrough) \
    || fail "flythrough is neither built (cargo build --release) nor in \$PATH"

"$program" verify --quiet "$frames" >&2 || {
    status=$?
    echo "make_video: $frames: not every frame is verified; render the sequence again" >&2
    exit $status
}
entry() { "$program" status "$frames" --get "$1"; }
fps=$(entry fps) count=$(entry frames) format=$(entry format)
[ "$format" != exr ] || fail "the frames are $format; videos are made of PNG frames"

input=(-framerate "$fps" -start_number 0 -i "$frames/frame_%05d.png")
mkdir -p "$(dirname "$video")"
# The same extension, so that ffmpeg knows the format; complete or not there at all.
unfinished=${video%.*}.unfinished.${video##*.}
trap 'rm -f "$unfinished"' EXIT
ffmpeg -nostdin -v error -xerror -y "${input[@]}" \
    -vf "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p" \
    -c:v libx264 -preset slow -crf 16 -movflags +faststart \
    -color_primaries bt709 -color_trc bt709 -colorspace bt709 -color_range tv \
    "$unfinished"
encoded=$(ffprobe -v error -count_frames -select_streams v:0 \
    -show_entries stream=nb_read_frames -of csv=p=0 "$unfinished")
[ "$encoded" = "$count" ] || fail "the video has $encoded frames instead of $count"
mv "$unfinished" "$video"
echo "$video: $count frames at $fps per second"
