#!/usr/bin/env bash
# Refined maps from outside: the labels of the full map at a part of its cost, the same file whatever
# the ranks, the lanes, kills and resumes; what the other commands make of it.
# about: runner/run analysis/compare analysis/summary
. "$(dirname "$0")/scratch.sh"
points=150
[ -n "${STANCE_SLOW:-}" ] && points=60

# Two maps beside each other: the axis of words is taken in full.
{
    balance 0.01 0
    cat <<END
stop: {time: 4}
sweep:
  grid:
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: $points}
    - {path: method.name, values: [implicit, midpoint]}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: $points}
record: {every: 0.1, cases: [0, 1003]}
END
} >map.yaml
refine=(--set 'sweep.refine={start: 16, margin: 1, probes: 0.01}')

expect "the full map" 0 "$stance" run map.yaml -o full.h5 --quiet
expect "the refined map" 0 "$stance" run map.yaml "${refine[@]}" -o map.h5 says ': [0-9]* cases: .* of them inferred; '
tool "every case of it is marked and whole" whole map.h5 $((2 * points * points))
holds "simulated cases are those of the full map, the others have its label and nothing else" <<'END'
full, map = h5py.File("full.h5"), h5py.File("map.h5")
inferred = map["evidence"][...] == 2
assert 0.5 < inferred.mean() < 0.95, inferred.mean()
assert (full["outcome"][...] == map["outcome"][...]).mean() > 0.999
assert (map["status"][...] == 1).all() and set(map["outcome"][...].ravel()) == {1, 2, 4}
for name in ["outcome", "evidence", "end_time", "steps", "final_state", "checksum"]:
    assert numpy.array_equal(full[name][...][~inferred], map[name][...][~inferred], True), name
assert numpy.isnan(map["end_time"][...][inferred]).all()
assert numpy.isnan(map["final_state"][...][inferred]).all()
assert (map["steps"][...][inferred] == -2**63).all()
n = len(inferred)
assert not inferred[[0, 16, n - 1]][:, :, [0, 16, n - 1]].any()
assert not inferred.ravel()[[0, 1003]].any()
assert numpy.array_equal(full["trajectory/position"], map["trajectory/position"], True)
END

# ---- the same file ---------------------------------------------------------------------------
for n in 1 2 3; do
    expect "$n ranks" 0 mpirun -n $n "$stance" run map.yaml "${refine[@]}" -o ranks$n.h5 --quiet
    tool "$n ranks give the same bits as none" same map.h5 ranks$n.h5
done
STANCE_ISA=scalar expect "one lane" 0 "$stance" run map.yaml "${refine[@]}" -o scalar.h5 --quiet
tool "one lane gives the same bits" same map.h5 scalar.h5
expect "a finished map is resumed" 0 "$stance" run map.yaml "${refine[@]}" -o scalar.h5 --resume \
    says 'inferred; 0 of them computed now' tool same map.h5 scalar.h5
"$python" "$tests/results_tools.py" damage scalar.h5 0
"$python" "$tests/results_tools.py" damage scalar.h5 5
expect "a simulated and an inferred case are damaged" 0 mpirun -n 2 "$stance" run map.yaml "${refine[@]}" -o scalar.h5 \
    --resume --quiet tool same map.h5 scalar.h5

# Stopped again and again, each time later, until it comes to its end.
stopped=0
for limit in 0.005 0.01 0.02 0.04 0.08 0.16 0.32 0.64 1.3 2.5 5 10 20 40 80; do
    timeout "$patience" "$stance" run map.yaml "${refine[@]}" -o limited.h5 --resume --quiet \
        --time-limit $limit >log 2>&1
    code=$?
    ((code == 4)) && stopped=$((stopped + 1))
    ((code == 4)) || break
done
is "stopped for its time limit more than twice" '((stopped > 2)) && ((code == 0 || code == 4))'
expect "... and ended" 0 "$stance" run map.yaml "${refine[@]}" -o limited.h5 --resume --quiet
tool "... with the same bits" same map.h5 limited.h5

# Killed on its way, half the time that a whole run took; sooner where it was quicker.
killed=0
when=$(($(span "$stance" run map.yaml "${refine[@]}" -o killed.h5 --quiet) / 2)) && rm -f killed.h5
for _ in {1..12}; do
    timeout -s KILL "$(seconds $when)" "$stance" run map.yaml "${refine[@]}" -o killed.h5 --resume \
        --quiet >log 2>&1
    if (($? == 137)); then
        killed=$((killed + 1))
        [ ! -e killed.h5 ] || "$python" "$tests/results_tools.py" whole killed.h5 0 >log 2>&1 || break
    else
        rm -f killed.h5 && when=$((when / 2))
    fi
    ((killed < 4)) || break
done 2>/dev/null
is "killed more than once, what is marked done is whole" '((killed == 4))'
mpirun -n 2 "$stance" run map.yaml "${refine[@]}" -o killed.h5 --resume --quiet >log 2>&1 &
job=$!
await "$job" computing killed.h5
kill -9 "$(pgrep -P $job -x "$(basename "$stance")" | tail -n 1)" 2>/dev/null
wait $job 2>/dev/null
expect "a rank of two was killed, and three went on" 0 mpirun -n 3 "$stance" run map.yaml "${refine[@]}" -o killed.h5 \
    --resume --quiet tool same map.h5 killed.h5
expect "another margin is another scenario" 2 "$stance" run map.yaml "${refine[@]}" --set sweep.refine.margin=2 \
    -o killed.h5 --resume says '^  sweep.refine.margin: 1, now 2'

# A shape that is not a multiple of anything, three axes, and cases that do not exist.
cube=(--set 'sweep.grid=[{path: initial.offset.theta, from: -0.12, to: 0.06, count: 21},
    {path: robot.trunk_length, from: 0.3, to: 9, count: 19},
    {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 30}]' --set 'record={}'
    --set 'sweep.refine={start: 5, margin: 0}')
expect "three axes, with robots that cannot stand so" 1 mpirun -n 2 "$stance" run map.yaml "${cube[@]}" -o cube2.h5 \
    --quiet says ' cases failed; '
expect "the same alone" 1 "$stance" run map.yaml "${cube[@]}" -o cube.h5 --quiet tool same cube.h5 cube2.h5
holds "failed cases were tried, each of them" <<'END'
f = h5py.File("cube.h5")
status, evidence = f["status"][...], f["evidence"][...]
none = f["design/status"][...] == 2
assert 2 < none.sum() < 12, none.sum()
assert (status[:, none] == 2).all() and (status[:, ~none] == 1).all()
assert (evidence[:, none] == 0).all() and (evidence[:, ~none] > 0).all()
assert (evidence == 2).mean() > 0.2, (evidence == 2).mean()
END

# ---- what the other commands make of it --------------------------------------------------------
expect "check says what will be simulated" 0 "$stance" check map.yaml "${refine[@]}" --json
mv log check.json
holds "... as JSON" <<END
found = said("check.json")
side = math.ceil(($points - 1) / 2 ** math.ceil(math.log2($points / 16))) + 1
cases = 2 * $points**2
assert found["refine"] == {"coarse_cases": 2 * side**2, "most_cases": cases,
                           "probes": round(0.01 * (cases - 2 * side**2))}, (found["refine"], side)
assert found["cases"] == cases and found["seconds_is_upper_bound"]
END
expect "a dry run" 0 mpirun -n 2 "$stance" run map.yaml "${refine[@]}" -o dry.h5 --dry-run \
    says '^refine .* coarse lattice'
expect "without refinement" 0 "$stance" check map.yaml --json says '"refine": null'
expect "a summary" 0 "$stance" summary map.h5 says 'not simulated: inferred'
expect "a summary as JSON" 0 "$stance" summary map.h5 --json
mv log summary.json
holds "... counts the same" 'assert said("summary.json")["cases"]["inferred"] == \
    (h5py.File("map.h5")["evidence"][...] == 2).sum()'
expect "maps" 0 "$stance" plot map.h5 -o . is grep -q "inferred from neighbours" map-map.svg
expect "bit for bit the maps differ" 1 "$stance" compare full.h5 map.h5
expect "in their labels they do not" 0 "$stance" compare --labels full.h5 map.h5 \
    says "^labels: $((2 * points * points)) of $((2 * points * points)) equal (100 %)"
# Some labels changed: how far from the boundary, worked out here from its definition.
holds "compare --labels measures how far from the boundary" <<'END'
stance = os.environ["STANCE"]
label = h5py.File("full.h5")["outcome"][...]
for seed in range(4):
    shutil.copy("map.h5", "other.h5")
    places = numpy.random.default_rng(seed).integers(0, label.size, 5)
    with h5py.File("other.h5", "r+") as f:
        changed = f["outcome"][...]
        changed.flat[places] = 3
        f["outcome"][...] = changed
        results_tools.put_checksums(f)
    farthest = 0
    for at in places:
        i, k, j = numpy.unravel_index(at, label.shape)
        x, y = numpy.nonzero(label[:, k, :] != label[i, k, j])
        farthest = max(farthest, numpy.maximum(abs(x - i), abs(y - j)).min())
    done = subprocess.run([stance, "compare", "--labels", "--json", "full.h5", "other.h5"],
                          capture_output=True)
    found = json.loads(done.stdout)
    assert done.returncode == 1 and found["farthest"] == farthest > 0, (found, farthest)
    assert found["equal"] == label.size - len(set(places)) and found["compared"] == label.size
    assert found["first"][0]["index"] == min(places) and found["first"][0]["values"][1] == "rested"
END
expect "maps over other axes are not compared" 2 "$stance" compare --labels full.h5 cube.h5 \
    says 'not over the same axes'
