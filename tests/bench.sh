#!/usr/bin/env bash
# All speed benchmarks into one table, results/bench.csv, and its picture, results/bench.png: kernels,
# the step by hand, MuJoCo, and the whole program on the shipped map - how it scales from one rank to
# two, and how long it takes in three sizes, in full and refined. What cannot run here is skipped with
# a line that says so. Everything that is to be compared runs in turn, round after round.
# BENCH_ROUNDS (default 5): of the kernels and of the scaling; BENCH_SIZES (default "256 512 1024").
set -u
cd "$(dirname "$0")/.."
stance=${STANCE:-bin/stance} build=${BUILD:-build}
rounds=${BENCH_ROUNDS:-5} sizes=${BENCH_SIZES-256 512 1024} map=scenarios/basin_one_foot.yaml
csv=results/bench.csv method=$(sed -n 's/^method: {name: \([a-z-]*\).*/\1/p' $map)
mkdir -p results
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT
table=$scratch/table.csv
skip() { echo "bench: skipped: $*" >&2; }

echo "Kernels, $rounds rounds" >&2
"$stance" bench --csv --repeats "$rounds" >"$table" || exit 1
# The columns that say which program, compiler, processor, machine and day.
origin=$(sed -n 2p "$table" | cut -d, -f16-)

for rival in scalar tables mujoco; do
    if [ -x "$build/tests/bench_$rival" ]; then
        echo "Beside ${rival/scalar/the step by hand}" >&2
        "$build/tests/bench_$rival" >>"$table" || exit 1
    else
        skip "$rival: not built (libmujoco-dev is missing)"
    fi
done

# ---- the whole program ----------------------------------------------------------------------------

# Wall and processor seconds of a run of the map: ranks, cases per side, options.
time_map() {
    local ranks=$1 side=$2 TIMEFORMAT='%R %U'
    shift 2
    { time mpirun -n "$ranks" "$stance" run --quiet --force -o "$scratch/map.h5" "$map" \
        --set "sweep.grid[0].count=$side" --set "sweep.grid[1].count=$side" "$@" >"$scratch/out" 2>&1; } 2>"$scratch/time" ||
        { tail -n 3 "$scratch/out" >&2; return 1; }
    cat "$scratch/time"
}
# A row of the table: regime, ranks, cases, quantity, unit; values on standard input, one a line.
row() {
    sort -g | awk -v OFS=, -v method="$method" -v regime="$1" -v ranks="$2" -v cases="$3" -v quantity="$4" -v unit="$5" -v origin="$origin" '
        { v[NR] = $1 }
        END { if (NR) print "stance run", "biped", regime, method, "", "", ranks, "0.001", cases, NR, quantity, unit,
                  (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2, v[1], v[NR], origin }' >>"$table"
}

if ! command -v mpirun >/dev/null; then
    skip "the whole program: no mpirun"
elif [ -n "$sizes" ]; then
    ranks=2
    if (($(nproc) < 2)); then
        ranks=1
        skip "scaling: this machine has one core"
    else
        side=${sizes%% *}
        echo "The program on $side x $side cases, 1 rank and 2, $rounds rounds" >&2
        for ((r = 0; r < rounds; r++)); do
            one=$(time_map 1 "$side") && two=$(time_map 2 "$side") || exit 1
            echo "$one $two"
        done >"$scratch/scaling"
        cut -d' ' -f1 "$scratch/scaling" | row "basin full" 1 $((side * side)) "wall time" s
        cut -d' ' -f2 "$scratch/scaling" | row "basin full" 1 $((side * side)) "processor time" s
        awk '{ print 1 }' "$scratch/scaling" | row "basin full" 1 $((side * side)) "parallel efficiency" 1
        awk '{ print $1 / (2 * $3) }' "$scratch/scaling" | row "basin full" 2 $((side * side)) "parallel efficiency" 1
    fi
    refine=(--set sweep.refine.start=32 --set sweep.refine.margin=1)
    if ! "$stance" check "$map" "${refine[@]}" >/dev/null 2>&1; then
        refine=()
        skip "refined maps: this program has no sweep.refine"
    fi
    for side in $sizes; do
        again=$((side > 256 ? (rounds + 1) / 2 : rounds))
        echo "The program on $side x $side cases, $ranks ranks, $again rounds" >&2
        : >"$scratch/full"
        : >"$scratch/refined"
        for ((r = 0; r < again; r++)); do
            time_map $ranks "$side" >>"$scratch/full" || exit 1
            ((${#refine[@]} == 0)) || time_map $ranks "$side" "${refine[@]}" >>"$scratch/refined" || exit 1
        done
        for kind in full refined; do
            cut -d' ' -f1 "$scratch/$kind" | row "basin $kind" $ranks $((side * side)) "wall time" s
            cut -d' ' -f2 "$scratch/$kind" | row "basin $kind" $ranks $((side * side)) "processor time" s
        done
    done
fi

cp "$table" $csv || exit 3
echo "$csv"
awk -F, '$11 == "ratio to stance" && $4 == "implicit" { printf "%s, %s, %s: %.1f times the time of implicit, %s\n", $1, $2, $3, $13, $5 }
    $11 == "ratio to scalar by hand" { printf "one-lane kernel: %.2f times the time of the step by hand\n", $13 }
    $11 == "penetration" || $11 == "creep" { printf "%s, %s: %s %.1e %s\n", $1, $3, $11, $13, $12 }
    $11 == "parallel efficiency" && $7 == 2 { printf "parallel efficiency of 2 ranks: %.2f (%.2f ... %.2f)\n", $13, $14, $15 }
    $11 == "wall time" { printf "%s, %d cases, %d ranks: %.2f s\n", $3, $9, $7, $13 }' $csv
"$stance" bench plot $csv -o results
