#!/usr/bin/env bash
# A share of fuzzing: scenarios (fuzz_scenario.c) and damaged results files (fuzz_results.c), each in
# a process of its own, for FUZZ_SECONDS or FUZZ_RUNS; the damage begins at number FUZZ_FROM. What is
# found stays in $BUILD/fuzz/found.
# Speaks TAP; lines that begin with ## tell how much was tried.
# long
set -u
cd "$(dirname "$0")/.."
root=$PWD stance=${STANCE:-$PWD/bin/stance} programs=$(realpath "${BUILD:-build}")/fuzz
seconds=${FUZZ_SECONDS:-30} runs=${FUZZ_RUNS:-}
if [ ! -x "$programs/fuzz_scenario" ]; then
    echo "ok 1 - skipped: clang's sanitizers are not installed, or not meant to be used"
    echo "## skipped: no clang with its sanitizers"
    exit 0
fi
mkdir -p "$programs/found" "$programs/corpus"
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset ASAN_OPTIONS UBSAN_OPTIONS
export OPENBLAS_NUM_THREADS=1 # threads that never work cost each change of the memory's map an interrupt
count=0
read -r patience _ <"$root/tests/patience"
result() { # status, name, log
    count=$((count + 1))
    if (($1 == 0)); then
        echo "ok $count - $2"
    else
        echo "not ok $count - $2"
        [ -n "${3:-}" ] && tail -n 60 "$3" | cut -c 1-300 | sed 's/^/# /'
    fi
}

# ---- files to be damaged: one of each kind, as small as they come -------------------------------
cat >map.yaml <<'END'
stance: 1
title: A map to be damaged
scene: biped
ground: {friction: 0.8, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, design: place, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6],
             sample_time: 0.01, torque_limit: 10}
method: {name: implicit, step: 0.01}
stop: {time: 1}
END
theta='{path: initial.offset.theta, from: -0.1, to: 0.05, count: 4}'
rate='{path: initial.offset.vtheta, from: -0.5, to: 0.5, count: 5}'
make_file() { # name, option ...
    "$stance" run map.yaml -o "$1.h5" --quiet "${@:2}" >log 2>&1
    result $? "a file to be damaged: $1" log
}
make_file one
make_file grid --set "sweep.grid=[$theta, $rate]"
make_file words --set "sweep.grid=[{path: method.name, values: [implicit, midpoint]}, $theta]"
make_file logarithmic --set 'sweep.grid=[{path: ground.friction, from: 0.1, to: 1, count: 5, spacing: log},
    {path: controller.design, values: [place, lqr]}]'
make_file trajectories --set "sweep.grid=[$theta]" --set 'record={every: 0.1, cases: [0, 2]}'
make_file single-case --set "sweep.grid=[$theta]" --only 0 --trace
make_file refined --set "sweep.grid=[{path: initial.offset.theta, from: -0.1, to: 0.05, count: 9},
    {path: initial.offset.vtheta, from: -0.5, to: 0.5, count: 9}]" --set 'sweep.refine={start: 3, margin: 1}'
make_file sampled --set 'sweep.sample={method: sobol, count: 4, vary: [
    {path: ground.friction, from: 0.3, to: 1}, {path: controller.delay, values: [0, 1]}]}'
make_file designs --set "sweep.grid=[$theta]" --set 'sweep.sample={method: morris, count: 2, levels: 4, vary: [
    {path: robot.trunk_mass, from: 1.5, to: 2.1}, {path: controller.torque_limit, from: 5, to: 15}]}'

# ---- both campaigns, beside each other ----------------------------------------------------------
scenario_limit=(-max_total_time="$seconds") results_limit=(-seconds "$seconds" -from "${FUZZ_FROM:-0}")
[ -n "$runs" ] && scenario_limit=(-runs="$runs") results_limit=(-seconds 1e9 -runs "$runs" -from "${FUZZ_FROM:-0}")
# The seeds are joined by what earlier campaigns on this machine reached.
fuzz_scenarios() {
    ASAN_OPTIONS=quarantine_size_mb=1:thread_local_quarantine_size_kb=64:allocator_release_to_os_interval_ms=-1 \
        UBSAN_OPTIONS=print_stacktrace=1 nice -n 5 "$programs/fuzz_scenario" -timeout="$patience" -rss_limit_mb=2048 \
        -malloc_limit_mb=512 -max_len=4096 -print_final_stats=1 -artifact_prefix="$programs/found/" \
        "${scenario_limit[@]}" "$programs/corpus" "$root/tests/fuzz/scenario" \
        "$root/tests/fuzz/found" "$root/tests/bad" "$root/scenarios" >scenarios.log 2>&1
}
fuzz_results() {
    (cd "$programs/found" && exec nice -n 5 "$programs/fuzz_results" "${results_limit[@]}" "$scratch"/*.h5) >results.log 2>&1
}
fuzz_results &
process=$!
fuzz_scenarios
result $? "scenarios: no crash, leak, endless loop or large allocation" scenarios.log
wait "$process"
result $? "results files: the same, and nothing silently wrong" results.log
awk -F: '/number_of_executed_units/ {n = $NF} /average_exec_per_sec/ {print "## scenarios:" n ", a second" $NF}' scenarios.log
sed -n '/damaged files in/,$ s/^/## /p' results.log
