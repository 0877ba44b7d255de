#!/usr/bin/env bash
# What is made of campaigns, from outside: basins, files of an array merged into one, comparison with
# a tolerance, tables for other programs.
# about: runner/store analysis/basin analysis/compare analysis/plot
. "$(dirname "$0")/scratch.sh"

{
    balance 0.01 0
    grid 50 48 | sed '/grid:/a\    - {path: ground.friction, values: [0.1, 0.2, 0.4]}'
    printf '%s\n' 'stop: {time: 4}' 'record: {every: 0.1, cases: [3, 2403, 4803]}'
} >map.yaml
runs() { # name, file, setting ...: map.yaml with these and no case recorded
    local sets=(record.cases=none "${@:3}")
    expect "$1" 0 "$stance" run map.yaml --quiet -o "$2.h5" "${sets[@]/#/--set=}"
}
starts() { # theta from, to, count; vtheta from, to, count: two axes
    echo "{path: initial.offset.theta, from: $1, to: $2, count: $3}," \
        "{path: initial.offset.vtheta, from: $4, to: $5, count: $6}"
}
box() { starts -0.12 0.06 "$1" -0.6 0.6 "$2"; }   # so many points on each
drawn='[{path: initial.offset.theta, from: -0.12, to: 0.06}, {path: initial.offset.vtheta, from: -0.6, to: 0.6}]'
map="sweep.grid=[$(box 50 48)]"
expect "a map for each friction" 0 "$stance" run map.yaml -o whole.h5 --quiet

# ---- merging ---------------------------------------------------------------------------------
expect "two of the frictions" 0 "$stance" run map.yaml --quiet -o part2.h5 \
    --set 'sweep.grid[0].values=[0.2, 0.4]' --set 'record.cases=[3, 2403]'
expect "the third" 0 "$stance" run map.yaml --quiet -o part1.h5 \
    --set 'sweep.grid[0].values=[0.1]' --set 'record.cases=[3]'
expect "parts along an axis are merged" 0 "$stance" merge axis.h5 part2.h5 part1.h5 \
    says '^axis.h5: 7200 cases from 2 files along ground.friction, 3 values$' as whole.h5
expect "an existing file is not replaced" 3 "$stance" merge axis.h5 part2.h5 part1.h5 \
    says 'axis.h5 exists; --force replaces it'
expect "... unless --force says so" 0 "$stance" merge axis.h5 part2.h5 part1.h5 --force

for f in 0.4 0.1 0.2; do
    "$stance" run map.yaml --quiet --set "$map" --set ground.friction=$f --set 'record.cases=[3]' -o "f$f.h5" >>log 2>&1
done
expect "parts that differ in a number are merged" 0 "$stance" merge number.h5 f0.4.h5 f0.1.h5 f0.2.h5 holds <<'END'
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
expect "the merged file is a results file" 0 "$stance" summary number.h5
expect "... that is complete" 0 "$stance" status number.h5 says 'number.h5: 7200 of 7200 cases done.*complete'

for k in 0 1 2; do
    runs "piece$k" "piece$k" ground.friction=0.8 \
        "sweep.grid=[{path: initial.offset.theta, from: $((k * 4 - 16))e-3, to: $((k * 4 - 12))e-3, count: 5},
               {path: method.name, values: [implicit, midpoint]}]"
done
expect "pieces of a range are merged and are one axis" 0 "$stance" merge pieces.h5 piece2.h5 piece0.h5 piece1.h5 \
    says 'from 3 files along initial.offset.theta, 13 values; 4 were in several' holds <<'END'
theta = h5py.File("pieces.h5")["initial.offset.theta"][...]
assert numpy.allclose(theta, numpy.linspace(-0.016, -0.004, 13), rtol=0, atol=1e-12), theta
END

holds "(parts of the same scenario)" <<'END'
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
expect "what two jobs have computed of one scenario" 0 "$stance" merge halves.h5 half1.h5 half2.h5 \
    says '7200 cases from 2 files; 500 were in several files, and equal' as whole.h5
expect "what nobody has computed" 0 "$stance" merge open.h5 half1.h5 half1b.h5 says '3200 are not computed yet'
expect "... and resumed" 0 "$stance" run map.yaml -o open.h5 --resume --quiet as whole.h5
expect "a damaged row" 0 "$stance" merge mended.h5 damaged.h5 half1.h5 \
    says '1 case left out: not as its checksum says' as whole.h5
expect "parts that contradict each other" 2 "$stance" merge bad.h5 whole.h5 other.h5 \
    says 'other.h5: 1 case differs .* the first is case 2499 of the whole'
expect "parts of different studies" 2 "$stance" merge bad.h5 f0.1.h5 piece0.h5 \
    says 'piece0.h5: differs from f0.1.h5 in .*: parts may differ along one axis'
expect "a file twice" 2 "$stance" merge bad.h5 f0.1.h5 f0.1.h5
expect "a file that is none" 3 "$stance" merge bad.h5 f0.1.h5 map.yaml
expect "one file" 2 "$stance" merge bad.h5 f0.1.h5 is '[ ! -e bad.h5 ] && [ ! -e bad.h5.next ]'

# Another version may have drawn other points for the same scenario.
sample='sweep={sample: {method: random, count: 8, vary: [{path: ground.friction, from: 0.2, to: 1}]}}'
for half in drawn1 drawn2; do runs "$half" $half "$sample"; done
holds "(points of another version)" <<'END'
with h5py.File("drawn2.h5", "r+") as file:
    points = file["ground.friction"]
    points[3] *= 1.01
    data = b"ground.friction\0" + points[...].tobytes()
    points.attrs.modify("checksum", results_tools.crc32c(numpy.frombuffer(data, numpy.uint8).reshape(1, -1)))
END
expect "other points of the same scenario" 2 "$stance" merge bad.h5 drawn1.h5 drawn2.h5 \
    says '^stance merge: drawn2.h5: its points along sample are not those of drawn1.h5$'
refine='sweep.refine={start: 8, probes: 0}'
runs "low" low "$map" "$refine" 'sweep.grid[0].to=-0.04' 'sweep.grid[0].count=20'
runs "high" high "$map" "$refine" 'sweep.grid[0].from=-0.03' 'sweep.grid[0].count=20'
expect "refined maps are merged" 0 "$stance" merge refined.h5 low.h5 high.h5 \
    says 'The parts were refined each for itself: .* (attribute merge_note)'

for f in 0.2 0.4; do runs "noise$f" "noise$f" "$map" ground.friction=$f controller.noise=0.1; done
expect "parts with noise are merged" 0 "$stance" merge noise.h5 noise0.2.h5 noise0.4.h5 \
    says 'Random numbers .* are keyed' holds 'assert b"keyed" in h5py.File("noise.h5").attrs["merge_note"]'

# ---- comparison with a tolerance --------------------------------------------------------------
holds "(numbers that are moved)" <<'END'
from make_sample_results import put_checksums
shutil.copy("whole.h5", "moved.h5")
with h5py.File("moved.h5", "r+") as f:
    f["end_time"][0, 1, 2] *= 1 + 1e-7
    f["peak_torque"][2, 3, 4] += 1e-3
    put_checksums(f)
END
expect "to the bit they differ" 1 "$stance" compare whole.h5 moved.h5
expect "beyond the tolerance" 1 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6 \
    says '^peak_torque: 1 of 7200 cases differ$' '^end_time: equal within the tolerance$' \
        'largest difference .* in case 50 '
expect "an answer's own tolerance" 0 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6 --tolerance peak_torque=0,2e-3
expect "... alone leaves the others exact" 1 "$stance" compare whole.h5 moved.h5 --tolerance peak_torque=0,2e-3
expect "... as JSON" 0 "$stance" compare whole.h5 moved.h5 --tolerance 0.1 --json holds 'c = said()
d = {x["name"]: x for x in c["differences"]}; assert c["equal"] and not c["identical"]
assert abs(d["peak_torque"]["largest"] - 1e-3) < 1e-9
assert d["end_time"]["differing"] == 0 and d["end_time"]["largest_at"]["index"] == 50'
expect "a tolerance that is none" 2 "$stance" compare whole.h5 moved.h5 --tolerance 1e-6x
expect "a variable that is none" 2 "$stance" compare whole.h5 moved.h5 --tolerance end=1
expect "words have no tolerance" 2 "$stance" compare whole.h5 moved.h5 --tolerance outcome=1

# ---- tables ----------------------------------------------------------------------------------
expect "every case as CSV has what the file has" 0 "$stance" table whole.h5 holds <<'END'
rows, f = table(), h5py.File("whole.h5")
assert len(rows) == 7200
number = lambda name: numpy.array([float(r[name] or "nan") for r in rows])
for name in ["end_time", "settle_time", "friction_used", "steps"]:
    assert numpy.array_equal(number(name), f[name][...].ravel(), True), name
assert numpy.array_equal(number("final_vq2"), f["final_state"][..., 9].ravel(), True)
theta = numpy.repeat(f["initial.offset.theta"][...], 48)
assert numpy.array_equal(number("initial.offset.theta"), numpy.tile(theta, 3))
assert [r["outcome"] for r in rows] == [OUTCOMES[o] for o in f["outcome"][...].ravel()]
END
expect "a part of it" 0 "$stance" table half1.h5 --answer outcome --answer end_time --of pending
holds "... and nothing of pending cases" 'rows = list(csv.reader(open("log", newline=""))); assert len(rows) == 3201
assert rows[0][4:] == ["outcome", "end_time"] and rows[1][0] == "4000" and rows[1][4:] == ["", ""]'
expect "the summary as CSV" 0 "$stance" summary whole.h5 --csv holds 'rows = table(); assert len(rows) == 4
assert rows[0]["parameter"] == "" and rows[2]["value"] == "0.2" and rows[2]["done"] == "2400"
assert sum(int(r["stabilised"]) for r in rows[1:]) == int(rows[0]["stabilised"]) > 100'

# ---- basins ----------------------------------------------------------------------------------
expect "a basin for each friction" 0 "$stance" basin whole.h5 --csv holds <<'END'
rows, f = table(), h5py.File("whole.h5")
assert [r["ground.friction"] for r in rows] == ["0.1", "0.2", "0.4"]
inside, weight = f["outcome"][...] == 1, numpy.outer(cells(50), cells(48))
for k, r in enumerate(rows):
    share = (inside[k] * weight).sum() / weight.sum()
    assert abs(float(r["share"]) - share) < 1e-12 and abs(float(r["volume"]) - 0.216 * share) < 1e-12
    assert int(r["inside"]) == inside[k].sum() and int(r["cases"]) == 2400
    corners = [inside[k, i:i + 49, j:j + 47] for i in (0, 1) for j in (0, 1)]
    low, high = numpy.all(corners, 0).mean(), numpy.any(corners, 0).mean()
    assert abs(float(r["low"]) / 0.216 - low) < 1e-12 and abs(float(r["high"]) / 0.216 - high) < 1e-12
    assert r["alpha"] == "" and r["alpha_distances"] == "0" and 0 < float(r["boundary_entropy"]) < numpy.log(2)
END
expect "pending cases widen the bounds" 0 "$stance" basin half1.h5 --json holds 'b = said(); r = b["rows"]
assert [x["pending"] for x in r] == [0, 800, 2400] and r[2]["volume"] is None
assert r[2]["low"] == 0 and abs(r[2]["high"] - 0.216) < 1e-12 and r[1]["high"] > r[1]["volume"] > r[1]["low"]
assert b["starts"] == ["initial.offset.theta", "initial.offset.vtheta"] and b["unit"] == "rad * rad/s"'
# A box that cuts the domain, one that does not, and what does not depend on it.
small=$(starts -0.03 0.03 31 -0.12 0.12 31) large=$(starts -0.2 0.12 161 -0.9 1 96)
line='{path: initial.offset.theta, from: -0.2, to: 0.1, count: 151}'
for domain in small large line; do
    runs "$domain" $domain ground.friction=0.4 "sweep={grid: [${!domain}]}"
    "$stance" basin $domain.h5 --json >$domain.json 2>>log
    "$stance" summary $domain.h5 --json >$domain.summary 2>>log
done
holds "the box: faces that cut, the part about the equilibrium, distances" <<'END'
from scipy import ndimage
for name in ["small", "large", "line"]:
    b, s, f = said(name + ".json"), said(name + ".summary"), h5py.File(name + ".h5")
    row, = b["rows"]
    inside = f["outcome"][...] == 1
    axes = [f[p][...] for p in b["starts"]]
    cut = [{"path": p, "end": word, "at": axes[a][end]} for a, p in enumerate(b["starts"])
           for end, word in ((0, "lower"), (-1, "upper")) if inside.take(end, a).any()]
    assert row["cut"] == cut == s["cut"], (row["cut"], cut)
    label, _ = ndimage.label(inside)
    own = label == label[tuple(numpy.abs(x).argmin() for x in axes)]
    weight = numpy.ones(())
    for x in axes:
        weight = numpy.multiply.outer(weight, numpy.multiply(cells(len(x)), x[1] - x[0]))
    assert abs((own * weight).sum() - row["connected"]) < 1e-9, row["connected"]
    assert row["bounded"] == (not any(own.take(e, a).any() for a in range(own.ndim) for e in (0, -1)))
    assert b["weights"] == {p: 1 for p in b["starts"]}
small, large, line = (said(n + ".json")["rows"][0] for n in ("small", "large", "line"))
print(small, large, line)
assert len(small["cut"]) == 4 and small["bounded"] is False and small["share"] > 0.6 > large["share"]
assert line["bounded"] is True and line["cut"] == [] and line["nearest_least"] == line["nearest"]
# The nearest point is the same in both boxes, to their cells, and beside the line's.
assert abs(small["nearest"] - large["nearest"]) < 0.004 and 0 < line["nearest"] - large["nearest"] < 0.004
assert small["leaving"] > large["leaving"] and (small["median"] is None) == (small["leaving"] > 0.5)
END
expect "... as text" 0 "$stance" basin small.h5 \
    says '^  cut by the box at initial.offset.theta = -0.03 rad and 0.03 rad (both ends), initial.offset.vtheta = -0.12' \
        "the share is the box's"
expect "... not cut" 0 "$stance" basin line.h5 says 'bounded: it ends within the box'
expect "... in the summary" 0 "$stance" summary small.h5 \
    says 'stabilised set cut by the box at initial.offset.theta = -0.03 rad and 0.03 rad (both ends)'
mkdir scripts
expect "... and in the caption" 0 env STANCE_SCRIPTS=scripts "$stance" plot small.h5
expect "... of the map" 0 grep -rq "cut by the box at initial.offset.theta = -0.03 rad and 0.03 rad (both ends)" scripts/small-map
expect "weights of disturbances" 0 "$stance" basin line.h5 --json --weight initial.offset.theta=0.01
holds "... are the units of distances" 'b, one = said(), said("line.json")
assert b["weights"] == {"initial.offset.theta": 0.01}
for k in "nearest", "nearest_least", "median": assert abs(b["rows"][0][k] - 100 * one["rows"][0][k]) < 1e-9'
expect "a box without the equilibrium's domain" 0 "$stance" basin line.h5 --of fell \
    says 'none: the start nearest to the equilibrium is not fell'
for wrong in initial.offset.theta initial.offset.theta= initial.offset.theta=0 initial.offset.theta=nan initial.offset.q1=1; do
    expect "a weight that is none: $wrong" 2 "$stance" basin line.h5 --weight $wrong
done

expect "the boundary as points" 0 "$stance" basin whole.h5 --boundary holds <<'END'
rows, f = table(), h5py.File("whole.h5")
outcome = f["outcome"][...].astype(int)
assert len(rows) == (numpy.diff(outcome, axis=1) != 0).sum() + (numpy.diff(outcome, axis=2) != 0).sum()
axes = [f[n][...] for n in ("ground.friction", "initial.offset.theta", "initial.offset.vtheta")]
for r in rows:
    at = [float(r[n]) for n in list(r)[:3]]
    a = list(r).index(r["along"])
    for sign, word in ((-1, r["from"]), (1, r["to"])):
        end = list(at)
        end[a] += sign * float(r["half_width"])
        place = [numpy.abs(axes[k] - end[k]).argmin() for k in range(3)]
        assert all(abs(axes[k][place[k]] - end[k]) < 1e-12 for k in range(3))
        assert OUTCOMES[outcome[tuple(place)]] == word
END
expect "... pending cases" 0 "$stance" basin half1.h5 --of rested says 'not known to be cut by the box'
expect "... as text" 0 "$stance" basin whole.h5 says 'no alpha in some rows: fewer than 96 cases along an axis'
expect "an outcome of one's own" 0 "$stance" basin whole.h5 --of fell --level 0.99 --box 4
expect "an axis of starts as a parameter" 0 "$stance" basin whole.h5 --by initial.offset.vtheta
expect "nothing to measure" 2 "$stance" basin piece0.h5 --by initial.offset.theta \
    says 'no starts are varied (initial.offset'
expect "an axis that is none" 2 "$stance" basin whole.h5 --by friction
expect "an outcome that is none" 2 "$stance" basin whole.h5 --of stable

# Starts that are sampled: the share of a grid lies in the interval.
runs "a Sobol' sample of starts" sample "sweep={grid: [{path: ground.friction, values: [0.1, 0.2, 0.4]}],
    sample: {method: sobol, count: 1024, vary: $drawn}}"
expect "... has its basins" 0 "$stance" basin sample.h5 --json
"$stance" basin whole.h5 --json >grid.json 2>>log
holds "... with Wilson's interval, in which the grid's volume lies" <<'END'
sample, grid = said(), said("grid.json")
outcome = h5py.File("sample.h5")["outcome"][...]
assert sample["design"] == "sobol" and abs(sample["box"] - 0.216) < 1e-12
for k, (a, b) in enumerate(zip(sample["rows"], grid["rows"])):
    share = (outcome[k] == 1).mean()
    assert abs(a["share"] - share) < 1e-12 and a["at"] == b["at"] and a["alpha"] is None
    assert numpy.allclose([a["low"] / 0.216, a["high"] / 0.216], wilson(share, 1024), rtol=0, atol=1e-9)
    assert a["low"] < b["volume"] < a["high"] and a["low"] < a["volume"] < a["high"]
# The faces that they reach, of the last friction.
f = h5py.File("sample.h5")
near = min(numpy.hypot(f["initial.offset.theta"], f["initial.offset.vtheta"])[outcome[2] != 1])
assert abs(a["nearest"] - near) < 1e-12 and a["nearest_least"] == 0 and a["median"] is None, (a, near)
assert {c["path"] for c in a["cut"]} >= {"initial.offset.theta"} and a["bounded"] is None
END
expect "points on a boundary need a grid" 2 "$stance" basin sample.h5 --boundary

# A sample of parameters beside starts on a grid: points of a block share coordinates, blocks do not.
runs "basins over sampled parameters" over "sweep={grid: [$(box 9 8)], sample: {method: saltelli, count: 8,
    vary: [{path: ground.friction, from: 0.05, to: 1}, {path: controller.torque_limit, from: 5, to: 20}]}}"
"$stance" basin over.h5 --rank 5 --json >rank.json
expect "... are averaged and their error is the scatter of whole blocks" 0 "$stance" basin over.h5 --json holds <<'END'
found, f = said(), h5py.File("over.h5")
inside = (f["outcome"][...] == 1).astype(float)
assert inside.shape == (9, 8, 32) and 0.05 < inside.mean() < 0.95
volume = numpy.einsum("ijp,i,j->p", inside, cells(9), cells(8)) * 0.18 / 8 * 1.2 / 7
blocks = volume.reshape(8, 4).mean(1)
row, = found["rows"]
assert found["averaged"] == ["ground.friction", "controller.torque_limit"], found["averaged"]
assert abs(row["volume"] - volume.mean()) < 1e-12
scatter = 2.364624 * blocks.std(ddof=1) / 8 ** 0.5 # Student's deviations for 7
assert scatter <= row["reach"] < 1.2 * scatter, (row["reach"], scatter)
# The best of them, with their values, shares and bounds.
rows = said("rank.json")["rows"]
assert numpy.allclose([r["volume"] for r in rows], sorted(volume)[:-6:-1])
for r in rows:
    p = int(r["at"]["sample"])
    assert abs(volume[p] - r["volume"]) < 1e-12 and r["low"] <= r["volume"] <= r["high"] and r["reach"] > 0
    assert r["at"]["ground.friction"] == f["ground.friction"][p]
END
expect "... as text" 0 "$stance" basin over.h5 says 'averaged over ground.friction, controller.torque_limit'

# ---- single questions --------------------------------------------------------------------------
runs "where a share is lost" delay \
    "sweep.grid=[{path: controller.sample_time, values: [0.001, 0.02, 0.04, 0.06]}, $(box 37 31)]"
for form in --json --csv; do
    expect "... is told with $form" 0 "$stance" basin delay.h5 --threshold 0.8 --of controller.sample_time $form \
        into threshold$form
    expect "... of starts, with $form" 0 "$stance" basin delay.h5 --lost controller.sample_time $form into lost$form
    expect "... numbers, with $form" 0 "$stance" basin delay.h5 --answer settle_time $form into answer$form
done
"$stance" basin delay.h5 --json >delay.json
"$stance" basin delay.h5 --within settle_time=1.2 --json >within.json
holds "... as the cases say" <<'END'
f, basin = h5py.File("delay.h5"), said("delay.json")
inside, settle, times = f["outcome"][...] == 1, f["settle_time"][...], f["controller.sample_time"][...]
row, = said("threshold--json")["rows"]
v = numpy.array([r["volume"] for r in basin["rows"]])
i = numpy.argmax(v < 0.8 * v[0])
assert i > 0, v
at = numpy.interp(0.8 * v[0], [v[i], v[i - 1]], [times[i], times[i - 1]])
print(row, at)
assert abs(row["value"] - at) < 1e-6 and [row["before"], row["after"]] == list(times[i - 1:i + 1])
assert row["low"] < at and (row["high"] is None or at < row["high"])
one, = table("threshold--csv")
assert float(one["value"]) == row["value"]
lost = said("lost--json")
gone = numpy.array([(inside[0] & ~inside[:k + 1].all(axis=0)).sum() for k in range(4)])
assert lost["starts"] == inside[0].sum() and [r["lost_so_far"] for r in lost["rows"]] == list(gone)
k = numpy.argmax(gone > 0)
assert (lost["kept"], lost["lost"]) == (times[k - 1], times[k]) and lost["unknown"] == 0
where = numpy.unravel_index(lost["first"], inside.shape)
assert where[0] == k and inside[0][where[1:]] and not inside[where]
assert [int(r["lost"]) for r in table("lost--csv")] == list(numpy.diff(gone, prepend=0))
for k, r in enumerate(said("answer--json")["rows"]):
    number = settle[k][inside[k]]
    assert r["cases"] == len(number) and abs(r["median"] - numpy.median(number)) < 1e-12
    assert abs(r["q90"] - numpy.quantile(number, 0.9)) < 1e-12 and r["largest"] == number.max()
    assert settle.ravel()[r["largest_case"]] == r["largest"]
within = said("within.json")
assert within["within"] == "settle_time <= 1.2" and basin["within"] is None
for k, r in enumerate(within["rows"]):
    assert r["inside"] == (inside[k] & (settle[k] <= 1.2)).sum() < basin["rows"][k]["inside"]
END
expect "a threshold in words" 0 "$stance" basin delay.h5 --threshold 0.8 --of controller.sample_time \
    says 'falls below 80 % of what it is at controller.sample_time = 0.001 s'
expect "losses from the other end" 0 "$stance" basin delay.h5 --lost controller.sample_time=0.06 \
    says ' starts end as stabilised at controller.sample_time = 0.06 s'
expect "a threshold within a time" 0 "$stance" basin delay.h5 --threshold 0.8 --of controller.sample_time --within \
    settle_time=1.2 says 'stabilised with settle_time <= 1.2 falls below'
expect "the best of a sample, in words" 0 "$stance" basin over.h5 --rank 3 says 'the 3 largest of 32 sampled points'
while read -r wrong; do
    # shellcheck disable=SC2086
    expect "refused: $wrong" 2 "$stance" basin delay.h5 $wrong
done <<'END'
--threshold 0.8
--of controller.sample_time
--threshold 1 --of controller.sample_time
--threshold 0.8 --of initial.offset.theta
--threshold nan --of controller.sample_time
--lost controller.sample
--lost controller.sample_time=0.02
--lost controller.sample_time=
--rank 3
--rank 0
--answer sample_time
--within settle_time
--within settle_time=fast
--within speed=1
--answer outcome
--within fall_cause=1
--threshold 0.8 --of controller.sample_time --rank 3
--allowed --answer settle_time
--allowed --boundary
END
expect "what linear theory allows" 0 "$stance" basin delay.h5 --allowed --json holds <<'END'
for r in said()["rows"]:
    assert 0 < r["allowed"] <= 1 and 0 <= r["used"] <= 1 and 0 <= r["outside"] < 0.1, r
END
# Recoveries from outside, and what the robot did: gauges once more, by null_set.py.
outside() { # number, scenario, setting
    "$stance" run "$shipped/$2.yaml" --set controller.sample_time=0.002 --set method.step=0.002 \
        --set ground.friction=0.15 --set "$3" --set "sweep.grid=[$(starts -0.2 0.2 41 -1.2 1.2 41)]" --quiet -o "outside$1.h5" >>log2 2>&1
    expect "what recovers from outside, $1" 0 "$stance" basin "outside$1.h5" --allowed --json into "allowed$1.json"
}
outside 1 basin_one_foot record.cases=none
outside 2 basin_both_feet record.cases=none
outside 3 basin_one_foot 'record={cases: none, answers: [outcome, footfalls]}'
"$stance" design "$shipped/basin_one_foot.yaml" --json >design.json
holds "... is counted by what it did, with the farthest of each" <<'END'
design, seen = said("design.json"), set()
for n in 1, 2, 3:
    f, (row,) = h5py.File(f"outside{n}.h5"), said(f"allowed{n}.json")["rows"]
    x = numpy.zeros((41, 41, 6))
    x[..., 0] += f["initial.offset.theta"][...][:, None]
    x[..., 3] += f["initial.offset.vtheta"][...]
    gauge = null_set.gauge(design, 10, x.reshape(-1, 6))
    assert abs(gauge - 1).min() > 3e-4 # none is in doubt
    saved = (f["outcome"][...] == 1).ravel()
    out = saved & (gauge > 1)
    assert row["starts"] == 1681 and abs(row["allowed"] - (gauge < 1).mean()) < 1e-12, row
    assert abs(row["used"] - saved[gauge < 1].mean()) < 1e-12 and abs(row["outside"] - out.mean()) < 1e-12, row
    slip = f["slip_distance"][...].ravel() if n < 3 else numpy.full(1681, numpy.nan)
    lifted = f["footfalls"][...].ravel() > 0
    if n < 3:
        lifted |= f["least_normal_force"][...].ravel() == 0
    of = {"lifted": lifted, "slipped": ~lifted & (slip > 1e-6), "unknown": ~lifted & numpy.isnan(slip)}
    of["neither"] = ~(of["lifted"] | of["slipped"] | of["unknown"])
    for name, which in of.items():
        here, told = numpy.flatnonzero(out & which), row[name]
        assert told["starts"] == len(here), (n, name, told, len(here))
        if len(here):
            seen.add(name)
            farthest = here[gauge[here].argmax()]
            assert told["case"] == farthest and abs(told["farthest"] - gauge[farthest]) < 1e-3, (name, told)
        else:
            assert told["farthest"] is None and told["case"] is None
assert seen >= {"lifted", "slipped", "unknown"}, seen
END
expect "... in words" 0 "$stance" basin outside1.h5 --allowed says '^ *slipped  *farthest  *case$'
# What no torque moves is allowed nowhere but where there is nothing of it: a cart without a motor keeps the momentum,
# and the place, of its centre of mass. Moved by 1/6 of the pole's angle it has moved that back: m l / (M + m).
cat >drift.yaml <<'END'
stance: 1
scene: mechanism
robot:
  bodies:
    cart: {joint: slide, axis: [1, 0], mass: 1}
    pole: {joint: hinge, parent: cart, mass: 0.5, inertia: 0.02, centre: [0, 0.5]}
  actuators: {m: {body: pole, limit: 5}}
initial: {equilibrium: {}}
controller: {kind: state-feedback, design: gains, gains: [[0, 20, 0, 3]], sample_time: 0.005}
stop: {time: 0.05}
sweep:
  grid:
    - {paths: [initial.offset.pole, initial.offset.cart], values: [[0, 0], [0.3, 0.05], [0.3, 0], [3, 0.5]]}
    - {path: initial.offset.vcart, values: [-0.001, 0, 0.001]}
END
expect "a cart that no motor moves" 0 "$stance" run drift.yaml --quiet -o drift.h5
expect "... has no reach along any state" 0 "$stance" design drift.yaml --json holds <<'END'
a = said()["allowed"]
assert a["unreached_modes"] == [[0, 0], [0, 0]] and not a["glued"] and len(a["unstable_modes"]) == 1, a
assert set(a["low"].values()) == set(a["high"].values()) == {0} and len(a["low"]) == 4, a
END
expect "... and is allowed where it is at rest and in the middle, and the motor is strong enough" 0 \
    "$stance" basin drift.h5 --allowed --json holds 'row, = said()["rows"]
assert row["allowed"] == 2 / 12 and row["unreached"] == 2 and not row["glued"], row'
expect "... in words" 0 "$stance" basin drift.h5 --allowed \
    says '^(no torque moves some modes that do not decay: starts with a part in them are not allowed)$'
# Of several contacts that carry the bound does not know which tips.
sed -n '/^    # own.yaml/,/^$/s/^    //p' "$tests/../README.md" >own.yaml
expect "a robot on a sole" 0 "$stance" run own.yaml --quiet -o sole.h5 --set stop.time=0.02 \
    --set 'sweep.grid=[{path: initial.offset.body, from: -0.3, to: 0.3, count: 5}]'
expect "... as if glued" 0 "$stance" basin sole.h5 --allowed \
    says '^(contacts as if glued: the bound does not know where their centre of pressure may be)$'
expect "... to programs" 0 "$stance" basin sole.h5 --allowed --json says '"glued": true'
expect "... and by design" 0 "$stance" design own.yaml \
    says '^  (contacts as if glued: the bound does not know where their centre of pressure may be)$'

# What one domain has lost of another: labels side by side.
for form in --json --csv; do
    expect "two domains side by side, with $form" 1 "$stance" compare f0.1.h5 f0.4.h5 --labels $form into labels$form
done
expect "... of an outcome of one's own" 1 "$stance" compare f0.1.h5 f0.4.h5 --labels --of fell --json holds <<'END'
a, b = (h5py.File(n)["outcome"][...] for n in ("f0.1.h5", "f0.4.h5"))
words, found, rows = OUTCOMES, said("labels--json"), table("labels--csv")
count = {(words[i], words[j]): int(((a == i) & (b == j)).sum()) for i in range(1, 5) for j in range(1, 5)}
assert {(r["first"], r["second"]): r["cases"] for r in found["became"]} == {k: n for k, n in count.items() if n}
assert {(r["first"], r["second"]): int(r["cases"]) for r in rows} == {k: n for k, n in count.items() if n}
for r in found["became"]:
    assert abs(r["share"] - r["cases"] / a.size) < 1e-12
    assert abs(r["share_of_first"] - r["cases"] / sum(n for k, n in count.items() if k[0] == r["first"])) < 1e-12
for d, of in ((found["domain"], 1), (said()["domain"], 2)):
    kept, lost, won = ((a == of) & (b == of)).sum(), ((a == of) & (b != of)).sum(), ((a != of) & (b == of)).sum()
    assert (d["outcome"], d["kept"], d["lost"], d["won"]) == (words[of], kept, lost, won)
    assert d["neither"] == a.size - kept - lost - won and d["lost_low"] is None
    assert abs(d["lost_share"] - lost / (kept + lost)) < 1e-12 and abs(d["won_share"] - won / (kept + won)) < 1e-12
assert found["domain"]["lost"] > 0
END
expect "... in words" 1 "$stance" compare f0.1.h5 f0.4.h5 --labels \
    says 'stabilised in both: .*; lost, in f0.1.h5 alone: .* % of its domain);$'
for limit in 9 11; do
    runs "drawn$limit" drawn$limit controller.torque_limit=$limit \
        "sweep={sample: {method: random, count: 500, vary: $drawn}}"
done
expect "domains of a sample" 1 "$stance" compare drawn11.h5 drawn9.h5 --labels --json holds <<'END'
a, b = (h5py.File(n)["outcome"][...] == 1 for n in ("drawn11.h5", "drawn9.h5"))
d, share = said()["domain"], (a & ~b).sum() / a.sum()
assert 0 < share < 1
assert numpy.allclose([d["lost_low"], d["lost_high"]], wilson(share, a.sum()), rtol=0, atol=1e-9)
END
expect "domains over other starts" 2 "$stance" compare small.h5 line.h5 --labels
runs "wider" wider "sweep={grid: [${small//0.03/0.04}]}"
expect "... at other places" 2 "$stance" compare small.h5 wider.h5 --labels \
    says 'the starts of small.h5 and wider.h5 are not the same'

# ---- rays ------------------------------------------------------------------------------------
rays() { # least, largest scale, how many, how many rays
    echo "sweep={grid: [{path: ground.friction, values: [0.2, 0.4]},
        {path: initial.offset.scale, from: $1, to: $2, count: $3}], sample: {method: sphere, count: $4,
        vary: [{path: initial.offset.theta, from: -0.1, to: 0.1}, {path: initial.offset.vtheta, from: -0.5, to: 0.5}]}}"
}
rays=$(rays 0.02 1 50 24)
runs "rays from the equilibrium" rays "$rays"
expect "where they lose the outcome" 0 "$stance" basin rays.h5 --boundary into rays.csv
expect "... in short as the cases say" 0 "$stance" basin rays.h5 --json holds <<'END'
f, rows, short = h5py.File("rays.h5"), table("rays.csv"), said()
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
# Descents end no farther than the shortest ray, on the boundary, where dense rays about it end.
expect "descents from the shortest ray" 0 "$stance" basin rays.h5 --json --descend 5 into nearest.json
holds "... are told with how sure they are" <<'END'
for k, r in enumerate(said("nearest.json")["rows"]):
    n = r["nearest"]
    print(n)
    low, high = n["bracket"]
    assert low < n["scale"] < high <= low * 1.0002 and n["scale"] <= r["first_bracket"][1] and n["failed"] == 0
    assert abs(sum(x * x for x in n["of_ranges"].values()) ** 0.5 - n["scale"]) < 1e-9
    assert n["at"]["initial.offset.theta"] == 0.1 * n["of_ranges"]["initial.offset.theta"]
    assert n["starts"] == 5 and 1 <= n["agree"] <= 5 and abs(n["unseen"] - (1 - 0.05 ** 0.25)) < 1e-9
    theta, vtheta = n["at"].values()
    print(f"sweep={{grid: [{{path: initial.offset.scale, values: [{low / n['scale']}, {high / n['scale']}]}}]}}",
          f"initial.offset.theta={theta}", f"initial.offset.vtheta={vtheta}",
          f"ground.friction={r['at']['ground.friction']}", sep="\n", file=open(f"end{k}.sets", "w"))
END
for k in 0 1; do
    mapfile -t sets <end$k.sets
    runs "end$k" end$k "${sets[@]}"
    expect "... and cases of their own end so" 0 "$stance" table end$k.h5 --answer outcome \
        says '^0,.*,stabilised' '^1,.*,fell'
done
runs "dense" dense "$(rays 0.1 0.3 401 256)" 'sweep.refine={start: 16}'
"$stance" basin dense.h5 --json >dense.json 2>>log2
holds "... near the shortest of many rays" 'for a, b in zip(said("nearest.json")["rows"], said("dense.json")["rows"]):
    print(a["nearest"]["scale"], b["smallest"])
    assert -0.002 * b["smallest"] < b["smallest"] - a["nearest"]["scale"] < 0.02 * b["smallest"]'
runs "ray" ray "$rays" 'sweep.grid[0].values=[0.2]'
expect "... in words" 0 "$stance" basin ray.h5 --descend 3 says 'initial.offset.theta .* of half its range'
expect "... and without" 0 "$stance" basin ray.h5 says 'an upper bound; --descend 8'
expect "a file without rays" 2 "$stance" basin whole.h5 --descend 3
expect "no descents" 2 "$stance" basin rays.h5 --descend 0
expect "pictures of rays" 0 "$stance" plot rays.h5 says '^rays-rays.png$'
expect "--by has no meaning for rays" 2 "$stance" basin rays.h5 --by ground.friction
for wrong in "--weight initial.offset.theta=1" "--rank 3" "--threshold 0.8 --of ground.friction" "--answer end_time"; do
    # shellcheck disable=SC2086
    expect "... nor has $wrong" 2 "$stance" basin rays.h5 $wrong says '^stance basin: rays have no use for --'
done
expect "pictures of basins" 0 "$stance" plot whole.h5
runs "a refined map" inferred "sweep={grid: [$(box 33 33)], refine: {start: 8}}"
expect "what it has inferred" 0 "$stance" table inferred.h5 --answer evidence --answer steps holds 'rows = table()
assert {(r["evidence"], bool(r["steps"])) for r in rows} == {("inferred", False), ("simulated", True)}'
expect "rays as a table" 0 "$stance" table rays.h5 --answer outcome --of fell holds 'rows = table()
assert list(rows[0])[1:6] == ["ground.friction", "initial.offset.scale", "sample", "initial.offset.theta", "initial.offset.vtheta"]'
runs "samples of parts are merged" ray2 "$rays" 'sweep.grid[0].values=[0.2]'
runs "... the second part" ray4 "$rays" 'sweep.grid[0].values=[0.4]'
expect "... into the whole" 0 "$stance" merge raysm.h5 ray2.h5 ray4.h5 as rays.h5
