#!/usr/bin/env bash
# Samples from outside: the points that other programs read, the same file whatever the ranks, kills
# and resumes, larger designs from smaller ones, and what the other commands make of them.
# about: runner/run analysis/compare analysis/sensitivity
. "$(dirname "$0")/scratch.sh"
points=150
[ -n "${STANCE_SLOW:-}" ] && points=130

# Torque noise, a grid beside the sample, factors of every kind, designs of their own, trajectories.
cat >set.yaml <<END
stance: 1
scene: biped
ground: {contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, offset: {theta: 0.02}}
controller: {kind: state-feedback, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], sample_time: 0.01,
             noise: 0.3}
method: {name: midpoint, step: 0.005}
stop: {time: 2}
sweep:
  grid:
    - {path: initial.offset.vtheta, from: -0.2, to: 0.2, count: 3}
  sample:
    method: sobol
    count: $points
    vary:
      - {path: ground.friction, from: 0.1, to: 1, spacing: log}
      - {path: controller.delay, from: 0, to: 1}
      - {path: controller.design, values: [place, lqr]}
      - {paths: [controller.model.trunk_mass, controller.model.hip_mass], from: [1.5, 6.3], to: [2.1, 4.5]}
      - {path: controller.torque_limit, values: [8, 20, 40]}
record: {every: 0.1, cases: [0, 5, 201, 350]}
seed: 11
END
more=$((2 * points + 41))

# ---- the points --------------------------------------------------------------------------------
expect "run" 0 "$stance" run set.yaml -o one.h5 --quiet
holds "h5py and xarray read the sampled values as coordinates, and they are as asked for" <<END
f = h5py.File("one.h5")
n = $points
assert f["outcome"].shape == (3, n) and f.attrs["axes"] in (b"initial.offset.vtheta,sample", "initial.offset.vtheta,sample")
assert (f["sample"][...] == numpy.arange(n)).all()
a = f["sample"].attrs
assert a["method"] in (b"sobol", "sobol") and a["count"] == n and a["factors"] == 5 and a["block"] == 1
mu = f["ground.friction"][...]
# Equal parts of the logarithm hold equally many points, but for what is left over of a power of two.
parts = numpy.histogram(numpy.log10(mu), bins=4, range=(-1, 0))[0]
assert parts.sum() == n and abs(parts - n / 4).max() <= 4, parts
for name, values in ("controller.delay", (0, 1)), ("controller.design", (0, 2)), ("controller.torque_limit", (8, 20, 40)):
    v = f[name][...]
    assert set(v) == set(values) and all(abs((v == w).sum() - n / len(values)) <= 4 for w in values), name
trunk, hip = f["controller.model.trunk_mass"][...], f["controller.model.hip_mass"][...]
assert numpy.allclose((trunk - 1.5) / 0.6, (6.3 - hip) / 1.8) and trunk.min() < 1.51 and trunk.max() > 2.09
assert f["controller.design"].attrs["flag_meanings"].split()[:2] in ([b"place", b"place-schur"], ["place", "place-schur"])
assert f["design/gain"].shape[0] == n and (f["design/status"][...] == 1).all()
d = xarray.open_dataset("one.h5")
assert d["ground.friction"].dims == ("sample",) and "ground.friction" in d.coords
assert d.outcome.dims == ("initial.offset.vtheta", "sample") and len(numpy.unique(d.outcome)) >= 2
END
expect "netCDF's reader opens it" 0 ncdump -h one.h5

for method in random lhs saltelli morris; do
    expect "$method: run" 0 "$stance" run set.yaml --set sweep.sample.method=$method \
        --set sweep.sample.count=20 --set record.cases=none -o $method.h5 --quiet
done
expect "saltelli, second order: run" 0 "$stance" run set.yaml --set sweep.sample.method=saltelli \
    --set sweep.sample.count=7 --set sweep.sample.second_order=true --set record.cases=none -o second.h5 --quiet
holds "blocks of Saltelli and Morris, strata of a Latin hypercube" <<'END'
def points(name):
    f = h5py.File(name)
    return f, numpy.array([f[p][...] for p in ("ground.friction", "controller.model.trunk_mass")])
f, x = points("saltelli.h5")
assert f["sample"].attrs["block"] == 7 and x.shape[1] == 140
for block in x.T.reshape(20, 7, 2):
    A, B = block[0], block[-1]
    assert (block[1] == (B[0], A[1])).all() and (block[4] == (A[0], B[1])).all()  # factors 0 and 3
    assert (block[[2, 3, 5]] == A).all()
f, x = points("second.h5")
assert f["sample"].attrs["second_order"] == 1 and f["sample"].attrs["block"] == 12
for block in x.T.reshape(7, 12, 2):
    A, B = block[0], block[-1]
    assert (block[1] == (B[0], A[1])).all() and (block[6] == (A[0], B[1])).all()
f, x = points("morris.h5")
assert f["sample"].attrs["block"] == 6 and f["sample"].attrs["levels"] == 4 and x.shape[1] == 120
f, x = points("lhs.h5")
assert sorted((20 * (numpy.log10(x[0]) + 1)).astype(int)) == list(range(20))
END

# ---- the same file -----------------------------------------------------------------------------
for ranks in 2 3; do
    expect "run on $ranks ranks" 0 mpirun -n $ranks "$stance" run set.yaml -o ranks.h5 --quiet --force as one.h5
done
"$stance" run set.yaml -o killed.h5 --quiet --force --set sweep.sample.count=$((10 * points)) 2>/dev/null &
job=$!
await $job computing killed.h5
kill -9 $job 2>/dev/null
wait $job 2>/dev/null
expect "a killed run is resumed" 0 "$stance" run set.yaml -o killed.h5 --quiet --resume \
    --set sweep.sample.count=$((10 * points))
expect "... on two ranks from the beginning" 0 mpirun -n 2 "$stance" run set.yaml -o long.h5 --quiet \
    --set sweep.sample.count=$((10 * points)) as killed.h5
expect "a single case, with its values" 0 "$stance" run set.yaml --only 201 --trace -o case.h5 --quiet
holds "... is that of the sweep" <<END
one, case = h5py.File("one.h5"), h5py.File("case.h5")
for p in "ground.friction", "controller.torque_limit", "controller.design":
    assert case[p].shape == (1,) and case[p][0] == one[p][201 % $points]
assert (case["final_state"][0] == one["final_state"][...].reshape(-1, 10)[201]).all()
assert numpy.array_equal(case["trajectory/position"][0], one["trajectory/position"][2], True)
END

# ---- larger designs ----------------------------------------------------------------------------
expect "from scratch" 0 "$stance" run set.yaml -o scratch.h5 --quiet --set sweep.sample.count=$more
cp one.h5 before.h5
expect "extend" 0 "$stance" run set.yaml --extend $more --from one.h5 -o more.h5 \
    says "; $((3 * (more - points) + 1)) of them computed now;" as scratch.h5
expect "... and left the old file as it was" 0 cmp one.h5 before.h5
expect "extend on three ranks" 0 mpirun -n 3 "$stance" run set.yaml --extend $more --from one.h5 -o three.h5 --quiet \
    as scratch.h5
expect "the new file is an ordinary one" 0 "$stance" run set.yaml --set sweep.sample.count=$more -o more.h5 --resume \
    says "; 0 of them computed now;"
expect "twice extended" 0 "$stance" run set.yaml --extend $((more + 9)) --from more.h5 -o twice.h5 --quiet
expect "... is once extended" 0 "$stance" run set.yaml --extend $((more + 9)) --from one.h5 -o once.h5 --quiet \
    as twice.h5

mkdir -p results && cp one.h5 results/set.h5
expect "by default the scenario's file" 0 "$stance" run set.yaml --extend $more --quiet
expect "... into one named after the count" 0 "$stance" compare results/set-$more.h5 scratch.h5

holds "ten cases pending, one damaged" <<END
with h5py.File("one.h5", "r+") as f:
    f["end_time"][1, 3] += 1e-9      # does not verify any more
    f["status"][2, 10:20] = 0        # pending
END
expect "extend what is neither complete nor whole" 0 "$stance" run set.yaml --extend $more --from one.h5 -o mended.h5 \
    says "one.h5: 1 case is not as the checksum says: computed again" as scratch.h5

for method in random saltelli morris; do
    expect "$method: extend" 0 "$stance" run set.yaml --set sweep.sample.method=$method --extend 31 \
        --set record.cases=none --from $method.h5 -o $method-31.h5 --quiet
    expect "$method: from scratch" 0 "$stance" run set.yaml --set sweep.sample.method=$method --set record.cases=none \
        --set sweep.sample.count=31 -o $method-scratch.h5 --quiet as $method-31.h5
done

# ---- what is refused ---------------------------------------------------------------------------
expect "extend lhs" 2 "$stance" run set.yaml --set sweep.sample.method=lhs --extend 31 --from lhs.h5 -o no.h5 \
    says "--extend: points of method lhs depend on their number"
expect "extend to fewer" 2 "$stance" run set.yaml --extend $points --from before.h5 -o no.h5 \
    says "--extend $points: before.h5 has sweep.sample.count $points already"
expect "extend another scenario" 2 "$stance" run set.yaml --extend $more --from before.h5 -o no.h5 --set seed=12 \
    says "before.h5 was made from another scenario; 1 value of the resolved text differs"
expect "extend into itself" 2 "$stance" run set.yaml --extend $more --from before.h5 -o ./before.h5 --force \
    says "-o and --from must differ"
expect "extend what is not there" 3 "$stance" run set.yaml --extend $more --from nowhere.h5 -o no.h5
expect "extend what is no sample" 2 "$stance" run "$shipped/drop.yaml" --extend $more -o no.h5 \
    says "the scenario has no sweep.sample"
head -c 100000 before.h5 >short.h5
expect "extend what is cut off" 3 "$stance" run set.yaml --extend $more --from short.h5 -o no.h5
expect "extend by nonsense" 2 "$stance" run set.yaml --extend -3 --from before.h5 -o no.h5
expect "--from alone" 2 "$stance" run set.yaml --from before.h5 -o no.h5
expect "extend one case" 2 "$stance" run set.yaml --extend $more --only 3 -o no.h5

# Files from before the points of Sobol' sequences were scrambled do not name what made them; of other
# methods the points are what they were, and there is no name.
holds "files of the former points" <<'END'
shutil.copy("before.h5", "former.h5")
with h5py.File("former.h5", "r+") as f:
    assert f["sample"].attrs["generator"] in (b"joe-kuo-scrambled", "joe-kuo-scrambled")
    del f["sample"].attrs["generator"]
    f["status"][2, 10:20] = 0
shutil.copy("saltelli.h5", "former-saltelli.h5")
with h5py.File("former-saltelli.h5", "r+") as f:
    del f["sample"].attrs["generator"]
for name in "random", "lhs", "morris":
    assert "generator" not in h5py.File(name + ".h5")["sample"].attrs
END
other="former.h5: the points of its sample are those of another version"
refused() { # name, command ...
    expect "$1" 2 "${@:2}"
    is "... in one line" '[ "$(grep -c stance log)" = 1 ] # mpirun has its own lines'
    says "... with the reason" "$other"
}
cp former.h5 kept.h5
refused "resume one of them" "$stance" run set.yaml -o former.h5 --resume
refused "... on two ranks" mpirun -n 2 "$stance" run set.yaml -o former.h5 --resume
refused "... with another scenario" "$stance" run set.yaml -o former.h5 --resume --force-scenario --set stop.time=3
refused "extend one of them" "$stance" run set.yaml --extend $more --from former.h5 -o no.h5
refused "merge one of them" "$stance" merge no.h5 before.h5 former.h5
refused "merge one of them, the first" "$stance" merge no.h5 former.h5 before.h5 is cmp former.h5 kept.h5
expect "the indices of one of them" 2 "$stance" sensitivity former-saltelli.h5 \
    says "former-saltelli.h5: has points of another version"
for command in summary status table plot "compare kept.h5"; do
    # shellcheck disable=SC2086
    expect "${command% *} reads one of them" 0 "$stance" $command former.h5
done
expect "plot of their blocks" 0 "$stance" plot former-saltelli.h5
for method in random morris; do
    expect "$method: goes on as ever" 0 "$stance" run set.yaml --set sweep.sample.method=$method --resume \
        --set record.cases=none --set sweep.sample.count=31 -o $method-31.h5 --quiet
done
is "no file came of all that" [ ! -e no.h5 ]

# ---- rays --------------------------------------------------------------------------------------
rays=(--set 'sweep.grid[0].count=65' --set sweep.sample.count=40)
expect "topple: run" 0 "$stance" run "$shipped/topple.yaml" "${rays[@]}" -o rays.h5 --quiet
expect "topple: every case simulated" 0 "$stance" run "$shipped/topple.yaml" "${rays[@]}" -o all.h5 --quiet \
    --set 'sweep.refine={start: 16, margin: 64, probes: 1}'
holds "topple: refined as simulated in full, directions on the ellipsoid, the nearest end" <<'END'
refined, full = h5py.File("rays.h5"), h5py.File("all.h5")
assert (full["evidence"][...] == 1).all() and (refined["evidence"][...] == 2).mean() > 0.5
# Bisection finds the first change of every ray that has but one; islands are few here.
assert (refined["outcome"][...] == full["outcome"][...]).mean() > 0.995
assert (full["outcome"][0] == 1).all(), "the equilibrium itself"
# On the ellipsoid, and as the rays of the scenario without the grid's scale.
half = dict(theta=0.2, q1=0.2, q2=0.2, vtheta=0.6, vq1=0.6, vq2=0.6)
square = sum((full["initial.offset." + k][...] / v) ** 2 for k, v in half.items())
assert numpy.allclose(square, 1, atol=1e-12)
ends = [next(i for i, o in enumerate(list(ray) + [2]) if o != 1) for ray in full["outcome"][...].T]
out = subprocess.run([os.environ["STANCE"], "summary", "--json", "all.h5"], check=True, capture_output=True)
rays = json.loads(out.stdout)["sample"]["rays"]
assert rays["points"] == 40 and rays["unknown"] == 0 and rays["reach_end"] == ends.count(65)
assert abs(rays["smallest"] - (min(ends) - 0.5) / 64) < 1e-12 and ends[rays["nearest"]] == min(ends)
k = rays["nearest"]
for name, value in rays["at"].items():
    assert abs(value - rays["smallest"] * full[name][k]) < 1e-15
END
expect "topple: extend" 0 "$stance" run "$shipped/topple.yaml" --set 'sweep.grid[0].count=65' --extend 70 \
    --set sweep.sample.count=40 --from rays.h5 -o rays-70.h5
expect "topple: from scratch" 0 mpirun -n 2 "$stance" run "$shipped/topple.yaml" "${rays[@]}" \
    --set sweep.sample.count=70 -o rays-scratch.h5 --quiet as rays-70.h5

# ---- other commands ----------------------------------------------------------------------------
expect "check" 0 "$stance" check set.yaml says "sample  *$points  points, sobol: 5 factors"
expect "check --json" 0 sh -c "'$stance' check --json set.yaml | '$python' -c '
import json, sys
s = json.load(sys.stdin)[\"sample\"]
assert s[\"method\"] == \"sobol\" and s[\"points\"] == $points and len(s[\"factors\"]) == 5
assert s[\"factors\"][3][\"paths\"] == [\"controller.model.trunk_mass\", \"controller.model.hip_mass\"]'"
expect "summary" 0 "$stance" summary before.h5 says "^  controller.design  *place  *[0-9]*  *[0-9.]* %"
expect "summary --json: parts add up" 0 sh -c "'$stance' summary --json before.h5 | '$python' -c '
import json, sys
s = json.load(sys.stdin)
total, stabilised = s[\"cases\"][\"done\"], s[\"outcomes\"][\"stabilised\"][\"count\"]
for v in s[\"sample\"][\"varied\"]:
    assert sum(p[\"done\"] for p in v[\"parts\"]) == total
    assert round(sum(p[\"done\"] * p[\"share\"] for p in v[\"parts\"])) == stabilised
    assert all(p[\"low\"] <= p[\"share\"] <= p[\"high\"] for p in v[\"parts\"])'"
expect "status" 0 "$stance" status before.h5
expect "plot" 0 "$stance" plot before.h5 -o pictures is '[ "$(stat -c %s pictures/before-sample.png)" -gt 5000 ]'
expect "plot of one case" 0 "$stance" plot case.h5 -o pictures
expect "compare with another seed" 1 "$stance" compare before.h5 lhs.h5
