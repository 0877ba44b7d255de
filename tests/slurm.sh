#!/usr/bin/env bash
# The batch scripts of scenarios/cluster under a Slurm of two nodes that runs on this machine alone:
# time limits that strike, requeues, a cancelled job, a node whose power is cut, a killed rank. What
# comes out is compared, bit by bit, with runs that nothing disturbed.
#
# Everything is the test's own and in a scratch folder: configuration, ports, munge's key and
# socket, spools. A Slurm or munge that this machine runs is not touched. Speaks TAP, ends with
# "N passed, N failed"; takes some five minutes. Needs root, as slurmd does.
# Usage: tests/slurm.sh   (make test-slurm)
set -u
cd "$(dirname "$0")/.." || exit 1
stance=${STANCE:-$PWD/bin/stance} python=${PYTHON:-/usr/bin/python3} tests=$PWD/tests
scripts=$PWD/scenarios/cluster
PATH=$PATH:/usr/sbin:/sbin
missing=
for program in munged slurmctld slurmd sbatch mpirun; do
    command -v $program >/dev/null || missing="$missing $program"
done
[ "$(id -u)" = 0 ] || missing="$missing root"
[ "$(uname -s)" = Linux ] || missing="$missing Linux"
if [ -n "$missing" ]; then
    echo "test-slurm skips everything: it needs$missing (make test-slurm installs programs)"
    echo "0 passed, 0 failed"
    exit 0
fi

# ---- a cluster of our own, and its end -----------------------------------------------------------
scratch=$(mktemp -d)
chmod 755 "$scratch" # munge wants its socket where others may come
cluster=$scratch/cluster work=$scratch/work
mkdir "$cluster" "$cluster/controller" "$cluster/n1" "$cluster/n2" "$work" "$work/results"

# Processes of jobs, and those that look after them: they alone have this configuration and a job's
# number in their environment, or are called slurmstepd.
job_processes() {
    local file pid
    for file in /proc/[0-9]*/environ; do
        pid=${file//[!0-9]/}
        # shellcheck disable=SC2015
        grep -qzx "SLURM_CONF=$cluster/slurm.conf" "$file" 2>/dev/null &&
            { grep -qz '^SLURM_JOB_ID=' "$file" 2>/dev/null ||
                [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = slurmstepd ]; } && echo "$pid"
    done
}
# shellcheck disable=SC2317 # what the trap calls
{
stop_daemon() { # name: waits until it has gone
    local pid
    pid=$(cat "$cluster/$1.pid" 2>/dev/null) || return 0
    kill "$pid" 2>/dev/null
    for _ in $(seq 50); do
        kill -0 "$pid" 2>/dev/null || break
        sleep 0.1
    done
    kill -9 "$pid" 2>/dev/null
    rm -f "$cluster/$1.pid"
}
# shellcheck disable=SC2046 # a list of numbers
clean_up() {
    trap '' INT TERM
    stop_daemon controller
    stop_daemon n1
    stop_daemon n2
    kill -9 $(job_processes) 2>/dev/null
    stop_daemon munged
    wait
    rm -rf "$scratch"
}
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP

is_free() { ! (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }
port=21800
until is_free $port && is_free $((port + 1)) && is_free $((port + 2)); do
    port=$((port + 10))
done

head -c 1024 /dev/urandom >"$cluster/munge.key" && chmod 400 "$cluster/munge.key"
cat >"$cluster/slurm.conf" <<END_OF_FILE
ClusterName=stance
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$port
AuthType=auth/munge
CredType=cred/munge
# A job that is put back may start after so many seconds (the least there may be; by default 120).
AuthInfo=socket=$cluster/munge.socket,cred_expire=5
StateSaveLocation=$cluster/controller
SlurmdSpoolDir=$cluster/%n
SlurmctldPidFile=$cluster/controller.pid
SlurmdPidFile=$cluster/%n.pid
SlurmctldLogFile=$cluster/controller.log
SlurmdLogFile=$cluster/%n.log
JobCompType=jobcomp/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=10
KillWait=20
SchedulerParameters=batch_sched_delay=1,sched_interval=2,bf_interval=2
NodeName=n1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=2
NodeName=n2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=2
PartitionName=batch Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
END_OF_FILE
echo 'CgroupPlugin=autodetect' >"$cluster/cgroup.conf"
export SLURM_CONF=$cluster/slurm.conf
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export PMIX_MCA_gds=hash OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1
# Both nodes are one machine: neither may take processors for itself.
export OMPI_MCA_hwloc_base_binding_policy=none

cd "$work" || exit 1
count=0
# shellcheck source=tests/outside.sh
. "$tests/outside.sh"
clause_words+="exits restarts logged same "
die() {
    echo "Bail out! $1"
    tail -n 20 "$cluster"/*.log | sed 's/^/# /'
    echo "$((count - failed)) passed, $((failed + 1)) failed"
    exit 1
}
note() { sed 's/^/# /'; }

munged --key-file="$cluster/munge.key" --socket="$cluster/munge.socket" \
    --pid-file="$cluster/munged.pid" --log-file="$cluster/munged.log" \
    --seed-file="$cluster/munge.seed" || die "munged does not start"
slurmctld -f "$SLURM_CONF" || die "slurmctld does not start"
start_node() { slurmd -f "$SLURM_CONF" -N "$1" || die "slurmd does not start"; }
start_node n1
start_node n2
idle_nodes() { sinfo --noheader --Node --states=idle --format=%N 2>/dev/null | wc -l; }
both_idle() { (($(idle_nodes) == 2)); }
await - both_idle || die "the nodes do not come up"
sinfo | note

# ---- jobs ----------------------------------------------------------------------------------------
# What Slurm knows of a job: state, restarts, exit code ...
known() { # job, key
    scontrol --oneliner show job "$1" 2>/dev/null | tr ' ' '\n' | sed -n "s/^$2=//p" | head -n 1
}
watch() { squeue --noheader --job="$1" --format='%.6i %.9j %.10T %.6M %.8l  %N %r' 2>/dev/null; }
submit() { # options and script; sets job
    job=$(sbatch --parsable "$@") || die "sbatch $*"
}
# Until the job is in none of the states of one that is not over; notes what squeue says meanwhile.
await_end() { # job
    state=
    await - is_over "$1"
}
is_over() { # job
    local last=$state
    state=$(known "$1" JobState)
    [ "$state" = "$last" ] || watch "$1" | note
    case $state in
    PENDING | RUNNING | COMPLETING | SUSPENDED | CONFIGURING | REQUEUED) sleep 1 && return 1 ;;
    esac
}
# What has become of the job.
ended() { # name, state [clause ...]
    await_end "$job"
    echo "job $job is $state, exit code $(known "$job" ExitCode), expected $2" >log
    tail -n 15 "$work"/*"-$job.log" >>log 2>&1
    is "$1" [ "$state" = "$2" ]
    clauses "${@:3}"
}
exits() { is "$1" [ "$(known "$job" ExitCode)" = "$2:0" ]; }    # name, code
restarts() { is "$1" [ "$(known "$job" Restarts)" = "$2" ]; } # name, how often
pending() { "$stance" status "$1" --json 2>/dev/null | sed -n 's/.*"pending": \([0-9]*\).*/\1/p'; }
logged() { # name, pattern [how often at least]
    cat "$work"/*"-$job.log" >log 2>&1
    (($(grep -c -- "$2" log) >= ${3:-1}))
    result $? "$1"
}
same() { expect "$1" 0 "$stance" compare "$2" "$3" says '^identical'; } # name, file, file: bit by bit

# Jobs compute with one lane, the runs that they are compared with as fast as they can.
export STANCE SCENARIO RESULTS STANCE_ISA
STANCE=$stance STANCE_ISA=scalar
scenario() { # points of each of two axes, s that a case lasts
    balance 0.001 0
    cat <<END_OF_FILE
title: Balance under Slurm
stop: {time: $2, settle: off}
record: {every: 0.1, cases: [0, 7]}
sweep:
  grid:
    - {path: initial.offset.theta, from: -0.05, to: 0.01, count: $1}
    - {path: initial.offset.vtheta, from: -0.2, to: 0.05, count: $1}
END_OF_FILE
}
undisturbed() { # file, scenario, options
    expect "... and ${*:2} with nothing to disturb it" 0 env -u STANCE_ISA \
        mpirun -n 2 "$stance" run "${@:2}" -o "$1" --quiet --force
}

# How fast one lane on two ranks is here: points per axis for so many seconds.
scenario 20 5 >probe.yaml
expect "a run to see how fast this machine is" 0 mpirun -n 2 "$stance" run probe.yaml -o probe.h5
cases_a_second=$("$python" -c 'import h5py
print(400 / h5py.File("probe.h5")["timing/wall_time"][...].max())')
points() { "$python" -c "print(int(($1 * $cases_a_second) ** 0.5) + 1)"; }
echo "# $cases_a_second cases per second on two ranks of one lane"

# ---- time limits that strike, and an array beside it ---------------------------------------------
# Slurm counts in minutes and looks every 30 s: with a warning 20 s before the end a turn lasts
# between 10 and 40 s. 90 s of work cannot do with two, unless the machine has become faster.
scenario "$(points 90)" 5 >sweep.yaml
SCENARIO=sweep.yaml RESULTS=results/requeued.h5
echo "# \$ sbatch --ntasks=2 --time=1 --signal=B:USR1@20 scenarios/cluster/requeue.sh"
submit --nodelist=n1 --ntasks=2 --time=1 --signal=B:USR1@20 "$scripts/requeue.sh"
echo "# Submitted batch job $job"
requeued=$job

scenario "$(points 3)" 5 >small.yaml
SCENARIO=small.yaml
submit --nodelist=n2 "$scripts/array.sh"
for k in 0 1 2; do
    await_end "${job}_$k"
    cat "$work"/*"-$job-$k.log" >log 2>&1
    is "task $k of an array is COMPLETED ($state)" [ "$state" = COMPLETED ]
done
frictions=(0.2 0.4 0.8)
for k in 0 1 2; do
    undisturbed alone.h5 small.yaml --set "ground.friction=${frictions[k]}"
    same "... equals task $k's file" alone.h5 "results/sweep-$k.h5"
done
submit --nodelist=n2 --array=1 "$scripts/array.sh"
await_end "${job}_1"
cat "$work"/*"-$job-1.log" >log
is "a task that is complete and submitted again computes nothing" grep -q 'computed now\|0 of them' log
expect "the array's files become one, of all cases" 0 "$stance" merge results/sweep.h5 results/sweep-[012].h5 holds '
s = h5py.File("results/sweep.h5")["status"][...]; assert s.shape[0] == 3 and (s == 1).all(), s'

# Shards that know of no MPI, and the job that waits for all of them.
export SHARDS=4
RESULTS=results/shards
undisturbed alone.h5 small.yaml
submit --nodelist=n2 --array=1-$SHARDS "$scripts/shards.sh"
shards=$job
submit --nodelist=n2 --array=1 --dependency="afterok:$shards" "$scripts/shards.sh" merge
await_end "${job}_1"
cat "$work"/*"-$shards-"*.log "$work"/*"-$job-1.log" >log 2>&1
says "shards are merged by a job that waits for them" '^results/shards.h5: [0-9]* cases from 4 files$'
same "... into the file of one run" alone.h5 results/shards.h5
rm results/shards.shard-3-of-4.h5
submit --nodelist=n2 --array=2,3 "$scripts/shards.sh"
for k in 2 3; do await_end "${job}_$k"; done
cat "$work"/*"-$job-2.log" >log
says "a shard that is done ends at once" '; 0 of them computed now;'
cat "$work"/*"-$job-3.log" >log
says "... one that was lost is computed again" 'results/shards.shard-3-of-4.h5: [0-9]* cases: [^;]*; [0-9.]* s on 1 rank'

job=$requeued
await_end "$job"
if (($(known "$job" Restarts) < 2)); then
    echo "# too quick: once more, with more cases"
    scenario "$(points 360)" 5 >sweep.yaml
    rm -f results/requeued.h5
    SCENARIO=sweep.yaml RESULTS=results/requeued.h5
    submit --nodelist=n1 --ntasks=2 --time=1 --signal=B:USR1@20 "$scripts/requeue.sh"
fi
ended "a job that was put back until it was done, twice at least" COMPLETED logged 'back into the queue' 2
note <stance-"$job".log
is "... as Slurm counts, too" '(($(known "$job" Restarts) >= 2))'
scontrol show job "$job" | grep -E 'JobState|Restarts|RunTime' | note
undisturbed whole.h5 sweep.yaml
same "... equals the file of the job" whole.h5 results/requeued.h5
sed 's/^/# /' log

# ---- cancelled, submitted again ------------------------------------------------------------------
scenario "$(points 16)" 5 >middle.yaml
undisturbed middle.h5 middle.yaml
SCENARIO=middle.yaml RESULTS=results/cancelled.h5
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
await - computing results/cancelled.h5
scancel "$job"
ended "a job cancelled in mid-run" CANCELLED restarts 0
left=$(pending results/cancelled.h5)
is "... leaves a file with cases to do" '((${left:-0} > 0))'
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
ended "submitted again" COMPLETED logged "turn 1 on n[12]: $left cases to do" same middle.h5 results/cancelled.h5

# ---- power of a node cut off ---------------------------------------------------------------------
RESULTS=results/node.h5
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
await - computing results/node.h5
node=$(known "$job" NodeList)
# shellcheck disable=SC2046
kill -9 "$(cat "$cluster/$node.pid")" $(job_processes)
ended "a job whose node dies, and which Slurm puts back" COMPLETED restarts 1 same middle.h5 results/node.h5
other=$(known "$job" NodeList)
is "... goes on on another node, $node, then $other" '[ -n "$other" ] && [ "$other" != "$node" ]'
start_node "$node"
is "the node comes back" await - both_idle

# ---- a rank killed -------------------------------------------------------------------------------
kill_rank() { # of the one job there is
    local pid
    for pid in $(job_processes); do
        if grep -qz '^OMPI_COMM_WORLD_RANK=1$' "/proc/$pid/environ" 2>/dev/null &&
            [ "$(readlink -f "/proc/$pid/exe")" = "$(readlink -f "$stance")" ]; then
            kill -9 "$pid"
            return
        fi
    done
    echo "there is no rank 1" >&2
}
RESULTS=results/rank.h5
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
await - computing results/rank.h5
kill_rank
ended "a job one of whose ranks is killed soon" FAILED logged 'crashed within 600 s: not put back'
rm results/rank.h5
submit --ntasks=2 --time=10 --export=ALL,SHORTEST_TURN=0 "$scripts/requeue.sh"
await - computing results/rank.h5
kill_rank
ended "a job one of whose ranks is killed later" COMPLETED restarts 1 same middle.h5 results/rank.h5

# ---- errors: nothing is put back -----------------------------------------------------------------
SCENARIO=nowhere.yaml RESULTS=results/never.h5
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
ended "a job without its scenario" FAILED exits 3 restarts 0
SCENARIO=small.yaml RESULTS=results/rank.h5
submit --ntasks=2 --time=10 "$scripts/requeue.sh"
ended "a job for another scenario's file that is whole" FAILED exits 2

# ---- one job with a limit of its own; two nodes; srun --------------------------------------------
SCENARIO=middle.yaml RESULTS=results/one.h5
submit --ntasks=2 --time=1 --export=ALL,RESERVE=56 "$scripts/one_job.sh"
ended "one job that stops before Slurm's limit" FAILED exits 4 \
    logged 'go on with: mpirun -n 2 .*stance run .*--resume'
left=$(pending results/one.h5)
submit --ntasks=2 --time=10 "$scripts/one_job.sh"
fewer_left() { (($(pending results/one.h5) < left)); }
await - fewer_left
scancel --batch --signal=USR1 "$job"
ended "submitted again, and told to stop by Slurm's signal" FAILED exits 4
submit --nodes=2 --ntasks=2 --time=10 "$scripts/one_job.sh"
ended "submitted again, for two nodes" COMPLETED logged 'on 2 ranks' same middle.h5 results/one.h5
expect "srun --mpi=pmix" 0 srun --nodes=1 --ntasks=2 --mpi=pmix "$stance" run small.yaml -o pmix.h5 says 'on 2 ranks$'
expect "srun without MPI" 2 srun --nodes=1 --ntasks=2 --mpi=none "$stance" run small.yaml -o none.h5 \
    says 'stance run: srun started several of these without an MPI that joins them'

echo "1..$count"
echo "$((count - failed)) passed, $failed failed"
exit $((failed > 0))
