#!/usr/bin/env bash
# One MPI job under Slurm that goes on by itself until it is done: through as many time limits as it
# takes, and through preemption and the failure of nodes.
#
# Copy this page, edit what is marked, and submit it once, from the directory that holds bin/ and
# scenarios/, on a file system that all nodes share:
#
#     sbatch scenarios/cluster/requeue.sh
#
# Before the time is up Slurm warns this script; the ranks write what has ended and leave; then the
# script puts its own job back into the queue, under the same number, and --resume goes on (Slurm
# waits two minutes before it starts a job again). The finished file is the same to the bit as one of
# a run that was never stopped. To stop it all: scancel JOB. To stop now and go on when the queue lets it:
# scancel --batch --signal=USR1 JOB.
#
# The job goes back only while each turn adds to the file, and never after bad use or an error of
# input or output, so that no mistake keeps it in the queue for ever.
#
#SBATCH --job-name=stance
#SBATCH --ntasks=64                  # edit: ranks, on as many nodes as they need
#SBATCH --time=04:00:00              # edit: of one turn
#SBATCH --signal=B:USR1@180          # warn this script (B:) so many seconds before, a minute more
#SBATCH --requeue                    # after preemption or the failure of a node Slurm does it
#SBATCH --open-mode=append           # one log for all turns
#SBATCH --output=%x-%j.log

set -u
stance=${STANCE:-bin/stance}                            # edit
scenario=${SCENARIO:-scenarios/basin_one_foot.yaml}     # edit
results=${RESULTS:-results/basin_one_foot.h5}           # edit: on the shared file system
# A crash (of a rank, of mpirun when a node has gone) puts the job back only if it came after so
# many seconds: one that strikes soon would strike again.
shortest_turn=${SHORTEST_TURN:-600}

# mpirun kills its ranks a second after a SIGTERM (scancel, preemption): give them five to write.
# After a run that was stopped (code 4) it then sleeps for twice as long.
export OMPI_MCA_odls_base_sigkill_timeout=5
# A rank that is killed while it holds the mutex of PMIx' shared memory leaves mpirun waiting for ever.
export PMIX_MCA_gds=hash
# Notice within 90 s that a node has gone; without this it takes many minutes, or for ever.
export OMPI_MCA_oob_tcp_keepalive_time=60 OMPI_MCA_oob_tcp_keepalive_intvl=10 \
    OMPI_MCA_oob_tcp_keepalive_probes=3
# Nodes with several networks: name the one that joins them.
# export OMPI_MCA_oob_tcp_if_include=10.0.0.0/16 OMPI_MCA_btl_tcp_if_include=10.0.0.0/16

say() { echo "$(date '+%F %T') $*"; }
# One of the numbers of `stance status`; nothing where there is no file that it can read.
status() {
    "$stance" status "$results" --json 2>/dev/null |
        sed -n "s/.*\"$1\": *\([a-z0-9]*\).*/\1/p"
}

# Slurm's warning, or a cancellation. mpirun passes USR1 to every rank. Should it hang afterwards,
# because a node is cut off, it is killed: by then the ranks have written, and left after 30 s.
warned='' cancelled='' launcher='' killer=''
# shellcheck disable=SC2317 # called by the traps
stop() {
    if [ -n "$launcher" ] && [ -z "$killer" ]; then
        kill -USR1 "$launcher" 2>/dev/null
        { sleep 90 && kill -KILL "$launcher"; } 2>/dev/null &
        killer=$!
    fi
}
trap 'warned=yes; stop' USR1
trap 'cancelled=yes; stop' TERM

# A node that Slurm has lost may run its last turn to the end, and a file server takes a while to
# notice that a writer has died: wait for them. A run refuses a file that another one writes.
for ((i = 0; i < 60; i++)); do
    if [ "$(status running)" != true ] || [ -n "$warned$cancelled" ]; then break; fi
    ((i > 0)) || say "another run writes $results: waiting for its end"
    sleep 10
done

pending_before=$(status pending)
say "turn $((${SLURM_RESTART_COUNT:-0} + 1)) on $SLURM_JOB_NODELIST:" \
    "${pending_before:-all} cases to do"
begin=$SECONDS
mpirun "$stance" run "$scenario" -o "$results" --resume --quiet &
launcher=$!
[ -z "$warned$cancelled" ] || stop
while kill -0 $launcher 2>/dev/null; do
    wait $launcher # comes back at each signal, too
done
wait $launcher
code=$? launcher=''
[ -z "$killer" ] || kill "$killer" 2>/dev/null

# What to do now. mpirun has exit codes of its own, 1 among them: the file tells whether all is done.
pending=$(status pending)
pending_before=${pending_before:-$(status cases)}
say "exit code $code, ${pending:-unknown} cases left"
case $code in
2 | 3) exit "$code" ;; # bad use or scenario, input or output: somebody must look
esac
if [ "$pending" = 0 ]; then
    failed=$(status failed)
    ((failed == 0)) || say "$failed cases failed: bin/stance summary $results says why"
    exit $((failed > 0))
fi
if [ -n "$cancelled" ]; then
    say "cancelled"
    exit 4
fi
if [ -z "$pending" ] || ((pending >= pending_before)); then
    say "nothing came of this turn: not put back into the queue"
    exit $((code > 0 ? code : 3))
fi
if ((code != 4)) && [ -z "$warned" ] && ((SECONDS - begin < shortest_turn)); then
    say "crashed within $shortest_turn s: not put back into the queue; sbatch goes on"
    exit $((code > 0 ? code : 3))
fi
say "back into the queue"
scontrol requeue "$SLURM_JOB_ID"
exit 4
