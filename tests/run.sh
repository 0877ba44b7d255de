#!/usr/bin/env bash
# Runs every test program and whole-program test; each speaks TAP. Ends with "N passed, N failed".
# Lines of a test that begin with ## are shown.
# Usage: tests/run.sh [PATTERN]  (only tests whose name contains PATTERN)
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build} pattern=${1:-} passed=0 failed=0
# Not what the user's settings and files make of it: kernels that tests compile are theirs, too.
unset CDPATH STANCE_ISA STANCE_SCRIPTS "${!SLURM_@}"
STANCE_CACHE=$(realpath -m "$build")/cache && export STANCE_CACHE
export CMOCKA_MESSAGE_OUTPUT=TAP PYTHON=${PYTHON:-/usr/bin/python3} BUILD=$build
# make sanitize: what a sanitizer finds is a crash; the plug-ins of MPI leave memory allocated.
export ASAN_OPTIONS=abort_on_error=1 UBSAN_OPTIONS=abort_on_error=1:print_stacktrace=1
mpi_options=$ASAN_OPTIONS:detect_leaks=0
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT

# name, command ...: leaves what it said, its exit status, its seconds and those of processors in the
# scratch directory.
run() {
    local log="$scratch/$1" begin=$SECONDS
    shift
    { TIMEFORMAT="%U"; time "$@" >"$log" 2>"$log.err" </dev/null; } 2>"$log.cpu"
    echo $? $((SECONDS - begin)) >"$log.end"
}

report() { # name
    local name=$1 log="$scratch/$1" status=1 seconds=0 ok bad
    [ -e "$log.end" ] && read -r status seconds <"$log.end"
    ok=$(grep -c '^ok' "$log") bad=$(grep -c '^not ok' "$log")
    # A program that dies, or that tests nothing, has failed whatever it printed.
    if ((status != 0 && bad == 0)) || ((ok + bad == 0)); then bad=$((bad + 1)); fi
    printf '%-28s %4d passed %4d failed  %3d s, computing %s\n' "$name" "$ok" "$bad" "$seconds" "$(tail -n 1 "$log.cpu")"
    sed -n 's/^## /    /p' "$log"
    if ((bad > 0)); then
        grep -v '^ok' "$log" | tail -n 60
        tail -n 40 "$log.err"
        echo "($name: exit status $status)"
    fi
    passed=$((passed + ok)) failed=$((failed + bad))
}

# Names of what matches the pattern among these files.
names() {
    local file name
    for file in "$@"; do
        name=$(basename "${file%.*}")
        [[ -e $file && $name == *$pattern* ]] && echo "$name"
    done
}

# One more at a time than there are cores, as some wait for others; those that take longest first.
tests=$(
    for name in whole_program whole_robust whole_view whole_adding whole_runner whole_ranges whole_objects whole_install test_stepping test_balance test_rest test_lanes; do
        names tests/$name.*
    done
    names tests/whole_*.sh tests/test_*.c
)
tests=$(awk '!seen[$1]++' <<<"$tests")
for name in $tests; do
    while (($(jobs -rp | wc -l) > $(nproc))); do wait -n; done
    if [[ $name == whole_* ]]; then
        run "$name" env ASAN_OPTIONS="$mpi_options" bash "tests/$name.sh" &
    else
        run "$name" "$build/tests/$name" &
    fi
done
wait
for name in $tests; do report "$name"; done
echo
echo "$passed passed, $failed failed"
((failed == 0 && passed > 0))
