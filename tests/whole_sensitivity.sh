#!/usr/bin/env bash
# `stance sensitivity` from outside: `stance run` makes the files of sampled studies, an answer of
# which then becomes a function with known indices; what failed and pending cases do; bad use.
# about: runner/run analysis/sensitivity
. "$(dirname "$0")/scratch.sh"
blocks=512
[ -n "${STANCE_SLOW:-}" ] && blocks=256

clause_words+="known "
known() { # name, task ...
    "$python" "$tests/sensitivity_tools.py" "${@:2}" >log 2>&1
    result $? "$1"
}
# A study of a known function: FILE.h5, as `stance run` and the tool make it.
study() { # FILE, function, method, count, keys ...
    local file=$1 function=$2
    shift
    "$python" "$tests/sensitivity_tools.py" scenario "$@" >"$file.yaml"
    expect "$file: $1, $2 of $3" 0 "$stance" run "$file.yaml" -o "$file.h5" --quiet \
        known answer "$file.h5" "$function" tool whole "$file.h5"
}
# Text, JSON and CSV of it; the intervals hold the truth.
indices() { # FILE, function
    local file=$1 ask=(--answer end_time)
    is "$file: --json" '"$stance" sensitivity "$file.h5" "${ask[@]}" --json >"$file.json" 2>log'
    known "... intervals hold the published values" check "$2" "$file.json"
    sed 's/^/# /' log | tail -n 1
    "$stance" sensitivity "$file.h5" "${ask[@]}" --json --level 0.999 --resamples 4000 >wide.json 2>log &&
        "$python" "$tests/sensitivity_tools.py" check "$2" wide.json >log 2>&1
    result $? "... all of them at 99.9 %"
    is "... --csv" '"$stance" sensitivity "$file.h5" "${ask[@]}" --csv >"$file.csv" 2>log'
    known "... says the same" table "$file.json" "$file.csv"
}

study ishigami ishigami saltelli $blocks "second_order: true"
indices ishigami ishigami
study g sobol_g saltelli $blocks
indices g sobol_g
study morris morris morris 100 "levels: 4"
indices morris morris
# The first ten factors matter, the others do not.
holds "... ten factors stand apart" - morris.json <<'END'
factors = said(sys.argv[1])["tables"][0]["factors"]
assert factors[9]["mu_star"]["low"] > factors[10]["mu_star"]["high"]
END

ask=(sensitivity ishigami.h5 --answer end_time)
expect "text" 0 "$stance" "${ask[@]}" says '^method.name = midpoint$' 'over initial.state.z: 3 cases$'
times "... and the one pair that interacts" 2 'initial.state.x with initial.state.q1 0.[23]'
cp log first
expect "the same again" 0 "$stance" "${ask[@]}" is cmp -s log first
expect "--by none" 0 "$stance" "${ask[@]}" --by none says '^  factor'
expect "--by a start" 0 "$stance" "${ask[@]}" --by initial.state.z times 3 '^initial.state.z = '
study lhs ishigami lhs 1000
expect "bins" 0 "$stance" sensitivity lhs.h5 --answer end_time
cp log first
expect "other resamples" 0 "$stance" sensitivity lhs.h5 --answer end_time --seed 7 is ! cmp -s log first
expect "as JSON" 0 bash -c "$stdout_alone" - "$stance" sensitivity lhs.h5 --answer end_time --json
cp log lhs.json
holds "... hold the published values, too" - lhs.json <<'END'
for table in said(sys.argv[1])["tables"]:
    found = {f["path"]: f["first"] for f in table["factors"]}
    for path, truth in zip(("initial.state.x", "initial.state.theta", "initial.state.q1"),
                           (0.3139, 0.4424, 0)):
        assert found[path]["low"] < truth < found[path]["high"], (path, found[path])
END

# Sample points are the fastest axis: case 1 is in block 0; a block has 8 points with second_order.
points=$((8 * blocks))
cp ishigami.h5 lost.h5
known "a point whose three starts failed" mark lost.h5 2 1 $((points + 1)) $((2 * points + 1))
expect "... takes its block out" 0 "$stance" sensitivity lost.h5 --answer end_time \
    says "^  $((blocks - 1)) blocks, 1 block lost for want of a case; " '^failed cases: 3 of .* left out; '
known "a start that failed" mark lost.h5 1 1
expect "... only leaves the mean" 0 "$stance" sensitivity lost.h5 --answer end_time times 2 "^  $blocks blocks; "
cp ishigami.h5 pending.h5
known "a case is pending" mark pending.h5 0 9
expect "... whose block waits" 0 "$stance" sensitivity pending.h5 --answer end_time \
    says "^  $((blocks - 1)) blocks, 1 not complete yet; "

# Shares: all cases of a short flight are undecided, but those marked as failed.
expect "a share that does not vary" 0 "$stance" sensitivity ishigami.h5 --of undecided
times "... depends on nothing" 2 'depends on none of the factors'
cp ishigami.h5 shares.h5
# shellcheck disable=SC2046
known "a fifth of a table's cases failed" mark shares.h5 2 $(seq 3 5 $((3 * points - 1)))
expect "left out" 0 "$stance" sensitivity shares.h5 --of undecided --failed drop \
    says 'WARNING: failed cases counted as fallen (--failed fallen), first of '
expect "counted as fallen" 0 "$stance" sensitivity shares.h5 --of undecided --failed fallen \
    says '^failed cases: .* counted as fallen$'

expect "a picture" 0 "$stance" sensitivity g.h5 --answer end_time -o pictures
is "... as SVG and PNG" '[ -s pictures/g-end_time-sensitivity.svg ] && [ -s pictures/g-end_time-sensitivity.png ]'
expect "stance plot draws it" 0 "$stance" plot morris.h5 --answer end_time -o pictures
is "... by itself" [ -s pictures/morris-end_time-sensitivity.png ]

refused() { # name, code, pattern, command ...
    expect "$1" "$2" "$stance" sensitivity "${@:4}" says "$3"
}
refused "no file" 2 'a results file must be given'
refused "a file that is not there" 3 'No such file' nowhere.h5
refused "an axis that is none" 2 "did you mean 'method.name'" ishigami.h5 --by method.nam
refused "the sample as an axis" 2 'not a grid axis' ishigami.h5 --by sample
refused "an answer that is none" 2 'takes one of end_time' ishigami.h5 --answer end
refused "an outcome that is none" 2 'takes one of stabilised, walks, rested, fell, undecided, not .fallen.' ishigami.h5 --of fallen
refused "an answer of failed cases" 2 'has no meaning with --answer' ishigami.h5 --answer steps --failed fallen
refused "a level beyond" 2 'takes a number from 0.5' ishigami.h5 --level 95
refused "a level that is none" 2 'takes a number from 0.5' ishigami.h5 --level nan
refused "too few resamples" 2 'takes a whole number from 100' ishigami.h5 --resamples 10
refused "two outputs" 2 '--json and --csv exclude each other' ishigami.h5 --json --csv
expect "a study without samples" 0 "$stance" run ishigami.yaml -o grid.h5 --quiet --set 'sweep={grid: [{path: method.name, values: [implicit, midpoint]}]}'
refused "... is refused" 2 'has no sampled factors' grid.h5
