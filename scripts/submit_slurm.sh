#!/usr/bin/env bash
# Renders a camera path on a Slurm cluster, and makes a video of it.
#
#   scripts/submit_slurm.sh SCENE PATH FRAMES_DIR VIDEO.mp4 [options of flythrough render]
#
# Submits an array of tasks that render CHUNK frames each, and a job that makes the video once all of them
# are done. If some fail, the same command picks up: it submits the tasks whose frames are not verified, and a
# new video job in place of the one that waits. A task that reaches its time limit gives up the frames in
# flight and is queued again, to go on from there.
#
# From the environment:
#   CHUNK=10       frames of a task; more if the array would be larger than the cluster allows
#   CPUS=4         processors of a task
#   MOST=          tasks that run at a time (default: all)
#   SBATCH_...     what sbatch itself reads: SBATCH_PARTITION, SBATCH_TIMELIMIT, SBATCH_ACCOUNT and so on
#   FLYTHROUGH=    the program (default: as for make_video.sh)
#
# All files have to be seen under the same names by all nodes. Logs are kept in FRAMES_DIR/logs.
set -euo pipefail

fail() { echo "submit_slurm: $*" >&2; exit 2; }

[ $# -ge 4 ] || fail "usage: $0 SCENE PATH FRAMES_DIR VIDEO.mp4 [options of flythrough render]"
command -v sbatch >/dev/null || fail "sbatch is not in \$PATH: is this a machine of the cluster?"
scripts=$(cd "$(dirname "$0")" && pwd)
export FLYTHROUGH=${FLYTHROUGH:-$scripts/../target/release/flythrough}
[ -x "$FLYTHROUGH" ] || FLYTHROUGH=$(command -v flythrough) \
    || fail "flythrough is neither built (cargo build --release) nor in \$PATH"
for option in "${@:5}"; do
    case $option in
        --frames* | -f* | --force | --prepare* | --out* | -o* | --budget*)
            fail "$option: what tasks render is for this script to say; --budget knows of one machine only" ;;
    esac
done
frames_dir=$3 video=$4
render=("$FLYTHROUGH" render "$1" "$2" --out "$frames_dir" "${@:5}")

# Records the expected frames; frames that are there of something else count as missing from now on.
"${render[@]}" --prepare sequence
mkdir -p "$frames_dir/logs"
entry() { "$FLYTHROUGH" status "$frames_dir" --get "$1"; }
count=$(entry frames)
largest_array=$(scontrol show config | sed -nE 's/^MaxArraySize *= *([0-9]+).*/\1/p')
chunk=${CHUNK:-10}
needed=$(( (count + largest_array - 1) / largest_array ))
[ "$chunk" -ge "$needed" ] || chunk=$needed
tasks=$("$FLYTHROUGH" missing --quiet "$frames_dir" --format slurm --chunk "$chunk")

# A job whose id is printed; the batch script comes on stdin.
submit() {
    local id
    id=$(sbatch --parsable --requeue --open-mode=append "$@")
    echo "${id%%;*}"
}
quoted() { printf '%q ' "$@"; }

after=()
if [ -n "$tasks" ]; then
    if [ "$(entry irradiance_cache)" = true ]; then
        cache=$(submit --job-name=cache --cpus-per-task="${CPUS:-4}" --output="$frames_dir/logs/cache_%j.log" <<JOB
#!/usr/bin/env bash
exec $(quoted "${render[@]}" --prepare cache)
JOB
        )
        after=(--dependency="afterok:$cache" --kill-on-invalid-dep=yes)
    fi
    array=$(submit --job-name=render --cpus-per-task="${CPUS:-4}" --array="$tasks${MOST:+%$MOST}" \
        --signal=B:USR1@60 --output="$frames_dir/logs/render_%A_%a.log" "${after[@]}" <<TASK
#!/usr/bin/env bash
first=\$((SLURM_ARRAY_TASK_ID * $chunk))
last=\$((first + $chunk - 1))
[ \$last -lt $count ] || last=$((count - 1))
$(quoted "${render[@]}") --frames \$first-\$last &
# USR1 comes a minute before the time limit, TERM with scancel.
trap 'is_late=1; kill -TERM \$!' USR1
trap 'kill -TERM \$!' TERM
while wait \$!; status=\$?; kill -0 \$! 2>/dev/null; do :; done
# A frame that takes longer than the time limit would be begun for ever.
if [ \$status = 75 ] && [ -n "\${is_late:-}" ] && [ "\${SLURM_RESTART_COUNT:-0}" -lt $chunk ]; then
    exec scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID"
fi
exit \$status
TASK
    )
    after=(--dependency="afterok:$array" --kill-on-invalid-dep=no)
    echo "frames: job $array, tasks $tasks of $chunk frames"
else
    echo "frames: all of them are verified"
fi

# The video job of an earlier submission waits for tasks that failed, or for frames that are made anew.
waiting=$frames_dir/logs/video.job
[ ! -f "$waiting" ] || scancel --quiet "$(cat "$waiting")" || true
submit --job-name=video --output="$frames_dir/logs/video_%j.log" "${after[@]}" > "$waiting" <<JOB
#!/usr/bin/env bash
exec $(quoted "$scripts/make_video.sh" "$frames_dir" "$video")
JOB
echo "video: job $(cat "$waiting")"
