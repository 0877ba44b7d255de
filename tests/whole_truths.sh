#!/usr/bin/env bash
# What is known from outside (scenarios/truth): the list against independent programs, every method against
# the list (truths.py); that a wrong number shows; what is said of a list that is wrong.
# about: analysis/bench
bench=$(cd "$(dirname "$0")/../${BUILD:-build}/tests" && pwd)/bench_truths
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache
ln -s "$shipped" scenarios

"$python" "$tests/truths.py" "$bench"
truths=$?
((truths <= 1)) || result 1 "truths.py ends"

# ---- one truth, and what is done with it -------------------------------------------------------------
row() { # a list of one truth that is right, edited
    cat >list.yaml <<END
truths:
  - truth: ball thrown
    scenario: scenarios/truth/projectile.yaml
    read: z
    value: 0.2608
    bar: 0
    source: Galilei
END
    [ $# = 0 ] || sed -i "$@" list.yaml
}
row 's/0.2608/0.2618/'
expect "a number that is wrong" 0 "$bench" list.yaml --json --csv list.csv --method capturing --method midpoint
holds "... shows, in JSON and CSV" 'rows = said()
assert [r["method"] for r in rows] == ["capturing", "midpoint"]
assert all(abs(r["error"] - 1e-3) < 1e-10 and r["microseconds_per_second"] > 0 for r in rows), rows
assert [float(r["error"]) for r in table("list.csv")] == [r["error"] for r in rows]'
row
mkdir folder && sed 's|scenarios/truth/||' list.yaml >folder/truths.yaml && cp scenarios/truth/projectile.yaml folder
expect "its table and its picture, of a folder" 0 "$bench" folder -o pictures --format png \
    says "^ball thrown .* Galilei$" is [ -s pictures/truth.png ]
row 's/read: z/trace: [x, z]/; s/0.2608/2/'
expect "a derivative of a flight: 1 for each coordinate" 0 "$bench" list.yaml --json --method midpoint \
    holds 'assert said()[0]["error"] < 1e-9'
row 's/read: z/read: max_penetration\n    border: stop.time\n    between: [0.5, 1]/'
expect "a border that is not there" 0 "$bench" list.yaml says "ball thrown .* none"

# ---- lists that are wrong ----------------------------------------------------------------------------
wrong() { # name, what is said, sed
    row "$3"
    expect "$1" 2 "$bench" list.yaml says "$2"
}
wrong "an unknown key" "^list.yaml:4:5: unknown key 'reads'" 's/read:/reads:/'
wrong "no number" "^list.yaml:5:12: a number is needed" 's/0.2608/high/'
wrong "no source" "^list.yaml:2:.*truth, scenario, value, bar and source are needed" '/source/d'
wrong "nothing to read" "^list.yaml:2:.*either read or trace is needed" '/read/d'
wrong "no such coordinate" "^list.yaml:2:.*nothing is called y there" 's/read: z/read: y/'
wrong "no such scenario" "No such file" 's/projectile/projectiles/'
wrong "a setting that does not exist" "methods" 's/read: z/read: z\n    set: [methods.step=1]/'
wrong "a bar below 0" "^list.yaml:2:.*bar is 0 (exact) or more" 's/bar: .*/bar: -1/'
{ cat scenarios/truth/projectile.yaml && echo 'sweep: {grid: [{path: initial.state.z, values: [1, 2]}]}'; } >sweep.yaml
wrong "a sweep" "sweep.yaml has a sweep" 's|scenarios/truth/projectile|sweep|'
echo 'truths: []' >list.yaml
expect "an empty list" 2 "$bench" list.yaml says "no truth is in the list"
expect "no list" 3 "$bench" nowhere.yaml
expect "a method that does not exist" 2 "$bench" --method euler says "unknown method 'euler'"
expect "no number of times" 2 "$bench" --finer 0.001
expect "what the product had" 2 "$stance" bench truth says 'truths are computed by `make truths` in the source tree'
exit $((failed > 0 || truths > 0))
