#!/usr/bin/env bash
# Renders a camera path on a Slurm cluster, and makes a video of it.
#
#   scripts/submit_slurm.sh SCENE PATH FRAMES_DIR VIDEO.mp4 [options of flythrough render]
#
# Submits an array of tasks that render CHUNK frames each, and a job that makes the video once all of them
# are done; before them a job that bakes the irradiance cache, if frames need one. If some fail, the same command
# picks up: it submits the tasks whose frames are not verified, and a new video job; what still waits of the earlier
# submission is cancelled. A job that reaches its time limit gives up what it is at and is queued again: a task goes on
# with its next frame, the cache is baked anew.
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

[ $# -ge 4 ] || fail "usage: submit_slurm.sh SCENE PATH FRAMES_DIR VIDEO.mp4 [options of flythrough render]"
command -v sbatch >/dev/null || fail "sbatch is not in \$PATH: is this a machine of the cluster?"
scripts=$(cd -- "$(dirname -- "$0")" && pwd)
FLYTHROUGH=$(type -P -- "${FLYTHROUGH:-$scripts/../target/release/flythrough}") \
    || FLYTHROUGH=$(type -P -- "${FLYTHROUGH:-flythrough}") \
    || fail "flythrough is neither built (cargo build --release) nor in \$PATH, or not what \$FLYTHROUGH says"
export FLYTHROUGH
chunk=${CHUNK:-10} cpus=${CPUS:-4} most=${MOST:-}
for number in "$chunk" "$cpus" "${most:-1}"; do
    [[ $number =~ ^[1-9][0-9]{0,8}$ ]] || fail "CHUNK, CPUS and MOST are whole numbers above 0"
done

# Whether options say what this script has to. Short ones may stand together, as in -qf0-3, up to one with a value.
is_reserved() {
    local letters
    case $1 in
        --) return 0 ;;
        --frames | --force | --prepare | --out | --budget | --preview | --help) return 0 ;;
        --frames=* | --prepare=* | --out=* | --budget=*) return 0 ;;
        --* | [!-]*) return 1 ;;
    esac
    letters=${1#-}
    # Of the short options -m, -s and -t take a value, -q takes none.
    letters=${letters%%[mst]*}
    [[ $letters == *[foh]* ]]
}
for option in "${@:5}"; do
    ! is_reserved "$option" \
        || fail "$(LC_ALL=C printf %q "$option"): what tasks render is for this script to say; --budget knows of one machine only"
done
# A name that begins with a slash is no option.
frames_dir=$3
[[ $frames_dir == /* ]] || frames_dir=$PWD/$frames_dir
[[ $frames_dir != *\\* ]] || fail "$(LC_ALL=C printf %q "$frames_dir"): Slurm cannot write logs where a name has a backslash"
# A command of the program: its own options, those of the user, and the inputs, whose names may begin with a hyphen.
command=("$FLYTHROUGH" render --out="$frames_dir" "${@:5}")
inputs=(-- "$1" "$2")

# Records the expected frames; frames that are there of something else count as missing from now on.
"${command[@]}" --prepare sequence "${inputs[@]}"
mkdir -p -- "$frames_dir/logs" || fail "its folder logs cannot be made"
entry() { "$FLYTHROUGH" status --get "$1" -- "$frames_dir"; }
count=$(entry frames)
largest_array=$(scontrol show config | sed -nE 's/^MaxArraySize *= *([0-9]+).*/\1/p')
needed=$(( (count + largest_array - 1) / largest_array ))
[ "$chunk" -ge "$needed" ] || chunk=$needed
tasks=$("$FLYTHROUGH" missing --quiet --format slurm --chunk "$chunk" -- "$frames_dir")

# What waits of an earlier submission: for tasks that failed, or for frames that are made anew. The file holds the ids of
# jobs, each on a line.
jobs=$frames_dir/logs/jobs
if [ -e "$jobs" ] || [ -L "$jobs" ]; then
    { [ ! -L "$jobs" ] && [ -f "$jobs" ] && ! grep -qvE '^[0-9]+$' -- "$jobs"; } \
        || fail "$(LC_ALL=C printf %q "$jobs"): is not this script's list of jobs; move it away"
    while read -r id; do scancel --quiet --state=PENDING "$id" || true; done < "$jobs"
fi
list=$(mktemp -- "$jobs.XXXXXXXXXX")
mv -fT -- "$list" "$jobs"

# Submits a job by its name, the pattern of its log and options of sbatch, and puts its id into $id. The batch script
# comes on stdin.
submit() {
    local name=$1 log=$2
    shift 2
    id=$(sbatch --parsable --requeue --open-mode=append --job-name="$name" \
        --output="${frames_dir//\%/%%}/logs/$log" "$@")
    id=${id%%;*}
    echo "$id" >> "$jobs"
}
quoted() { printf '%q ' "$@"; }

# A batch script that ends a command in time and queues it again: `gently MOST_RESTARTS ID COMMAND`, where ID is the
# job's for scontrol. ID and COMMAND are text of the script.
gently() {
    cat <<JOB
#!/usr/bin/env bash
cd -- $(quoted "$PWD") || exit
end() { [ -z "\$child" ] || kill -TERM "\$child" 2>/dev/null; is_ended=1; }
child='' is_ended='' is_late=''
# USR1 comes a minute before the time limit, TERM with scancel.
trap 'is_late=1; end' USR1
trap end TERM
$3 &
child=\$!
[ -z "\$is_ended" ] || end
# A signal ends the first wait; the last one gives the status, however soon the child has ended.
while kill -0 "\$child" 2>/dev/null; do wait "\$child"; done
wait "\$child"
status=\$?
# What takes longer than the time limit would be begun for ever.
if [ \$status = 75 ] && [ -n "\$is_late" ]; then
    [ "\${SLURM_RESTART_COUNT:-0}" -ge $1 ] || exec scontrol requeue "$2"
    echo "queued again often enough: it needs more time (SBATCH_TIMELIMIT)"
fi
exit \$status
JOB
}

after=()
if [ -n "$tasks" ]; then
    if [ "$(entry irradiance_cache)" = true ]; then
        # shellcheck disable=SC2016 # expanded by the job
        submit cache cache_%j.log --cpus-per-task="$cpus" --signal=B:USR1@60 \
            < <(gently 3 '$SLURM_JOB_ID' "$(quoted "${command[@]}" --prepare cache "${inputs[@]}")")
        after=(--dependency="afterok:$id" --kill-on-invalid-dep=no)
    fi
    range="first=\$((SLURM_ARRAY_TASK_ID * $chunk)) last=\$((SLURM_ARRAY_TASK_ID * $chunk + $chunk - 1))
[ \$last -lt $count ] || last=$((count - 1))"
    # shellcheck disable=SC2016 # expanded by the job
    submit render render_%A_%a.log --cpus-per-task="$cpus" --signal=B:USR1@60 \
        --array="$tasks${most:+%$most}" ${after[@]+"${after[@]}"} \
        < <(gently "$chunk" '${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID' \
            "$range
$(quoted "${command[@]}") --frames \$first-\$last $(quoted "${inputs[@]}")")
    after=(--dependency="afterok:$id" --kill-on-invalid-dep=no)
    echo "frames: job $id, tasks $tasks of $chunk frames"
else
    echo "frames: all of them are verified"
fi

submit video video_%j.log ${after[@]+"${after[@]}"} <<JOB
#!/usr/bin/env bash
cd -- $(quoted "$PWD") || exit
exec $(quoted "$scripts/make_video.sh" -- "$frames_dir" "$4")
JOB
echo "video: job $id"
