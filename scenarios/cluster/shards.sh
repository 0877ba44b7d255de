#!/usr/bin/env bash
# A job array under Slurm in which each task computes a share of one scenario, without MPI: nothing
# but this program and a directory that all nodes share is needed, in a container, too.
#
# Where MPI works, one_job.sh balances its load by itself and writes one file. Copy this page, edit
# what is marked, and submit it from the directory that holds bin/ and scenarios/, then the job that
# makes one file of the shards when all of them are done:
#
#     job=$(sbatch --parsable scenarios/cluster/shards.sh)
#     sbatch --dependency=afterok:$job --array=1 scenarios/cluster/shards.sh merge
#
# The file is that of one run, to the bit. A task that was killed or ran out of time is gone on with
# by submitting its number again,
#
#     sbatch --array=7,12 scenarios/cluster/shards.sh
#
# or all of them: those that are done end at once. Other schedulers number their tasks by another
# variable: PBS_ARRAY_INDEX, SGE_TASK_ID, LSB_JOBINDEX.
#
#SBATCH --job-name=shards
#SBATCH --array=1-64                 # edit: as many as `shards` below says
#SBATCH --ntasks=1
#SBATCH --time=02:00:00              # edit
#SBATCH --requeue                    # after preemption or the failure of a node Slurm does it
#SBATCH --output=%x-%A-%a.log
# Slurm's warning, a minute or somewhat more before the end, to the process of this script alone,
# which becomes stance: it writes what has ended and leaves with exit code 4.
#SBATCH --signal=B:USR1@60

set -eu
stance=${STANCE:-bin/stance}         # edit; in a container: (apptainer exec stance.sif stance)
scenario=${SCENARIO:-scenarios/basin_one_foot.yaml}     # edit
results=${RESULTS:-results/basin_one_foot}              # edit: on the shared file system
shards=${SHARDS:-64}                                    # edit

mkdir -p "$(dirname "$results")"
if [ "${1:-}" = merge ]; then
    exec "${stance[@]}" merge "$results.h5" "$results".shard-*-of-"$shards".h5 --force
fi
k=${SLURM_ARRAY_TASK_ID:?is set in a job array: sbatch --array=1-$shards $0}
exec "${stance[@]}" run "$scenario" --shard "$k/$shards" -o "$results.shard-$k-of-$shards.h5" --resume
