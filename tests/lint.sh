#!/usr/bin/env bash
# Format, symbol prefixes, include rules, file lengths; with STANCE_TEST_LONG static analysis.
set -u
cd "$(dirname "$0")/.."
bad=0
complain() { echo "lint: $*"; bad=1; }

mapfile -t sources < <(git ls-files '*.c' '*.h')
clang-format --dry-run --Werror "${sources[@]}" || complain "run clang-format -i on the files above"

grep -nE '#include *[<"](mpi|hdf5|yaml)\.h' $(git ls-files engine) && complain "the engine must not know MPI, HDF5 or YAML"
[ "$(git ls-files runner analysis | xargs grep -lE '#include *<mpi\.h>' | tr '\n' ' ')" = "runner/ranks/parallel.c " ] ||
    complain "only runner/ranks/parallel.c includes mpi.h"
[ "$(git ls-files runner analysis | xargs grep -lE '#include *<hdf5(_hl)?\.h>' | grep -v '^runner/store/')" = "" ] ||
    complain "only runner/store includes hdf5.h"
[ "$(git ls-files engine | xargs grep -l TREE_RUNTIME | tr '\n' ' ')" = "engine/core/lanes/lanes.h engine/scenes/runtime_lanes.h engine/scenes/tree_lanes.h " ] ||
    complain "what is computed must not depend on whether the structure is read at run time: TREE_RUNTIME"
bash tests/rooms.sh || complain "rooms are out of order, see tests/rooms.sh"

for f in "${sources[@]}"; do
    lines=$(wc -l <"$f") most=700
    [[ $f == tests/* ]] && most=800
    ((lines <= most)) || complain "$f has $lines lines"
done

make -s build/libstance.a build/libstance_control.a || complain "the engine does not build"
for symbol in $(nm -g --defined-only build/libstance.a build/libstance_control.a 2>/dev/null | awk 'NF == 3 && $3 !~ /^stance_/ {print $3}' | sort -u); do
    complain "exported engine symbol without stance_: $symbol"
done

[ -z "${STANCE_TEST_LONG:-}" ] || cppcheck --quiet -j "$(nproc)" --std=c11 --error-exitcode=1 --inline-suppr --enable=warning,performance,portability \
    --suppress=missingIncludeSystem --suppress=unknownMacro --suppress=ctuuninitvar -DSTANCE_LANES=1 -DSTANCE_MPI -D__x86_64__ -I. \
    '-DSTANCE_SCENE_LANES="engine/scenes/biped_lanes.h"' -DSTANCE_SCENE=biped -DSTANCE_ISA=scalar \
    runner analysis engine/*.c engine/control engine/scenes || complain "cppcheck"

kernel='-DSTANCE_LANES=1 -DSTANCE_SCENE=biped -DSTANCE_ISA=scalar -DSTANCE_SCENE_LANES=\"engine/scenes/biped_lanes.h\"'
flags="$kernel -I. -std=c17 -D_GNU_SOURCE -DSTANCE_MPI $(mpicc --showme:compile) $(pkg-config --cflags hdf5-openmpi yaml-0.1 jansson lapacke gsl libxml-2.0)"
checks='-*,bugprone-*,-bugprone-easily-swappable-parameters,-bugprone-reserved-identifier,-bugprone-narrowing-conversions,-bugprone-implicit-widening-of-multiplication-result,-bugprone-assignment-in-if-condition,-bugprone-macro-parentheses,clang-analyzer-*,-clang-analyzer-security.insecureAPI.DeprecatedOrUnsafeBufferHandling,-clang-analyzer-optin.mpi*,readability-function-size'
sizes='{CheckOptions: [{key: readability-function-size.ParameterThreshold, value: 7}, {key: readability-function-size.StatementThreshold, value: 800}]}'
[ -z "${STANCE_TEST_LONG:-}" ] || git ls-files 'runner/*.c' 'analysis/*.c' 'engine/*.c' | # pathspecs go into the rooms
    xargs -P "$(nproc)" -I{} sh -c "clang-tidy --quiet --warnings-as-errors='*' --checks='$checks' --config='$sizes' {} -- $flags 2>/dev/null" ||
    complain "clang-tidy"
[ -z "${STANCE_TEST_LONG:-}" ] || git ls-files 'engine/methods/*.c' | # what kernels are made of stands in headers
    xargs -P "$(nproc)" -I{} sh -c "clang-tidy --quiet --warnings-as-errors='*' --checks='-*,readability-function-size' --config='$sizes' --header-filter='engine/' {} -- $flags 2>/dev/null" ||
    complain "functions with more than seven parameters"

((bad == 0)) && echo "lint: clean"
exit $bad
