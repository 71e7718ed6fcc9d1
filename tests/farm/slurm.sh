#!/usr/bin/env bash
# Starts a Slurm of this machine alone, renders on it by scripts/submit_slurm.sh while the job of the irradiance cache
# and a task run out of time and another task is killed, picks up what is missing, and compares the frames with those
# of a local run. All names hold what a shell, sbatch or ffmpeg might take for something else.
#
# Needs root, and Debian's munge, slurmctld, slurmd, slurm-client and ffmpeg.
#
#   tests/farm/slurm.sh [LOCAL]
#
# The local run's frames are kept in the folder LOCAL, and taken from there if they are there.
set -euo pipefail
cd "$(dirname "$0")/../.."
repository=$PWD

fail() { echo "slurm: $*" >&2; exit 1; }

dir=$(mktemp -d)
name=$'-it\'s 100%A%%\n"$(touch RUN)" *é'
frames=$name.frames video=$name.mp4
stop() {
    status=$?
    # Its log tells why a cluster did not start.
    [ $status = 0 ] || tail -n 30 "$dir"/*.log "$dir/$frames"/logs/* >&2 || true
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

# Queued again, a job waits for its credentials to expire, 10 s, not 120, and for the next look at the queue, 1 s, not 60.
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
SchedulerParameters=sched_interval=1
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

export FLYTHROUGH=$repository/target/release/flythrough
options=(--mode montecarlo --size 128x72 --samples 32)
local=${1:-$dir/local}
# 55 frames.
sed "s/2\.75/1.125/; s/5\.5/2.25/" paths/zoom.ron > "$dir/short.ron"
"$FLYTHROUGH" render scenes/test2.ron "$dir/short.ron" --out "$local" "${options[@]}" --quiet
local=$(cd "$local" && pwd)

cd "$dir"
cp "$repository/scenes/test2.ron" "./$name.ron"
cp "$dir/short.ron" "./$name.path"
ln -s "$repository/scenes/models" "$repository/scenes/textures" .
submit() {
    CHUNK=5 CPUS=1 "$repository/scripts/submit_slurm.sh" "$name.ron" "$name.path" "$frames" "$video" \
        "${options[@]}" "$@"
}
for option in -f3 -qf0-3 --out=x -ofoo --frames=3 --budget=1h --force -- -hq; do
    if submit "$option" >/dev/null 2>&1; then fail "$option is not refused"; fi
done
[ ! -e "$frames" ] || fail "a refused option has made a folder"
submit
# Processes of this test alone: other tests of the machine have other folders.
process() { pgrep -f "render --out=$dir/.* $1 "; }
restarts_once() { [ "$(scontrol show job "$1" | sed -nE 's/.*Restarts=([0-9]+).*/\1/p')" = 1 ]; }
# What Slurm does a minute before a job's time is over; its shortest time is a minute, too.
run_out_of_time() { kill -USR1 "$(ps -o ppid= -p "$(process "$1")" | tr -d ' ')"; }
is_baking() { process "--prepare cache" >/dev/null; }
cache=$(squeue --noheader --name=cache --format=%F)
until_so "the cache is baked" is_baking
run_out_of_time "--prepare cache"
until_so "the job of the cache is queued again" restarts_once "$cache"
array=$(squeue --noheader --name=render --format=%F | head -n 1)
is_rendering() { process "--frames $1" >/dev/null && [ -f "$frames/frame_$2.png" ]; }
until_so "the third task is rendering" is_rendering 14-20 00014
kill -KILL "$(process "--frames 14-20")"
until_so "the fourth task is rendering" is_rendering 21-27 00021
run_out_of_time "--frames 21-27"
until_so "the fourth task is queued again" restarts_once "${array}_3"
is_over() { [ "$(squeue --noheader --name=render --states=all --format=%T | grep -vcE 'COMPLETED|FAILED')" = 0 ]; }
until_so "all tasks are over" is_over

[ "$("$FLYTHROUGH" missing --quiet --format slurm --chunk 7 -- "$frames")" = 2 ] || fail "other tasks than the third failed"
[ ! -e "./$video" ] || fail "there is a video of frames that are missing"
submit
until_so "the video is made" test -f "./$video"
"$FLYTHROUGH" verify --quiet -- "$frames"
for frame in "$local"/frame_*; do
    cmp "$frame" "./$frames/${frame##*/}"
done
grep -q interrupted -- "$frames/logs/render_${array}_3.log" || fail "the fourth task was not interrupted"
[[ $(submit) == *"all of them are verified"* ]] || fail "verified frames are submitted again"
until_so "the second video is made" test "./$video" -nt "$frames/logs/jobs"
[ -z "$(find . -name RUN)" ] || fail "a name was run"
echo "slurm: cache and one task out of time, one task killed, all frames as of a local run"
