#!/usr/bin/env bash
# Runs every test program and whole-program test; each speaks TAP. Ends with "N passed, N failed".
# Lines of a test that begin with ## are shown.
# Usage: tests/run.sh [PATTERN]  (only tests whose name contains PATTERN, these in any case)
# A test that has passed is not run again before something changes that its outcome may depend on: a program
# itself; of a script the rooms (rooms.sh) that its line "# about:" names, and what they use, of others
# every source; and for all of them scenarios and what they share in tests. Scripts with a line "# long" run
# with STANCE_TEST_SCRIPTS, or STANCE_TEST_LONG, with which every test runs at length. STANCE_TEST_FIRST: none is
# begun when one has failed.
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build} pattern=${1:-} passed=0 failed=0 unchanged=0 stopped=
# Not what the user's settings and files make of it: kernels that tests compile are theirs, too.
unset CDPATH STANCE_ISA STANCE_SCRIPTS "${!SLURM_@}"
STANCE_CACHE=$(realpath -m "$build")/cache && export STANCE_CACHE
export CMOCKA_MESSAGE_OUTPUT=TAP PYTHON=${PYTHON:-/usr/bin/python3} BUILD=$build
# make sanitize: what a sanitizer finds is a crash; the plug-ins of MPI leave memory allocated.
export ASAN_OPTIONS=abort_on_error=1 UBSAN_OPTIONS=abort_on_error=1:print_stacktrace=1
mpi_options=$ASAN_OPTIONS:detect_leaks=0
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT

# What outcomes may depend on: room, file, hash. Rooms of the engine are one; files at the top have that of all (-).
mkdir -p "$build/passed"
find engine runner analysis scenarios tests Makefile README.md -name __pycache__ -prune -o -type f -exec sha256sum {} + |
    awk '{ room = $2; if (!sub(/\/[^\/]*$/, "", room)) room = "-"
           if (match(room, /^(engine|scenarios|tests|analysis\/view)\//)) room = substr(room, 1, RLENGTH - 1)
           print room, $2, $1 }' | sort >"$scratch/sums"
key() { # name: a hash of all that its outcome may depend on
    local script=tests/$1.sh about=-
    [ -e "$script" ] && about=$(sed -n 's/^# about: //p' "$script")
    {
        echo "${STANCE_TEST_LONG:-} ${STANCE_SLOW:-}"
        if [ -e "$script" ]; then cat "$build/kernels"; else sha256sum <"$build/tests/$1"; fi
        # shellcheck disable=SC2086
        bash tests/rooms.sh ${about:--} |
            awk -v script="$script" -v about="$about" 'FILENAME == "-" { used[$1]; next }
                about == "" || $2 == script || $1 == "scenarios" || $1 == "tests" && $2 !~ /\/(test|whole)_/ { print; next }
                about != "-" && ($1 in used || $1 == "runner")' - "$scratch/sums"
    } | sha256sum
}

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
    [ -n "$stopped" ] && [ ! -e "$log.end" ] && return
    if [ -e "$log.before" ]; then
        read -r _ _ ok <"$log.before"
        unchanged=$((unchanged + ok)) passed=$((passed + ok))
        return
    fi
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
    ((bad > 0)) || echo "$(cat "$log.key") $ok" >"$build/passed/$name"
    passed=$((passed + ok)) failed=$((failed + bad))
}

# Names of what matches the pattern among these files.
names() {
    local file name
    for file in "$@"; do
        name=$(basename "${file%.*}")
        [[ -e $file && $name == *$pattern* ]] || continue
        [ -z "$pattern${STANCE_TEST_LONG:-}${STANCE_TEST_SCRIPTS:-}" ] && grep -qx '# long' "$file" && continue
        echo "$name"
    done
}

# One more at a time than there are cores, as some wait for others; first what sees most, scripts about what has
# changed since all passed, then what takes longest.
about=$(comm -13 "$build/passed/.sums" "$scratch/sums" 2>/dev/null | awk '{ print $1 }' | sort -u | paste -sd '|')
tests=$(
    names tests/whole_corpus.sh
    # shellcheck disable=SC2046
    [ -z "$about" ] || names $(grep -lE "^# about: (.* )?($about)( |\$)" tests/whole_*.sh)
    for name in whole_program whole_robust whole_view whole_adding whole_runner whole_ranges whole_objects whole_install test_stepping test_balance test_rest test_lanes; do
        names tests/$name.*
    done
    names tests/whole_*.sh tests/test_*.c
)
tests=$(awk '!seen[$1]++' <<<"$tests")
for name in $tests; do
    key "$name" >"$scratch/$name.key"
    if [ -z "$pattern" ] && grep -qsF "$(cat "$scratch/$name.key")" "$build/passed/$name"; then
        cp "$build/passed/$name" "$scratch/$name.before"
        continue
    fi
    rm -f "$build/passed/$name"
    while (($(jobs -rp | wc -l) > $(nproc))); do wait -n; done
    if [ -n "${STANCE_TEST_FIRST:-}" ] && { grep -qs '^not ok' "$scratch"/*_* || grep -qsv '^0 ' "$scratch"/*.end; }; then
        stopped=1
        break
    fi
    if [[ $name == whole_* ]]; then
        run "$name" env ASAN_OPTIONS="$mpi_options" bash "tests/$name.sh" &
    else
        run "$name" "$build/tests/$name" &
    fi
done
wait
for name in $tests; do report "$name"; done
echo
((unchanged == 0)) || echo "($unchanged of them before, of what has not changed since)"
[ -n "$pattern" ] || ((failed > 0)) || cp "$scratch/sums" "$build/passed/.sums"
echo "$passed passed, $failed failed"
((failed == 0 && passed > 0))
