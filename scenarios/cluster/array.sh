#!/usr/bin/env bash
# A job array under Slurm: one task, and one results file, for each value of a parameter.
#
# A sweep within one file (`sweep.grid` in the scenario) balances its load over all ranks and needs
# no array. An array is for what should be scheduled, stopped or repeated piece by piece: values
# that are added later, scenarios of a directory, machines that give many small jobs more than one
# large one. Copy this page, edit what is marked, and submit it from the directory that holds bin/
# and scenarios/:
#
#     sbatch scenarios/cluster/array.sh
#
# A task that ran out of time is gone on with by submitting its number again,
#
#     sbatch --array=2 scenarios/cluster/array.sh
#
# or all of them: those that are complete end at once. Afterwards the files become one,
#
#     bin/stance merge results/sweep.h5 results/sweep-*.h5
#
#SBATCH --job-name=sweep
#SBATCH --array=0-2                  # edit: one number for each value below
#SBATCH --ntasks=1                   # edit: ranks of each task
#SBATCH --time=02:00:00              # edit
#SBATCH --output=%x-%A-%a.log
# Slurm's warning, two minutes or somewhat more before the end, to the process of this script alone,
# which becomes stance (or mpirun, which passes it to every rank): it writes what has ended and
# leaves with exit code 4.
#SBATCH --signal=B:USR1@120

set -eu
stance=${STANCE:-bin/stance}                            # edit
scenario=${SCENARIO:-scenarios/basin_one_foot.yaml}     # edit
path=ground.friction                                    # edit: any path of `stance describe`
values=(0.2 0.4 0.8)                                    # edit

k=${SLURM_ARRAY_TASK_ID:?is set in a job array: sbatch --array=0-$((${#values[@]} - 1)) $0}
((k < ${#values[@]})) || { echo "$0: there is no value number $k" >&2; exit 2; }
mkdir -p results
run=("$stance" run "$scenario" --set "$path=${values[k]}" -o "results/sweep-$k.h5" --resume)

# Scenarios instead of values: one file each.
#   scenarios=(scenarios/*.yaml); name=$(basename "${scenarios[k]}" .yaml)
#   run=("$stance" run "${scenarios[k]}" -o "results/$name.h5" --resume)

# Several ranks for each task; one_job.sh says what the setting is for.
if ((${SLURM_NTASKS:-1} > 1)); then
    export OMPI_MCA_odls_base_sigkill_timeout=5 PMIX_MCA_gds=hash
    run=(mpirun "${run[@]}")
fi
exec "${run[@]}"
