#!/usr/bin/env bash
# Ground in plates: balls, blocks, a wheel and walkers on it against independent programs (uneven_oracle.py); the same bits
# on any number of ranks, on every instruction set, by kernels that are compiled and by those that are built in.
# about: runner/run analysis/compare analysis/critical
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache

"$python" "$tests/uneven_oracle.py" "$stance" "$shipped" | sed 's/^1\.\.\([0-9]*\)$/# \1 of the oracle/'
oracle=${PIPESTATUS[0]}
((oracle == 0)) || result 1 "the oracle ends"

# ---- the same bits ---------------------------------------------------------------------------------------------------
cat >rough.yaml <<END
stance: 1
scene: rod
ground:
  friction: 0.3
  plates:
    down: {from: 0.2, height: -0.1}
    stairs: {kind: stairs, from: 0.5, width: 0.07, height: -0.02, count: 5, friction_factor: 2}
    field: {kind: rough, from: 1, width: 0.1, height: 0.02}
    same: {kind: rough, from: 2, width: 0.03, height: 0.02, seed: 3}
    before: {footfall: 3, from: 0.05, height: -0.3}
initial: {state: {z: 0.9, theta: 0.2}}
method: {name: implicit, step: 0.002}
stop: {time: 1.2, settle: off}
sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint, capturing, lagrange]}
    - {path: initial.state.vx, from: -0.5, to: 3, count: 6}
  sample: {method: random, count: 5, vary: [{path: initial.state.vtheta, from: -5, to: 5}]}
END
export CC=false # the kernels that are built in
expect "rods on rough ground" 0 "$stance" run rough.yaml -o rough.h5 --quiet
expect "... on two ranks" 0 mpirun -n 2 "$stance" run rough.yaml -o ranks.h5 --quiet as rough.h5
for case in 3 44 71 90; do
    "$stance" run rough.yaml --only $case -o alone.h5 --quiet --force >log 2>&1
    holds "... and of case $case alone" - $case <<'END'
import numpy as np
case, all, alone = int(sys.argv[1]), h5py.File("rough.h5"), h5py.File("alone.h5")
for key in alone:
    if isinstance(all.get(key), h5py.Dataset) and all[key].size % 120 == 0:
        here, there = alone[key][...].ravel(), all[key][...].reshape(120, -1)[case]
        assert np.array_equal(here, there) or key == "checksum" or np.isnan(here).all(), (key, here, there)
END
done
unset CC
isas='' methods=midpoint
[ -z "${STANCE_TEST_SCRIPTS:-}" ] || isas=scalar
long_tests && isas=$("$stance" --version | sed -n "s/^instruction sets \(.*\); in use.*/\1/p" | tr -d ,) methods="implicit midpoint capturing lagrange"
for isa in $isas; do
    for method in $methods; do
        one=(--set "sweep.grid[0].values=[$method]")
        expect "the kernel for it, $method, $isa" 0 "$stance" build rough.yaml "${one[@]}" --isa "$isa"
        file=$method-$isa.h5
        STANCE_ISA=$isa expect "... computes itself" 0 "$stance" run rough.yaml "${one[@]}" -o "$file" --quiet \
            holds 'assert h5py.File(sys.argv[1]).attrs["instruction_set"] == sys.argv[2].encode()' "$file" "$isa"
        CC=false STANCE_CACHE=$scratch/none expect "... that which is built in, too" 0 "$stance" run rough.yaml \
            "${one[@]}" -o built-in.h5 --quiet --force as "$file"
    done
done
exit $((failed > 0 || oracle > 0))
