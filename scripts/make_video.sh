#!/usr/bin/env bash
# Makes a video of a folder of frames.
#
#   scripts/make_video.sh [--replace] [--as-recorded] [--] FRAMES_DIR VIDEO.mp4
#
# The frame rate is the sequence's (flythrough status). Refuses a folder in which a frame is not verified
# (flythrough verify) before it encodes, and counts the video's frames after. Colours are
# converted to BT.709, and the video says so; an odd width or height is padded by one black line.
#
#   --replace      overwrite VIDEO even if it is none that this script has made
#   --as-recorded  verify frames against what was recorded when they were rendered, if their inputs are gone
#
# The video is H.264 in MP4, QuickTime (.mov) or Matroska (.mkv). It appears under its name when it is complete.
#
# Exit status: 0 success; 2 wrong usage, or inputs that cannot be loaded; 3 frames are not verified or have changed, or
# ffmpeg failed; 75 interrupted.
#
# The program is $FLYTHROUGH, else the one that was built beside this script, else the one in $PATH.
set -euo pipefail

fail() { echo "make_video: $1" >&2; exit "${2:-2}"; }
# A name as bash quotes it, without control characters and, which bash leaves, controls of the writing direction.
shown() {
    case $1 in
        *[$'\u061c\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff']*) LC_ALL=C printf %q "$1" ;;
        *) printf %q "$1" ;;
    esac
}

child='' unfinished=''
interrupted() {
    trap '' INT TERM HUP USR1
    # A program that has just begun has no number yet.
    for process in ${child:-$(jobs -p)}; do kill -KILL "$process" 2>/dev/null || true; done
    exit 75
}
trap interrupted INT TERM HUP USR1
trap '[ -z "$unfinished" ] || rm -f -- "$unfinished"' EXIT
# Runs a program such that a signal does not wait for its end.
run() {
    "$@" &
    child=$!
    local status=0
    wait "$child" || status=$?
    child=''
    return "$status"
}

# Whatever else begins with a hyphen is a name.
replace='' recorded=()
while [ $# -gt 0 ]; do
    case $1 in
        --replace) replace=1 ;;
        --as-recorded) recorded=(--as-recorded) ;;
        --) shift; break ;;
        *) break ;;
    esac
    shift
done
if [ $# -ne 2 ] || [ -z "$1" ] || [ -z "$2" ]; then
    fail "usage: make_video.sh [--replace] [--as-recorded] [--] FRAMES_DIR VIDEO.mp4"
fi
# A name that begins with a slash is neither an option nor one of ffmpeg's protocols.
frames=$1 video=$2
frames_shown=$(shown "$1") video_shown=$(shown "$2")
[[ $frames == /* ]] || frames=$PWD/$frames
[[ $video == /* ]] || video=$PWD/$video
name=${video##*/}
case $name in
    ?*.[mM][pP]4) container=mp4 ;;
    ?*.[mM][oO][vV]) container=mov ;;
    ?*.[mM][kK][vV]) container=matroska ;;
    *) fail "$video_shown: the name must say its format: name it .mp4, .mov or .mkv" ;;
esac
for tool in ffmpeg ffprobe; do
    command -v $tool >/dev/null || fail "$tool is not installed (Debian: apt-get install ffmpeg)"
done
program=$(type -P -- "${FLYTHROUGH:-$(dirname -- "$0")/../target/release/flythrough}") \
    || program=$(type -P -- "${FLYTHROUGH:-flythrough}") \
    || fail "flythrough is neither built (cargo build --release) nor in \$PATH, or not what \$FLYTHROUGH says"

# Every video of this script carries this comment.
mark="made by flythrough make_video.sh"
probe() { exec ffprobe -v error -f $container "$@"; }
refuse_to_overwrite() {
    if [ -L "$video" ] || { [ -e "$video" ] && [ ! -f "$video" ]; }; then
        fail "$video_shown: is not a regular file; use another name"
    fi
    [ -e "$video" ] && [ -z "$replace" ] || return 0
    local comment
    comment=$(probe -show_entries format_tags=comment -of default=nw=1:nk=1 "file:$video" 2>/dev/null) || true
    [ "$comment" = "$mark" ] \
        || fail "$video_shown: is there already, and not made by this script; use another name, or --replace"
}
refuse_to_overwrite

# The values, and the files by their inodes, sizes and times.
entry() {
    local value
    value=$("$program" status --get "$1" -- "$frames") && echo "${value%$'\r'}"
}
state() {
    entry fps && entry frames && entry format \
        && find "$frames/" -maxdepth 1 -name 'frame_*' -printf '%f %i %s %T@\n' | sort
}
verified=$(state)
{ read -r fps; read -r count; read -r format; } <<< "$verified"
[ "$format" != exr ] || fail "$frames_shown: the frames are $format; videos are made of PNG frames"
status=0
run "$program" verify --quiet ${recorded[@]+"${recorded[@]}"} -- "$frames" >&2 || status=$?
[ $status != 3 ] || fail "$frames_shown: not every frame is verified; render the sequence again" 3
[ $status = 0 ] || exit $status
folder=${video%/*}/
mkdir -p -- "$folder" || fail "$video_shown: cannot be written"
# Complete or not there at all.
unfinished=$(mktemp -- "$folder.make_video.XXXXXXXXXX") || fail "$video_shown: cannot be written"
# In the folder of the frames, whose name would be part of ffmpeg's pattern.
encode() {
    cd -- "$frames" && exec ffmpeg -nostdin -v error -xerror -y \
        -f image2 -pattern_type sequence -framerate "$fps" -start_number 0 -i frame_%05d.png \
        -vf "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p" \
        -c:v libx264 -preset slow -crf 16 -movflags +faststart \
        -color_primaries bt709 -color_trc bt709 -colorspace bt709 -color_range tv \
        -metadata comment="$mark" -f $container "file:$unfinished"
}
run encode || fail "$video_shown: ffmpeg could not encode it" 3
exec 3< <(probe -count_frames -select_streams v:0 \
    -show_entries stream=nb_read_frames -of csv=p=0 "file:$unfinished")
child=$!
wait "$child" || true
child=''
read -r encoded <&3 || encoded=none
[ "$encoded" = "$count" ] || fail "$video_shown: has $encoded frames instead of $count" 3
[ "$(state)" = "$verified" ] \
    || fail "$frames_shown: the frames have changed meanwhile; make the video again" 3
# Readable by those that the umask allows; mktemp allows the owner alone.
chmod +rw -- "$unfinished"
refuse_to_overwrite
mv -fT -- "$unfinished" "$video"
unfinished=''
echo "$video_shown: $count frames at $fps per second"
