#!/usr/bin/env bash
# stance optimise: a search is a function of its scenario, whatever the ranks, stops and kills; what
# its file tells follows from what it searched, and from simulations by stance run.
# about: runner/optimise analysis/summary
. "$(dirname "$0")/scratch.sh"
kills=1 candidates=6
long_tests && kills=30 candidates=18

sampled() { # starts' method, further lines of sweep
    cat <<END
stop: {time: 5}
sweep:
$2
  sample:
    method: $1
    count: 64
    vary:
      - {path: initial.offset.theta, from: -0.1, to: 0.1}
      - {path: initial.offset.q1, from: -0.2, to: 0.2}
      - {path: initial.offset.vtheta, from: -0.5, to: 0.5}
END
}
{
    balance 0.002 0.1
    sampled sobol ''
    echo 'optimise: {vary: gains, candidates: 77, grow: [48, 96], confirm: 512}'
    echo 'seed: 7'
} >box.yaml

search() { # name, code, arguments
    local name=$1 code=$2
    shift 2
    expect "$name" "$code" "$stance" optimise "$@"
}
clause_words+="searched "
searched() { # name, task of search.py, files
    "$python" "$tests/search.py" "${@:2}" >log 2>&1
    result $? "$1"
}
few() { # name, file, candidates, settings: of box.yaml, from few starts
    search "$1" 0 box.yaml -o "$2" --set optimise.candidates="$3" --set optimise.grow=[32] --set optimise.confirm=64 "${@:4}"
}
search "a search" 0 box.yaml -o one.h5 says '^one.h5: 77 candidates in 7 generations, .* of 512 fresh starts, the first'
expect "... and leaves an ordinary scenario" 0 "$stance" check one-best.yaml
for n in 2 3; do
    expect "the same on $n ranks" 0 mpirun -n $n "$stance" optimise box.yaml -o "ranks$n.h5" --quiet
    searched "... to the bit" same one.h5 "ranks$n.h5"
done
searched "counts, objectives, the best and the chosen follow from each other" consistent one.h5
searched "xarray reads the file" reads one.h5

# What was counted is what stance run counts.
seed=$((7 + 1))
expect "stance run computes the best from the fresh starts" 0 "$stance" run one-best.yaml -o best.h5 \
    --set seed=$seed --set sweep.sample.count=512
expect "... and the first" 0 "$stance" run box.yaml -o first.h5 --set seed=$seed --set sweep.sample.count=512
searched "... each start ends as the search found" confirmed one.h5 best.h5 first.h5

# Stops and kills.
search "a time limit stops it" 4 box.yaml -o stopped.h5 --time-limit 0.3s \
    says 'go on with:.* optimise box.yaml -o stopped.h5 --time-limit 0.3s --resume$'
search "... which does" 0 box.yaml -o stopped.h5 --resume searched same one.h5 stopped.h5
# Some moment after a generation more than what there was is in the file: it comes to its end.
generations() { "$stance" status killed.h5 --json 2>/dev/null | sed -n 's/.*"generations": *\([0-9]*\).*/\1/p'; }
further() { (($(generations) + 0 > before)); }
same=0
for ((k = 0; k < kills; k++)); do
    rm -f killed.h5*
    for ((try = 0; try < 40; try++)); do
        before=$(($(generations) + 0))
        mpirun -n $((1 + k % 2)) "$stance" optimise box.yaml -o killed.h5 --resume --quiet >/dev/null 2>&1 </dev/null &
        job=$!
        if await $job further; then
            sleep "$(seconds $((RANDOM % 500)))"
            # shellcheck disable=SC2046 # a list of numbers
            kill -9 $job $(pgrep -P $job) 2>/dev/null
        fi
        { wait $job; } 2>/dev/null && break
    done
    "$python" "$tests/search.py" same one.h5 killed.h5 >log 2>&1 && same=$((same + 1))
done
is "killed $kills times over, to the same end, to the bit" '((same == kills))'

# Circumstances, and loops that are unstable in one of them.
{
    balance 0.002 0.1
    sampled sobol '  grid:
    - {path: ground.friction, values: [0.8, 0.2]}
    - {paths: [controller.sample_time, controller.delay], values: [[0.002, 0], [0.1, 1]]}'
    echo 'optimise: {vary: gains, candidates: 22, grow: [32], confirm: 64, over: worst, weight: normal,'
    echo '  require: {critical_sample_time: 0.01}, price: {peak_torque: 0.02, gain: 0.01}}'
} >worst.yaml
search "the worst of several circumstances" 0 worst.yaml -o worst.h5 searched refused worst.h5
search "their mean" 0 worst.yaml -o mean.h5 --set optimise.over=mean searched mean worst.h5 mean.h5
sed 's/sobol/sphere/; s/  sample:/  grid:\n    - {path: initial.offset.scale, from: 0.1, to: 1, count: 10}\n&/; s/vary: gains/&, maximise: nearest/' \
    box.yaml >nearest.yaml
search "the nearest fall" 0 nearest.yaml -o nearest.h5 --set optimise.candidates=33 --set optimise.grow=[16,32] \
    --set optimise.confirm=64 searched nearest nearest.h5
few "posture, sample time and gains together" posture.h5 24 \
    --set 'optimise.vary=[gains, {path: initial.equilibrium.theta, from: -0.6, to: 0.6}, {path: controller.sample_time, from: 0.001, to: 0.01, spacing: log}]'
searched "... within their bounds" bounds posture.h5
few "poles instead of gains" poles.h5 24 --set optimise.vary=poles

# What counts, and what is said of it.
few "an answer instead of a share" steps.h5 11 --set optimise.maximise=steps --set method.step=0.0005 \
    says '^steps.h5: 11 candidates in 1 generation, .*; objective [0-9.]* of 64 fresh starts, the first [0-9.]*; '
is "... nor compared with one" ! grep -q 'twice the sample time' log
expect "its scenario runs" 0 "$stance" run steps-best.yaml -o steps-run.h5 --set seed=$seed --set sweep.sample.count=64
searched "... and has the same mean, of answers above 1000, too" answer steps.h5 steps-run.h5
sed 's/method: sobol/method: random/; s/  *- {path: initial.offset.vtheta.*/&\n      - {path: initial.offset.vq1, from: -1, to: 1}\n      - {path: initial.offset.vq2, from: -1, to: 1}\n      - {path: initial.offset.q2, from: -0.2, to: 0.2}\n      - {path: ground.friction, from: 0.7, to: 0.9}\n      - {path: robot.hip_mass, from: 5.3, to: 5.5}\n      - {path: robot.foot_mass, from: 1.7, to: 1.9}\n      - {path: robot.trunk_mass, from: 1.7, to: 1.9}\n      - {path: robot.leg_length, from: 0.5, to: 0.55}/' \
    box.yaml >many.yaml
search "starts of eleven numbers, the middle counting more" 0 many.yaml -o many.h5 --set optimise.weight=normal \
    --set optimise.candidates=11 --set optimise.grow=[8] --set optimise.confirm=32 searched weighted many.h5
few "a price beyond all worth" dear.h5 22 --set optimise.price.gain=1e9 searched dear dear.h5
few "equal ratios without bounds" ratios.h5 24 --set 'optimise.vary=[{path: initial.equilibrium.q2, unit: 0.1, spacing: log}]'
searched "... go both ways" ratios ratios.h5

# A robot on a flat foot, whose angle follows while the sole holds: gains of it are 0.
sed -n '/^    # own.yaml/,/^$/s/^    //p' "$tests/../README.md" >own.yaml
{
    sampled sobol '' | grep -v '^stop\|vary:\|initial'
    echo '    vary: [{path: initial.offset.body, from: -0.2, to: 0.2}, {path: initial.offset.vbody, from: -0.5, to: 0.5}]'
    echo "optimise: {vary: gains, candidates: $candidates, grow: [32], confirm: 64}"
} >>own.yaml
expect "the robot of the first hour" 0 "$stance" check own.yaml says '^optimise    2 numbers, '
search "... and a search for its gains" 0 own.yaml -o own.h5 --force \
    says 'linear theory allows any [0-9.]* % (contacts as if glued: the bound does not know where their centre of pressure may be); '
expect "... as does its summary" 0 "$stance" summary own.h5 says '^  (contacts as if glued: '
expect "... to programs" 0 "$stance" summary own.h5 --json says '"linear_limit_glued": true' searched flat own.h5

# What ships.
for scenario in "$shipped"/optimise/*.yaml; do
    name=$(basename "$scenario" .yaml)
    expect "$name is sound" 0 "$stance" check "$scenario"
    [ "$name" = optimise_rabbit ] && continue # whose kernel takes a minute to compile
    search "... and a search" 0 "$scenario" -o shipped.h5 --force --set optimise.candidates=20 \
        --set optimise.grow=[32] --set optimise.confirm=64
done

# Bad days.
search "a file that exists is left alone" 3 box.yaml -o one.h5 \
    says '^stance optimise: one.h5 exists; --force replaces it, --resume goes on with it$'
search "another scenario does not go on with it" 2 worst.yaml -o one.h5 --resume \
    says 'one.h5 is a search of another scenario'
search "nor does a file of stance run" 3 box.yaml -o best.h5 --resume says 'best.h5: not the file of a search'
head -c 3000 one.h5 >cut.h5
search "a file that is cut" 3 box.yaml -o cut.h5 --resume is '[ "$(wc -l <log)" = 1 ]'
"$python" "$tests/search.py" spoil one.h5 spoilt.h5
search "a file with another number in it" 3 box.yaml -o spoilt.h5 --resume says 'spoilt.h5: damaged'
search "a scenario without the section" 2 one-best.yaml -o none.h5 says '^one-best.yaml:[0-9]*:1: no section optimise'
search "fewer candidates than a generation" 2 box.yaml -o none.h5 --set optimise.candidates=5 \
    says 'optimise.candidates: 5 are less than one generation, 11'
search "... than the last beginning has" 2 box.yaml -o none.h5 --set optimise.restarts=3 \
    says 'optimise.candidates: 77 are less than one generation after the restarts, 88'
search "what is wrong once the gains are known" 2 box.yaml -o none.h5 --set 'optimise.vary=[gains, gains]'
says "... is told at its place" "^box.yaml:$(grep -n '^optimise' box.yaml | cut -d: -f1):[0-9]*: optimise.vary\[1\]: .* is varied twice"
cp box.yaml mine-best.yaml
search "the scenario is not written over by the best" 3 mine-best.yaml -o mine.h5 --force \
    says 'mine-best.yaml is the scenario and would be written over: give another -o'
search "... nor by the search" 3 mine-best.yaml -o mine-best.yaml --force is cmp -s box.yaml mine-best.yaml
search "nor is another scenario of that name" 3 box.yaml -o mine.h5 \
    says 'mine-best.yaml exists; --force replaces it, -o names other files'
search "poles that cannot be" 2 box.yaml -o none.h5 --set controller.poles='[-3,-3,-3,-4,-5,-6]'
is "... are told in one line" '[ "$(wc -l <log)" = 1 ] && [ ! -e none.h5 ]'
search "a folder that is not there" 3 box.yaml -o nowhere/none.h5 is '[ "$(wc -l <log)" = 1 ]'
