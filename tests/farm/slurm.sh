#!/usr/bin/env bash
# Starts a Slurm of this machine alone, renders on it by scripts/submit_slurm.sh while one task is killed and
# another runs out of time, picks up what is missing, and compares the frames with those of a local run.
#
# Needs root, and Debian's munge, slurmctld, slurmd, slurm-client and ffmpeg.
#
#   tests/farm/slurm.sh [LOCAL]
#
# The local run's frames are kept in the folder LOCAL, and taken from there if they are there.
set -euo pipefail
cd "$(dirname "$0")/../.."

fail() { echo "slurm: $*" >&2; exit 1; }

dir=$(mktemp -d)
stop() {
    status=$?
    # Its log tells why a cluster did not start.
    [ $status = 0 ] || tail -n 30 "$dir"/*.log "$dir"/frames/logs/* >&2 || true
    for daemon in slurmctld slurmd munged; do
        [ ! -f "$dir/$daemon.pid" ] || kill "$(cat "$dir/$daemon.pid")" || true
    done
    # They still write while they stop.
    rm -rf "$dir" 2>/dev/null || { sleep 2; rm -rf "$dir"; } || true
    exit $status
}
trap stop EXIT

chmod 711 "$dir"
mkdir "$dir/munge" "$dir/state" "$dir/spool"
chmod 711 "$dir/munge"
head -c 1024 /dev/urandom > "$dir/munge/key"
chmod 400 "$dir/munge/key"
munged --force --key-file="$dir/munge/key" --socket="$dir/munge/socket" --seed-file="$dir/munge/seed" \
    --pid-file="$dir/munged.pid" --log-file="$dir/munged.log"

# Queued again, a job waits for its credentials to expire: 10 s, not 120.
host=$(hostname -s)
cat > "$dir/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket,cred_expire=10
SlurmUser=root
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool
SlurmctldPidFile=$dir/slurmctld.pid
SlurmdPidFile=$dir/slurmd.pid
SlurmctldLogFile=$dir/slurmctld.log
SlurmdLogFile=$dir/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MaxArraySize=8
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$dir/slurm.conf
slurmctld
slurmd

# Waits, for two minutes at most, until a command succeeds.
until_so() {
    local what=$1
    shift
    for ((i = 0; i < 1200; i++)); do
        if "$@"; then return; fi
        sleep 0.1
    done
    fail "$what: not so after two minutes"
}
is_up() { [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ]; }
until_so "the cluster is idle" is_up

export FLYTHROUGH=$PWD/target/release/flythrough
input=(scenes/test2.ron paths/zoom.ron)
options=(--mode montecarlo --size 128x72 --samples 32)
local=${1:-$dir/local}
"$FLYTHROUGH" render "${input[@]}" --out "$local" "${options[@]}" --quiet

frames=$dir/frames video=$dir/zoom.mp4
submit() {
    CHUNK=5 CPUS=1 scripts/submit_slurm.sh "${input[@]}" "$frames" "$video" "${options[@]}"
}
submit
# Of 55 frames an array of 8 holds chunks of 7.
array=$(squeue --noheader --name=render --format=%F | head -n 1)
is_rendering() { pgrep -f "render .* --frames $1" >/dev/null && [ -f "$frames/frame_$2.png" ]; }
until_so "the third task is rendering" is_rendering 14-20 00014
pkill -KILL -f "render .* --frames 14-20"
until_so "the fourth task is rendering" is_rendering 21-27 00021
# What Slurm does a minute before a task's time is over; its shortest time is a minute, too.
kill -USR1 "$(ps -o ppid= -p "$(pgrep -f "render .* --frames 21-27")")"
was_queued_again() { [ "$(scontrol show job "${array}_3" | sed -nE 's/.*Restarts=([0-9]+).*/\1/p')" = 1 ]; }
until_so "the fourth task is queued again" was_queued_again
is_over() { [ "$(squeue --noheader --name=render --states=all --format=%T | grep -vcE 'COMPLETED|FAILED')" = 0 ]; }
until_so "all tasks are over" is_over

[ "$("$FLYTHROUGH" missing --quiet "$frames" --format slurm --chunk 7)" = 2 ] || fail "other tasks than the third failed"
[ ! -e "$video" ] || fail "there is a video of frames that are missing"
submit
until_so "the video is made" test -f "$video"
"$FLYTHROUGH" verify --quiet "$frames"
for frame in "$local"/frame_*; do
    cmp "$frame" "$frames/${frame##*/}"
done
grep -q interrupted "$frames/logs/render_${array}_3.log" || fail "the fourth task was not interrupted"
[[ $(submit) == *"all of them are verified"* ]] || fail "verified frames are submitted again"
until_so "the second video is made" test "$video" -nt "$frames/logs/video.job"
echo "slurm: one task killed, one out of time, all frames as of a local run"
