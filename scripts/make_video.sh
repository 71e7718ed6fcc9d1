#!/usr/bin/env bash
# Makes a video of a folder of frames.
#
#   scripts/make_video.sh FRAMES_DIR VIDEO.mp4
#
# The frame rate is the sequence's (FRAMES_DIR/sequence.ron). Refuses a folder with missing, empty
# or cut frames before it encodes, and counts the video's frames after. Colours are converted to
# BT.709, and the video says so; an odd width or height is padded by one black line.
set -euo pipefail

fail() { echo "make_video: $*" >&2; exit 2; }

[ $# -eq 2 ] || fail "usage: $0 FRAMES_DIR VIDEO.mp4"
frames=$1 video=$2
command -v ffmpeg >/dev/null || fail "ffmpeg is not installed (Debian: apt-get install ffmpeg)"
[ -f "$frames/sequence.ron" ] || fail "$frames/sequence.ron is missing: not a folder of frames"

entry() { sed -nE "s/^ *$1: \"?([^\",]+)\"?,?$/\1/p" "$frames/sequence.ron"; }
fps=$(entry fps) count=$(entry frames) width=$(entry width) height=$(entry height)
extension=$(entry extension)
[ -n "$fps" ] && [ -n "$count" ] && [ -n "$width" ] && [ -n "$height" ] \
    || fail "$frames/sequence.ron does not say fps, frames, width and height"
[ "$extension" = png ] || fail "the frames are $extension; videos are made of PNG frames"

# Every frame of the path, and no other.
for ((i = 0; i < count; i++)); do
    file=$frames/$(printf 'frame_%05d.png' "$i")
    [ -s "$file" ] || fail "$file is missing or empty; the path has $count frames: render them first"
done
shopt -s nullglob
there=("$frames"/frame_*.png)
[ ${#there[@]} -eq "$count" ] || fail "$frames holds ${#there[@]} frames, the path has $count"

# Decode them all once: ffmpeg would hide a cut frame by repeating its neighbour.
input=(-framerate "$fps" -start_number 0 -i "$frames/frame_%05d.png")
errors=$(ffmpeg -nostdin -v error -xerror -err_detect explode "${input[@]}" -f null - 2>&1) \
    && [ -z "$errors" ] || fail "a frame in $frames is damaged: ${errors:-unknown}"
sizes=$(ffprobe -v error -f image2 -start_number 0 -show_entries frame=width,height \
    -of csv=p=0 "$frames/frame_%05d.png" | sort -u)
[ "$sizes" = "$width,$height" ] || fail "frames are not all ${width}x$height: $(echo $sizes)"

mkdir -p "$(dirname "$video")"
# The same extension, so that ffmpeg knows the format; complete or not there at all.
unfinished=${video%.*}.unfinished.${video##*.}
trap 'rm -f "$unfinished"' EXIT
ffmpeg -nostdin -v error -y "${input[@]}" \
    -vf "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p" \
    -c:v libx264 -preset slow -crf 16 -movflags +faststart \
    -color_primaries bt709 -color_trc bt709 -colorspace bt709 -color_range tv \
    "$unfinished"
encoded=$(ffprobe -v error -count_frames -select_streams v:0 \
    -show_entries stream=nb_read_frames -of csv=p=0 "$unfinished")
[ "$encoded" = "$count" ] || fail "the video has $encoded frames instead of $count"
mv "$unfinished" "$video"
echo "$video: $count frames at $fps per second"
