#!/usr/bin/env bash
# Shards from outside: tasks that know nothing of each other, each on its share of one scenario,
# killed, repeated and added, and one file made of theirs.
# about: runner/run analysis/compare analysis/summary
. "$(dirname "$0")/scratch.sh"
points=60 # of the sample
[ -n "${STANCE_SLOW:-}" ] && points=20
unset "${!SLURM_@}"

# Noise, methods, a grid beside a sample, designs of their own, trajectories.
{
    balance 0.01 0.3
    cat <<END
title: Shards
stop: {time: 1}
sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint]}
    - {path: initial.offset.vtheta, from: -0.2, to: 0.2, count: 3}
  sample:
    method: sobol
    count: $points
    vary:
      - {path: ground.friction, from: 0.1, to: 1, spacing: log}
      - {path: controller.design, values: [place, lqr]}
record: {every: 0.1, cases: [0, 5, 101, 102, 103, 110]}
seed: 11
END
} >set.yaml
cases=$((6 * points))

expect "one run" 0 "$stance" run set.yaml -o one.h5 --quiet
for k in 1 2 3; do
    expect "shard $k of 3, without MPI" 0 "$stance" run set.yaml --shard $k/3 \
        says "results/set.shard-$k-of-3.h5: $((cases / 3)) cases:"
done
expect "shards are merged" 0 "$stance" merge all.h5 results/set.shard-?-of-3.h5 \
    says "^all.h5: $cases cases from 3 files$" as one.h5 tool whole all.h5 $cases
holds "a shard's file is that of the whole, with its own cases alone" <<'END'
one, shard = h5py.File("all.h5"), h5py.File("results/set.shard-2-of-3.h5")
assert shard.attrs["shard"] == b"2/3" and "shard" not in one.attrs
assert one["timing/cases"][...].sum() == one["status"].size
done = shard["status"][...] == 1
assert done.sum() == done.size / 3 and (one["checksum"][...][done] == shard["checksum"][...][done]).all()
END
for ranks in 1 2; do
    expect "a shard on $ranks rank(s)" 0 mpirun -n $ranks "$stance" run set.yaml --shard 2/3 -o ranks.h5 --force \
        as results/set.shard-2-of-3.h5
done

cp results/set.shard-2-of-3.h5 damaged.h5
"$python" -c 'import h5py; h5py.File("damaged.h5", "r+").attrs["shard"] = b"2 of 3"'
for way in "status damaged.h5" "merge all2.h5 damaged.h5 results/set.shard-1-of-3.h5"; do
    expect "${way%% *} of one whose share is damaged" 3 "$stance" $way \
        says "damaged.h5: .* attribute .shard.*is damaged"
done

# ---- what others say of it -----------------------------------------------------------------------
expect "status of a shard" 0 "$stance" status results/set.shard-2-of-3.h5 \
    says "shard 2/3, $((cases / 3)) of $((cases / 3)) cases done, 0 failed, 0 pending; complete"
expect "... for programs" 0 "$stance" status results/set.shard-2-of-3.h5 --json says '"shard": "2/3"'
expect "... of another file" 0 "$stance" status one.h5 --json says '"shard": null'
expect "summary of a shard" 0 "$stance" summary results/set.shard-2-of-3.h5 \
    says "$cases cases, of which shard 2/3 has $((cases / 3))," \
        "pending  *$((2 * cases / 3))  not computed yet, or of other shards"
expect "picture of a shard" 0 "$stance" plot results/set.shard-2-of-3.h5 -o shard.svg
expect "a dry run" 0 "$stance" run set.yaml --shard 2/3 --dry-run says "^shard  *2/3, $((cases / 3)) cases"

# ---- repeated, added, missing --------------------------------------------------------------------
expect "a shard that is there" 3 "$stance" run set.yaml --shard 1/3 \
    says 'set.shard-1-of-3.h5 exists; --force replaces it, --resume goes on with it'
expect "... and, resumed, done" 0 "$stance" run set.yaml --shard 1/3 --resume says '; 0 of them computed now;'
expect "... or computed again" 0 "$stance" run set.yaml --shard 1/3 --quiet -o again.h5
expect "shards twice" 0 "$stance" merge twice.h5 results/set.shard-?-of-3.h5 again.h5 \
    says "; $((cases / 3)) were in several files, and equal$" as one.h5
expect "a shard is missing" 0 "$stance" merge open.h5 results/set.shard-[13]-of-3.h5 \
    says "; $((cases / 3)) are not computed yet$" 'stance merge: not among the files: shard 2/3$'
expect "... and resumed without shards" 0 "$stance" run set.yaml -o open.h5 --resume --quiet as one.h5
for k in 3 4 5; do
    "$stance" run set.yaml --shard $k/5 --quiet >>log 2>&1
done
expect "shards of another number are added" 0 "$stance" merge added.h5 results/set.shard-[13]-of-3.h5 \
    results/set.shard-?-of-5.h5
lacks=$(sed -n 's/.*; \([0-9]*\) are not computed yet$/\1/p' log)
is "... fewer cases are missing" '((lacks > 0 && lacks < cases / 3))'
for k in 1 2; do
    "$stance" run set.yaml --shard $k/5 --quiet >>log 2>&1
done
expect "... and the others" 0 "$stance" merge added.h5 results/*-of-5.h5 results/*-1-of-3.h5 --force as one.h5
expect "a shard of another seed" 0 "$stance" run set.yaml --shard 1/3 --quiet --set seed=12 -o seed.h5
expect "... does not belong to these" 2 "$stance" merge bad.h5 seed.h5 results/set.shard-[23]-of-3.h5

# ---- killed --------------------------------------------------------------------------------------
# Some cases are done, not all: where the machine is too fast to be caught at that, they last longer.
long=results/long.shard-1-of-2.h5 killed=1
for span in 2 20 200 2000; do
    rm -f "$long"
    {
        balance 0.001 0.1
        echo "sweep: {grid: [{path: initial.offset.theta, from: -0.02, to: 0.01, count: 400}]}
stop: {time: $span, settle: off}"
    } >long.yaml
    "$stance" run long.yaml --shard 1/2 --quiet >log 2>&1 </dev/null &
    job=$!
    while kill -0 $job 2>/dev/null; do
        "$stance" status $long 2>/dev/null | grep -q ' [1-9][0-9]* of 200 cases done' && break
        sleep 0.02
    done
    kill -9 $job 2>/dev/null
    { wait $job; } 2>/dev/null
    "$stance" status $long 2>/dev/null | grep -q ' [1-9][0-9]* pending; not running' && killed=0 && break
done
result $killed "a shard is killed while it computes"
expect "... status" 0 "$stance" status $long says 'shard 1/2, .* of 200 cases done, 0 failed, .* pending; not running'
expect "the same command with --resume ends it" 0 "$stance" run long.yaml --shard 1/2 --resume \
    says ': 200 cases: .*; [0-9]* of them computed now;'
expect "a shard that runs out of time" 4 "$stance" run long.yaml --shard 2/2 --time-limit 0s \
    says 'go on with: .* run long.yaml --shard 2/2 --time-limit 0s --resume$'
expect "the other shard" 0 "$stance" run long.yaml --shard 2/2 --resume --quiet
expect "both" 0 "$stance" merge long.h5 results/long.shard-?-of-2.h5
expect "one run of all" 0 "$stance" run long.yaml -o long_one.h5 --quiet as long.h5

# ---- space for a share ---------------------------------------------------------------------------
cat >ball.yaml <<END
stance: 1
scene: ball
initial: {state: {z: 0.2}}
method: {name: implicit, step: 0.01}
stop: {time: 0.05}
sweep: {grid: [{path: ground.friction, from: 0.05, to: 1, count: 400000}]}
END
expect "a shard of many cases" 0 "$stance" run ball.yaml --shard 3/20 --quiet -o part.h5
is "... takes less than half the space of the whole" '((2 * 512 * $(stat -c %b part.h5) < $(stat -c %s part.h5)))'

# ---- Slurm's array -------------------------------------------------------------------------------
array() { # name, code, id, first, last, count, clause ...
    expect "$1" "$2" env SLURM_ARRAY_TASK_ID="$3" SLURM_ARRAY_TASK_MIN="$4" SLURM_ARRAY_TASK_MAX="$5" \
        SLURM_ARRAY_TASK_COUNT="$6" "$stance" run set.yaml --shard slurm --time-limit 0s "${@:7}"
}
part='--shard slurm: this array is not the whole of 1-N: give --shard \$SLURM_ARRAY_TASK_ID/N '
array "a task of an array" 4 4 1 7 7 says 'go on with: .* --shard 4/7 --time-limit 0s --resume$'
array "a part of an array" 2 4 4 5 2 lines 1 says "$part"
array "an array with gaps" 2 5 1 5 2 lines 1 says "$part"
array "an array from 0" 2 0 0 7 8 lines 1 says "$part"
expect "no array" 2 "$stance" run set.yaml --shard slurm lines 1 says '--shard slurm is for the tasks of an array: sbatch --array=1-N '
PMIX_RANK=0 SLURM_STEP_NUM_TASKS=1 expect "the one task of a step needs no MPI" 0 \
    "$stance" run set.yaml --shard 3/7 --quiet
for k in 1 2 3; do
    SLURM_ARRAY_TASK_ID=$k STANCE=$stance SCENARIO=set.yaml SHARDS=3 RESULTS=results/batch \
        expect "task $k of the batch script" 0 bash "$shipped/cluster/shards.sh"
done
STANCE=$stance SHARDS=3 RESULTS=results/batch expect "the job that merges" 0 bash "$shipped/cluster/shards.sh" merge
expect "... gives the file of one run" 0 "$stance" compare one.h5 results/batch.h5

# ---- wrong use -----------------------------------------------------------------------------------
for word in 0/4 5/4 a/b 1/1e9 1/1000001 2 2/ /2 -1/2 1/2/3 ''; do
    expect "no shard: '$word'" 2 "$stance" run set.yaml --shard "$word" lines 1 says "--shard takes K/N"
done
wrong() { # name, words, option ...
    expect "$1" 2 "$stance" run "${@:3}" lines 1 says "$2"
}
wrong "more shards than cases" "--shard: there are 1000 shards but only $cases cases" set.yaml --shard 1/1000
wrong "one case of a shard" '--shard and --only exclude each other' set.yaml --shard 1/3 --only 3
wrong "a larger sample" '--shard and --extend exclude each other' set.yaml --shard 1/3 --extend 100
wrong "another scenario" '--shard and --force-scenario exclude' set.yaml --shard 1/3 --resume --force-scenario
wrong "a refined map" 'sweep.refine: .* neighbours, which other shards have: run it under mpirun' \
    "$shipped/topple.yaml" --shard 1/3
wrong "another shard's file" 'is of shard 1/3: go on with it by --shard 1/3, or merge' set.yaml --shard 2/3 \
    --resume -o results/set.shard-1-of-3.h5
wrong "... with all cases" 'is of shard 1/3: go on with it by --shard 1/3, or merge' set.yaml --resume \
    -o results/set.shard-1-of-3.h5
wrong "a file of all cases" 'is not of a shard: go on with it without --shard' set.yaml --shard 2/3 --resume -o one.h5
