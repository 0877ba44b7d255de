#!/usr/bin/env bash
# What is made of campaigns, from outside: basins, files of an array merged into one, comparison with
# a tolerance, tables for other programs. Speaks TAP.
set -u
. "$(dirname "$0")/scratch.sh"

{
    balance 0.01 0
    cat <<END
stop: {time: 4}
sweep:
  grid:
    - {path: ground.friction, values: [0.1, 0.2, 0.4]}
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: 50}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 48}
record: {every: 0.1, cases: [3, 2403, 4803]}
END
} >map.yaml
starts='sweep.grid=[{path: initial.offset.theta, from: -0.12, to: 0.06, count: 50},
                    {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 48}]'
expect "a map for each friction" 0 "$stance" run map.yaml -o whole.h5 --quiet

# ---- merging ---------------------------------------------------------------------------------
expect "two of the frictions" 0 "$stance" run map.yaml --quiet -o part2.h5 \
    --set 'sweep.grid[0].values=[0.2, 0.4]' --set 'record.cases=[3, 2403]'
expect "the third" 0 "$stance" run map.yaml --quiet -o part1.h5 \
    --set 'sweep.grid[0].values=[0.1]' --set 'record.cases=[3]'
expect "parts along an axis are merged" 0 "$stance" merge axis.h5 part2.h5 part1.h5
says "... which is said" '^axis.h5: 7200 cases from 2 files along ground.friction, 3 values$'
expect "... to the very file of one run, trajectories and all" 0 "$stance" compare whole.h5 axis.h5
expect "an existing file is not replaced" 3 "$stance" merge axis.h5 part2.h5 part1.h5
says "... and why" 'axis.h5 exists; --force replaces it'
expect "... unless --force says so" 0 "$stance" merge axis.h5 part2.h5 part1.h5 --force

for f in 0.4 0.1 0.2; do
    "$stance" run map.yaml --quiet --set "$starts" --set ground.friction=$f \
        --set 'record.cases=[3]' -o "f$f.h5" >>log 2>&1
done
expect "parts that differ in a number are merged" 0 "$stance" merge number.h5 f0.4.h5 f0.1.h5 f0.2.h5
"$python" - >log 2>&1 <<'END'
import h5py, numpy
whole, merged = h5py.File("whole.h5"), h5py.File("number.h5")
assert merged.attrs["axes"] == b"ground.friction,initial.offset.theta,initial.offset.vtheta"
names = [n for n in whole if isinstance(whole[n], h5py.Dataset) and whole[n].dtype.kind in "uif"]
assert len(names) > 25
for name in names + ["trajectory/position", "trajectory/checksum", "design/gain"]:
    assert numpy.array_equal(whole[name], merged[name], whole[name].dtype.kind == "f"), name
lines = merged.attrs["merged_from"].decode().split("\n")
assert len(lines) == 3 and lines[1].startswith("f0.1.h5: 2400 cases, 20"), lines
assert "merge_note" not in merged.attrs
assert merged["timing/cases"][...].sum() == 7200 and len(merged["timing/cases"]) == 3
END
result $? "... the number is the first axis, sorted; provenance and times are those of the parts"
expect "the merged file is a results file" 0 "$stance" summary number.h5
expect "... that is complete" 0 "$stance" status number.h5
says "... and says so" 'number.h5: 7200 of 7200 cases done.*complete'

for k in 0 1 2; do
    "$stance" run map.yaml --quiet -o "piece$k.h5" --set record.cases=none --set ground.friction=0.8 \
        --set "sweep.grid=[{path: initial.offset.theta, from: $((k * 4 - 16))e-3, to: $((k * 4 - 12))e-3, count: 5},
               {path: method.name, values: [implicit, midpoint]}]" >>log 2>&1
done
expect "pieces of a range are merged" 0 "$stance" merge pieces.h5 piece2.h5 piece0.h5 piece1.h5
says "... their common ends once" 'from 3 files along initial.offset.theta, 13 values; 4 were in several'
"$python" - >log 2>&1 <<'END'
import h5py, numpy
theta = h5py.File("pieces.h5")["initial.offset.theta"][...]
assert numpy.allclose(theta, numpy.linspace(-0.016, -0.004, 13), rtol=0, atol=1e-12), theta
END
result $? "... and are one axis"

cat >halves.py <<'END'
import shutil, h5py
for name, first, last in [("half1.h5", 0, 4000), ("half2.h5", 3500, 7200)]:
    shutil.copy("whole.h5", name)
    with h5py.File(name, "r+") as f:
        status = f["status"][...]
        flat = status.ravel()
        flat[:first] = flat[last:] = 0
        f["status"][...] = status
shutil.copy("half1.h5", "half1b.h5")
shutil.copy("whole.h5", "other.h5")
with h5py.File("other.h5", "r+") as f: # other answers, with a checksum that fits them
    for n in f:
        if isinstance(f[n], h5py.Dataset) and f[n].ndim >= 3:
            f[n][1, 2, 3] = f[n][1, 2, 4]
shutil.copy("whole.h5", "damaged.h5")
with h5py.File("damaged.h5", "r+") as f:
    f["end_time"][1, 2, 3] = 0.123
END
"$python" halves.py >log 2>&1
result $? "(parts of the same scenario)"
expect "what two jobs have computed of one scenario" 0 "$stance" merge halves.h5 half1.h5 half2.h5
says "... what both had" '7200 cases from 2 files; 500 were in several files, and equal'
expect "... is the whole" 0 "$stance" compare whole.h5 halves.h5
expect "what nobody has computed" 0 "$stance" merge open.h5 half1.h5 half1b.h5
says "... is counted" '3200 are not computed yet'
expect "... and resumed" 0 "$stance" run map.yaml -o open.h5 --resume --quiet
expect "... to the same file" 0 "$stance" compare whole.h5 open.h5
expect "a damaged row" 0 "$stance" merge mended.h5 damaged.h5 half1.h5
says "... is left out, and said" '1 case is not as its checksum says and was left out'
expect "... and comes from the other part" 0 "$stance" compare whole.h5 mended.h5
expect "parts that contradict each other" 2 "$stance" merge bad.h5 whole.h5 other.h5
says "... are refused" 'other.h5: 1 case differs .* the first is case 2499 of the whole'
expect "parts of different studies" 2 "$stance" merge bad.h5 f0.1.h5 piece0.h5
says "... are refused, too" 'piece0.h5: differs from f0.1.h5 in .*: parts may differ along one axis'
expect "a file twice" 2 "$stance" merge bad.h5 f0.1.h5 f0.1.h5
expect "a file that is none" 3 "$stance" merge bad.h5 f0.1.h5 map.yaml
expect "one file" 2 "$stance" merge bad.h5 f0.1.h5
[ ! -e bad.h5 ] && [ ! -e bad.h5.merging ]
result $? "nothing is left of what was refused"

# Another version may have drawn other points for the same scenario.
sample='sweep={sample: {method: random, count: 8, vary: [{path: ground.friction, from: 0.2, to: 1}]}}'
for half in drawn1 drawn2; do
    "$stance" run map.yaml --quiet --set "$sample" --set record.cases=none -o $half.h5 >>log 2>&1
done
PYTHONPATH=$tests "$python" - >>log 2>&1 <<'END'
import h5py, numpy, results_tools
with h5py.File("drawn2.h5", "r+") as file:
    points = file["ground.friction"]
    points[3] *= 1.01
    data = b"ground.friction\0" + points[...].tobytes()
    points.attrs.modify("checksum", results_tools.crc32c(numpy.frombuffer(data, numpy.uint8).reshape(1, -1)))
END
expect "other points of the same scenario" 2 "$stance" merge bad.h5 drawn1.h5 drawn2.h5
says "... are refused" '^stance merge: drawn2.h5: its points along sample are not those of drawn1.h5$'
refine='sweep.refine={start: 8, probes: 0}'
"$stance" run map.yaml --quiet --set "$starts" --set "$refine" --set record.cases=none -o low.h5 \
    --set 'sweep.grid[0].to=-0.04' --set 'sweep.grid[0].count=20' >>log 2>&1
"$stance" run map.yaml --quiet --set "$starts" --set "$refine" --set record.cases=none -o high.h5 \
    --set 'sweep.grid[0].from=-0.03' --set 'sweep.grid[0].count=20' >>log 2>&1
expect "refined maps are merged" 0 "$stance" merge refined.h5 low.h5 high.h5
says "... with a word about what was simulated" 'the parts were refined each for itself'

for f in 0.2 0.4; do
    "$stance" run map.yaml --quiet --set "$starts" --set ground.friction=$f -o "noise$f.h5" \
        --set controller.noise=0.1 --set record.cases=none >>log 2>&1
done
expect "parts with noise are merged" 0 "$stance" merge noise.h5 noise0.2.h5 noise0.4.h5
says "... with a word about the random numbers" 'random numbers are keyed'
"$python" -c 'import h5py; assert b"keyed" in h5py.File("noise.h5").attrs["merge_note"]' >log 2>&1
result $? "... in the file, too"

# ---- comparison with a tolerance --------------------------------------------------------------
PYTHONPATH=$tests "$python" - >log 2>&1 <<'END'
import shutil, h5py
from make_sample_results import put_checksums
shutil.copy("whole.h5", "moved.h5")
with h5py.File("moved.h5", "r+") as f:
    f["end_time"][0, 1, 2] *= 1 + 1e-7
    f["peak_torque"][2, 3, 4] += 1e-3
    put_checksums(f)
END
result $? "(numbers that are moved)"
expect "to the bit they differ" 1 "$stance" compare whole.h5 moved.h5
expect "beyond the tolerance" 1 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6
says "... is one" '^peak_torque: 1 of 7200 cases differ$'
says "... within it the other" '^end_time: equal within the tolerance$'
says "... with the largest difference and where it is" 'largest difference .* in case 50 '
expect "an answer's own tolerance" 0 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6 \
    --tolerance peak_torque=0,2e-3
expect "... alone leaves the others exact" 1 "$stance" compare whole.h5 moved.h5 \
    --tolerance peak_torque=0,2e-3
expect "... as JSON" 0 "$stance" compare whole.h5 moved.h5 --tolerance 0.1 --json
"$python" -c 'import json; c = json.load(open("log")); assert c["equal"] and not c["identical"]
d = {x["name"]: x for x in c["differences"]}; assert abs(d["peak_torque"]["largest"] - 1e-3) < 1e-9
assert d["end_time"]["differing"] == 0 and d["end_time"]["largest_at"]["index"] == 50' >>log 2>&1
result $? "... with its keys"
expect "a tolerance that is none" 2 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6x
expect "a variable that is none" 2 "$stance" compare whole.h5 moved.h5 --tolerance end=1
expect "words have no tolerance" 2 "$stance" compare whole.h5 moved.h5 --tolerance outcome=1

# ---- tables ----------------------------------------------------------------------------------
expect "every case as CSV" 0 "$stance" table whole.h5
"$python" - >log2 2>&1 <<'END'
import csv, h5py, numpy
rows, f = list(csv.DictReader(open("log", newline=""))), h5py.File("whole.h5")
assert len(rows) == 7200
number = lambda name: numpy.array([float(r[name] or "nan") for r in rows])
for name in ["end_time", "settle_time", "friction_used", "steps"]:
    assert numpy.array_equal(number(name), f[name][...].ravel(), True), name
assert numpy.array_equal(number("final_vq2"), f["final_state"][..., 9].ravel(), True)
theta = numpy.repeat(f["initial.offset.theta"][...], 48)
assert numpy.array_equal(number("initial.offset.theta"), numpy.tile(theta, 3))
words = numpy.array(["none", "stabilised", "fell", "rested", "undecided"])
assert ([r["outcome"] for r in rows] == words[f["outcome"][...].ravel()]).all()
END
result $? "... has what the file has"
expect "a part of it" 0 "$stance" table half1.h5 --answer outcome --answer end_time --of pending
"$python" -c 'import csv; rows = list(csv.reader(open("log", newline=""))); assert len(rows) == 3201
assert rows[0][4:] == ["outcome", "end_time"] and rows[1][0] == "4000" and rows[1][4:] == ["", ""]' >>log 2>&1
result $? "... and nothing of pending cases"
expect "the summary as CSV" 0 "$stance" summary whole.h5 --csv
"$python" -c 'import csv; rows = list(csv.DictReader(open("log", newline=""))); assert len(rows) == 4
assert rows[0]["parameter"] == "" and rows[2]["value"] == "0.2" and rows[2]["done"] == "2400"
assert sum(int(r["stabilised"]) for r in rows[1:]) == int(rows[0]["stabilised"]) > 100' >>log 2>&1
result $? "... has a row for each value"

# ---- basins ----------------------------------------------------------------------------------
expect "a basin for each friction" 0 "$stance" basin whole.h5 --csv
"$python" - >log2 2>&1 <<'END'
import csv, h5py, numpy
rows, f = list(csv.DictReader(open("log", newline=""))), h5py.File("whole.h5")
assert [r["ground.friction"] for r in rows] == ["0.1", "0.2", "0.4"]
inside = f["outcome"][...] == 1
weight = numpy.outer([.5] + [1] * 48 + [.5], [.5] + [1] * 46 + [.5])
for k, r in enumerate(rows):
    share = (inside[k] * weight).sum() / weight.sum()
    assert abs(float(r["share"]) - share) < 1e-12 and abs(float(r["volume"]) - 0.216 * share) < 1e-12
    assert int(r["inside"]) == inside[k].sum() and int(r["cases"]) == 2400
    cells = [inside[k, i:i + 49, j:j + 47] for i in (0, 1) for j in (0, 1)]
    low, high = numpy.all(cells, 0).mean(), numpy.any(cells, 0).mean()
    assert abs(float(r["low"]) / 0.216 - low) < 1e-12 and abs(float(r["high"]) / 0.216 - high) < 1e-12
    assert r["alpha"] == "" and r["alpha_distances"] == "0" and 0 < float(r["boundary_entropy"]) < numpy.log(2)
END
result $? "... with the volume and the bounds that its cases have"
expect "pending cases widen the bounds" 0 "$stance" basin half1.h5 --json
"$python" -c 'import json; b = json.load(open("log")); r = b["rows"]
assert [x["pending"] for x in r] == [0, 800, 2400] and r[2]["volume"] is None
assert r[2]["low"] == 0 and abs(r[2]["high"] - 0.216) < 1e-12 and r[1]["high"] > r[1]["volume"] > r[1]["low"]
assert b["starts"] == ["initial.offset.theta", "initial.offset.vtheta"] and b["unit"] == "rad * rad/s"' >>log 2>&1
result $? "... to all there is"
expect "the boundary as points" 0 "$stance" basin whole.h5 --boundary
"$python" - >log2 2>&1 <<'END'
import csv, h5py, numpy
rows, f = list(csv.DictReader(open("log", newline=""))), h5py.File("whole.h5")
outcome = f["outcome"][...].astype(int)
assert len(rows) == (numpy.diff(outcome, axis=1) != 0).sum() + (numpy.diff(outcome, axis=2) != 0).sum()
words = ["none", "stabilised", "fell", "rested", "undecided"]
axes = [f[n][...] for n in ("ground.friction", "initial.offset.theta", "initial.offset.vtheta")]
for r in rows:
    at = [float(r[n]) for n in list(r)[:3]]
    a = list(r).index(r["along"])
    for sign, word in ((-1, r["from"]), (1, r["to"])):
        end = list(at)
        end[a] += sign * float(r["half_width"])
        place = [numpy.abs(axes[k] - end[k]).argmin() for k in range(3)]
        assert all(abs(axes[k][place[k]] - end[k]) < 1e-12 for k in range(3))
        assert words[outcome[tuple(place)]] == word
END
result $? "... midway between neighbours that differ"
expect "... as text" 0 "$stance" basin whole.h5
says "... which says why there is no alpha" 'no alpha in some rows: fewer than 96 cases along an axis'
expect "an outcome of one's own" 0 "$stance" basin whole.h5 --of fell --level 0.99 --box 4
expect "an axis of starts as a parameter" 0 "$stance" basin whole.h5 --by initial.offset.vtheta
expect "nothing to measure" 2 "$stance" basin piece0.h5 --by initial.offset.theta
says "... is said" 'no starts are varied (initial.offset'
expect "an axis that is none" 2 "$stance" basin whole.h5 --by friction
expect "an outcome that is none" 2 "$stance" basin whole.h5 --of stable

# Starts that are sampled: the share of a grid lies in the interval.
expect "a Sobol' sample of starts" 0 "$stance" run map.yaml --quiet -o sample.h5 --set record.cases=none \
    --set 'sweep={grid: [{path: ground.friction, values: [0.1, 0.2, 0.4]}],
        sample: {method: sobol, count: 1024, vary: [{path: initial.offset.theta, from: -0.12, to: 0.06},
            {path: initial.offset.vtheta, from: -0.6, to: 0.6}]}}'
expect "... has its basins" 0 "$stance" basin sample.h5 --json
"$stance" basin whole.h5 --json >grid.json 2>>log
"$python" - >log2 2>&1 <<'END'
import h5py, json, math
sample, grid = json.load(open("log")), json.load(open("grid.json"))
outcome = h5py.File("sample.h5")["outcome"][...]
assert sample["design"] == "sobol" and abs(sample["box"] - 0.216) < 1e-12
for k, (a, b) in enumerate(zip(sample["rows"], grid["rows"])):
    n, p, z = 1024, (outcome[k] == 1).mean(), 1.959963984540054
    centre, half = p + z * z / 2 / n, z * math.sqrt(p * (1 - p) / n + z * z / 4 / n / n)
    assert abs(a["share"] - p) < 1e-12 and a["at"] == b["at"] and a["alpha"] is None
    assert abs(a["low"] / 0.216 - (centre - half) / (1 + z * z / n)) < 1e-9
    assert abs(a["high"] / 0.216 - (centre + half) / (1 + z * z / n)) < 1e-9
    assert a["low"] < b["volume"] < a["high"] and a["low"] < a["volume"] < a["high"]
END
result $? "... with Wilson's interval, in which the grid's volume lies"
expect "points on a boundary need a grid" 2 "$stance" basin sample.h5 --boundary

# A sample of parameters beside starts on a grid: points of a block share coordinates, blocks do not.
expect "basins over sampled parameters" 0 "$stance" run map.yaml --quiet -o over.h5 --set record.cases=none \
    --set 'sweep={grid: [{path: initial.offset.theta, from: -0.12, to: 0.06, count: 9},
        {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 8}], sample: {method: saltelli, count: 8,
        vary: [{path: ground.friction, from: 0.05, to: 1}, {path: controller.torque_limit, from: 5, to: 20}]}}'
expect "... are averaged" 0 "$stance" basin over.h5 --json
"$python" - >>log 2>&1 <<'END'
import json, h5py, numpy
found = json.load(open("log"))
inside = (h5py.File("over.h5")["outcome"][...] == 1).astype(float)
assert inside.shape == (9, 8, 32) and 0.05 < inside.mean() < 0.95
edge = lambda n: numpy.where((numpy.arange(n) % (n - 1)) == 0, 0.5, 1)
volume = numpy.einsum("ijp,i,j->p", inside, edge(9), edge(8)) * 0.18 / 8 * 1.2 / 7
blocks = volume.reshape(8, 4).mean(1)
row, = found["rows"]
assert found["averaged"] == ["ground.friction", "controller.torque_limit"], found["averaged"]
assert abs(row["volume"] - volume.mean()) < 1e-12
scatter = 2.364624 * blocks.std(ddof=1) / 8 ** 0.5 # Student's deviations for 7
assert scatter <= row["reach"] < 1.2 * scatter, (row["reach"], scatter)
END
result $? "... and their error is the scatter of whole blocks"
expect "... as text" 0 "$stance" basin over.h5
says "... which says over what" 'averaged over ground.friction, controller.torque_limit'

# ---- rays ------------------------------------------------------------------------------------
cat >rays.sets <<'END'
sweep={grid: [{path: ground.friction, values: [0.2, 0.4]}, {path: initial.offset.scale, from: 0.02, to: 1, count: 50}],
  sample: {method: sphere, count: 24, vary: [{path: initial.offset.theta, from: -0.1, to: 0.1},
    {path: initial.offset.vtheta, from: -0.5, to: 0.5}]}}
END
expect "rays from the equilibrium" 0 "$stance" run map.yaml --quiet -o rays.h5 --set record.cases=none \
    --set "$(cat rays.sets)"
expect "where they lose the outcome" 0 "$stance" basin rays.h5 --boundary
cp log rays.csv
expect "... in short" 0 "$stance" basin rays.h5 --json
"$python" - >log2 2>&1 <<'END'
import csv, h5py, json, numpy
f, rows, short = h5py.File("rays.h5"), list(csv.DictReader(open("rays.csv", newline=""))), json.load(open("log"))
inside, scale = f["outcome"][...] == 1, f["initial.offset.scale"][...]
assert inside.shape == (2, 50, 24) and len(rows) == 48 and inside[:, 0].all()
for k in range(2):
    ends = []
    for p in range(24):
        row, end = rows[24 * k + p], numpy.argmin(inside[k, :, p])
        assert int(row["ray"]) == p and float(row["ground.friction"]) == [0.2, 0.4][k]
        if inside[k, :, p].all():
            assert row["end"] == "open" and row["high"] == ""
            ends.append(numpy.inf)
        else:
            assert row["end"] == "crosses"
            assert [float(row["low"]), float(row["high"])] == [scale[end - 1], scale[end]]
            ends.append((scale[end - 1] + scale[end]) / 2)
            theta = f["initial.offset.theta"][p] * ends[-1]
            assert abs(float(row["initial.offset.theta"]) - theta) < 1e-12
    r = short["rows"][k]
    assert abs(r["smallest"] - min(ends)) < 1e-12 and r["first_ray"] == numpy.argmin(ends)
    assert r["crossing"] + r["open"] == 24 and r["open"] == numpy.isinf(ends).sum()
    assert (r["median"] or numpy.inf) == numpy.median(ends)
END
result $? "... as the cases say"
expect "pictures of rays" 0 "$stance" plot rays.h5
says "... show the curve" '^rays-rays.png$'
expect "--by has no meaning for rays" 2 "$stance" basin rays.h5 --by ground.friction
expect "pictures of basins" 0 "$stance" plot whole.h5
expect "a refined map" 0 "$stance" run map.yaml --quiet -o inferred.h5 --set record.cases=none \
    --set 'sweep={grid: [{path: initial.offset.theta, from: -0.12, to: 0.06, count: 33},
        {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 33}], refine: {start: 8}}'
expect "what it has inferred" 0 "$stance" table inferred.h5 --answer evidence --answer steps
"$python" -c 'import csv; rows = list(csv.DictReader(open("log", newline="")))
assert {(r["evidence"], bool(r["steps"])) for r in rows} == {("inferred", False), ("simulated", True)}' >>log 2>&1
result $? "... has no numbers"
expect "rays as a table" 0 "$stance" table rays.h5 --answer outcome --of fell
"$python" -c 'import csv; rows = list(csv.DictReader(open("log", newline="")))
assert list(rows[0])[1:6] == ["ground.friction", "initial.offset.scale", "sample", "initial.offset.theta", "initial.offset.vtheta"]' >>log 2>&1
result $? "... with the sampled values"
expect "samples of parts are merged" 0 "$stance" run map.yaml --quiet -o ray2.h5 --set record.cases=none \
    --set "$(cat rays.sets)" --set 'sweep.grid[0].values=[0.2]'
expect "... the second part" 0 "$stance" run map.yaml --quiet -o ray4.h5 --set record.cases=none \
    --set "$(cat rays.sets)" --set 'sweep.grid[0].values=[0.4]'
expect "... into the whole" 0 "$stance" merge raysm.h5 ray2.h5 ray4.h5
expect "... to the bit" 0 "$stance" compare rays.h5 raysm.h5

echo "1..$count"
