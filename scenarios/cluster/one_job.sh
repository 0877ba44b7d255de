#!/usr/bin/env bash
# One MPI job under Slurm that stops in time and can be gone on with.
#
# Copy this page, edit what is marked, and submit it from the directory that holds bin/ and
# scenarios/, on a file system that all nodes share:
#
#     sbatch scenarios/cluster/one_job.sh
#
# When its time is nearly up the run writes what has ended and leaves with exit code 4. Submit the
# same script again: it goes on where it stopped, and the finished file is the same to the bit.
# requeue.sh does that by itself.
#
#SBATCH --job-name=stance
#SBATCH --ntasks=64                  # edit: ranks, on as many nodes as they need
#SBATCH --time=12:00:00              # edit
#SBATCH --output=%x-%j.log
# Slurm's warning before the end, to the process of this script alone, which becomes mpirun; mpirun
# passes it to every rank. It may come up to a minute early. It is needed only where somebody
# shortens the job's time while it runs; otherwise --time-limit below is first.
#SBATCH --signal=B:USR1@60

set -eu
stance=${STANCE:-bin/stance}                            # edit
scenario=${SCENARIO:-scenarios/basin_one_foot.yaml}     # edit
results=${RESULTS:-results/basin_one_foot.h5}           # edit: on the shared file system

# The time that Slurm gives this job, less 150 s for the end: 30 s is the longest that a rank waits
# for others that do not come, and the last writes of many ranks may meet a slow file system.
seconds_left() {
    squeue --noheader --jobs="$SLURM_JOB_ID" --format=%L | awk -F'[-:]' '
        !/^[0-9]/ {exit}                            # UNLIMITED, say
        {for (i = NF; i > 0; i--) {s += $i * (NF - i == 3 ? 86400 : 60 ^ (NF - i))}; print s}'
}
left=$(seconds_left)
reserve=${RESERVE:-150}
limit=()
if [ -n "$left" ]; then
    ((left > reserve)) || { echo "--time must be longer than $reserve s" >&2; exit 2; }
    limit=(--time-limit "$((left - reserve))s")
fi

# mpirun kills its ranks a second after a SIGTERM (scancel): give them five to write. After a run
# that was stopped (code 4) it then sleeps for twice as long.
export OMPI_MCA_odls_base_sigkill_timeout=5
# A rank that is killed while it holds the mutex of PMIx' shared memory leaves mpirun waiting for ever.
export PMIX_MCA_gds=hash
# Notice within 90 s that a node has gone; without this it takes many minutes, or for ever.
export OMPI_MCA_oob_tcp_keepalive_time=60 OMPI_MCA_oob_tcp_keepalive_intvl=10 \
    OMPI_MCA_oob_tcp_keepalive_probes=3
# Nodes with several networks: name the one that joins them.
# export OMPI_MCA_oob_tcp_if_include=10.0.0.0/16 OMPI_MCA_btl_tcp_if_include=10.0.0.0/16

# --resume begins a new file where there is none. Exit codes: 0 done, 1 some cases failed, 2 bad use
# or scenario, 3 input or output, 4 stopped: submit again. Others are mpirun's own, after a crash:
# what had ended is in the file then, too.
# Instead of mpirun: `exec srun --mpi=pmix "$stance" ...` with --signal=USR1@60 (without B:, which
# signals every rank), where Slurm and MPI were built with the same PMIx. Debian's are.
exec mpirun "$stance" run "$scenario" -o "$results" --resume "${limit[@]}"
