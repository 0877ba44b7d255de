#!/usr/bin/env bash
# Ground in plates: balls, blocks, a wheel and walkers on it against independent programs (uneven_oracle.py); the same bits
# on any number of ranks, on every instruction set, by kernels that are compiled and by those that are built in.
# Speaks TAP.
# about: runner/run analysis/compare
set -u
# shellcheck source=tests/scratch.sh
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache

"$python" "$tests/uneven_oracle.py" "$stance" "$shipped" | sed 's/^1\.\.\([0-9]*\)$/# \1 of the oracle/'
oracle=${PIPESTATUS[0]}
((oracle == 0)) || result 1 "the oracle ends"

# ---- the same bits ---------------------------------------------------------------------------------------------------
cat >rough.yaml <<END
stance: 1
scene: ball
ground:
  restitution: 0.6
  friction: 0
  plates:
    down: {from: 0.2, height: -0.1}
    stairs: {kind: stairs, from: 0.5, width: 0.07, height: -0.02, count: 5}
    field: {kind: rough, from: 1, width: 0.1, height: 0.02}
    same: {kind: rough, from: 2, width: 0.03, height: 0.02, seed: 3}
initial: {state: {z: 0.4}}
method: {name: implicit, step: 0.002}
stop: {time: 1, settle: off}
sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint, capturing, lagrange]}
    - {path: initial.state.vx, from: -0.5, to: 3, count: 6}
  sample: {method: random, count: 5, vary: [{path: initial.state.z, from: 0.3, to: 0.6}]}
END
export CC=false
expect "balls on rough ground" 0 "$stance" run rough.yaml -o rough.h5 --quiet
expect "... on two ranks" 0 mpirun -n 2 "$stance" run rough.yaml -o ranks.h5 --quiet
expect "... the same bits" 0 "$stance" compare rough.h5 ranks.h5
isas=$("$stance" --version | sed -n "s/^instruction sets \(.*\); in use.*/\1/p" | tr -d ,)
for isa in $isas; do
    STANCE_ISA=$isa expect "balls, $isa" 0 "$stance" run rough.yaml -o "rough-$isa.h5" --quiet
    expect "... the same bits" 0 "$stance" compare rough.h5 "rough-$isa.h5"
done
unset CC
methods=(midpoint) more=()
long_tests && methods=(implicit midpoint capturing lagrange) more=(sse2)
for isa in $isas "${more[@]}"; do
    [ "$isa" = "${isas%% *}" ] || long_tests || continue
    few=(--set "sweep.grid[0].values=[$(IFS=,; echo "${methods[*]}")]")
    expect "kernels are compiled, $isa" 0 "$stance" build rough.yaml "${few[@]}" --isa "$isa"
    STANCE_ISA=$isa expect "... compute" 0 "$stance" run rough.yaml "${few[@]}" -o "compiled-$isa.h5" --quiet
    CC=false STANCE_CACHE=$scratch/none expect "... those that are built in" 0 "$stance" run rough.yaml "${few[@]}" -o "built-$isa.h5" --quiet
    expect "... the same bits" 0 "$stance" compare "compiled-$isa.h5" "built-$isa.h5"
done
echo "1..$count"
exit $((failed > 0 || oracle > 0))
