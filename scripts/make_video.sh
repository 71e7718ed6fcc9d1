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

folder=${video%/*}/
# The hashes of the videos that were made of these frames.
made=$frames/videos.sha256
refuse_to_overwrite() {
    if [ -L "$video" ] || { [ -e "$video" ] && [ ! -f "$video" ]; }; then
        fail "$video_shown: is not a regular file; use another name"
    fi
    [ -e "$video" ] && [ -z "$replace" ] || return 0
    local hash
    hash=$(sha256sum < "$video")
    { [ ! -L "$made" ] && [ -f "$made" ] && grep -qxF -- "${hash%% *}" "$made"; } \
        || fail "$video_shown: is there already, and not as this script has made it; use another name, or --replace"
}

# The values, and the files by their inodes, sizes and times.
entry() {
    local value
    value=$("$program" status --get "$1" -- "$frames") && echo "${value%$'\r'}"
}
state() {
    entry fps && entry frames && entry format \
        && find "$frames/" -maxdepth 1 -name 'frame_*' -printf '%f %i %s %T@\n' | sort
}
probe() { ffprobe -v error -f $container "$@"; }

# Makes the video under the name $unfinished, and gives it its own in the end.
make() {
    refuse_to_overwrite
    local verified fps count format encoded hash status=0
    verified=$(state)
    { read -r fps; read -r count; read -r format; } <<< "$verified"
    [ "$format" != exr ] || fail "$frames_shown: the frames are $format; videos are made of PNG frames"
    "$program" verify --quiet ${recorded[@]+"${recorded[@]}"} -- "$frames" >&2 || status=$?
    [ $status != 3 ] || fail "$frames_shown: not every frame is verified; render the sequence again" 3
    [ $status = 0 ] || exit $status
    mkdir -p -- "$folder" || fail "$video_shown: cannot be written"
    # Nothing has that name, and no link of that name is followed.
    (set -C && : > "$unfinished") || fail "$video_shown: cannot be written"
    # In the folder of the frames, whose name would be part of ffmpeg's pattern.
    (cd -- "$frames" && exec ffmpeg -nostdin -v error -xerror -y \
        -f image2 -pattern_type sequence -framerate "$fps" -start_number 0 -i frame_%05d.png \
        -vf "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p" \
        -c:v libx264 -preset slow -crf 16 -movflags +faststart \
        -color_primaries bt709 -color_trc bt709 -colorspace bt709 -color_range tv \
        -f $container "file:$unfinished") || fail "$video_shown: ffmpeg could not encode it" 3
    encoded=$(probe -count_frames -select_streams v:0 \
        -show_entries stream=nb_read_frames -of csv=p=0 "file:$unfinished") || encoded=none
    [ "$encoded" = "$count" ] || fail "$video_shown: has $encoded frames instead of $count" 3
    [ "$(state)" = "$verified" ] \
        || fail "$frames_shown: the frames have changed meanwhile; make the video again" 3
    hash=$(sha256sum < "$unfinished")
    record "${hash%% *}"
    refuse_to_overwrite
    mv -fT -- "$unfinished" "$video"
    echo "$video_shown: $count frames at $fps per second"
}
# Adds a hash to those of the videos that were made; frames that cannot be written have none.
record() {
    [ -L "$made" ] || ! grep -qsxF -- "$1" "$made" || return 0
    (set -C && : > "$hashes") 2>/dev/null || return 0
    [ -L "$made" ] || [ ! -f "$made" ] || cat -- "$made" > "$hashes"
    echo "$1" >> "$hashes"
    mv -fT -- "$hashes" "$made"
}

# All of it is done by a group of processes of its own: a signal ends them at once, and leaves nothing of them.
unfinished=$(mktemp -u -- "$folder.make_video.XXXXXXXXXX")
hashes=$(mktemp -u -- "$frames/.videos.sha256.XXXXXXXXXX")
worker=''
# shellcheck disable=SC2317 # called by the trap
interrupted() {
    trap '' INT TERM HUP USR1
    echo "make_video: interrupted" >&2
    # The shell would say what it has killed.
    exec 2>/dev/null
    [ -z "$worker" ] || kill -KILL -- "-$worker" 2>/dev/null || true
    rm -f -- "$unfinished" "$hashes"
    exit 75
}
set -m
trap interrupted INT TERM HUP USR1
make &
worker=$!
status=0
while :; do
    wait "$worker" && status=0 || status=$?
    kill -0 "$worker" 2>/dev/null || break
done
rm -f -- "$unfinished" "$hashes"
exit $status
