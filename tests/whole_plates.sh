#!/usr/bin/env bash
# Ground in plates, as a user meets it: what is read, refused, warned of, documented; results files that hold it; pictures
# and pages that draw it; steps that are enough to walk.
# about: runner/scenario runner/run analysis/plot analysis/summary
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache
walks=$shipped/gaits/walks.yaml

# ---- what is read ----------------------------------------------------------------------------------
plates='ground.plates={step: {from: 0.3, height: -0.03}, up: {from: 0.6}, stairs: {kind: stairs, from: 1, width: 0.1,
    height: 0.02, count: 4}, field: {kind: rough, from: 1.8, width: 0.05, height: 0.02}, late: {footfall: 3, from: 0.15}}'
alone=(--set 'sweep={}' --set "$plates")
expect "a scene that is carried has plates" 0 "$stance" check "$walks" "${alone[@]}" is ! grep -q warning log
expect "documented by any name" 0 "$stance" describe ground.plates.step.width tells '^ground.plates.PLATE.width$'
expect "and by its own" 0 "$stance" describe --of "$walks" ground.plates tells 'Keys: PLATE'
cat >rod.yaml <<'END'
stance: 1
scene: rod
ground: {plates: {step: {from: 1, height: -0.1}, stairs: {kind: stairs, from: 2, width: 0.3, height: 0.1}}}
initial: {state: {z: 1}}
stop: {time: 0.2}
END
expect "those of a scenario" 0 "$stance" describe --of rod.yaml ground.plates tells 'Keys: step, stairs'
holds "editors know them by the JSON Schema" - "$stance" <<'END'
try:
    import jsonschema, yaml
except ImportError:
    raise SystemExit(0)
schema = json.loads(subprocess.run([sys.argv[1], "describe", "--schema"], capture_output=True, check=True).stdout)
scenario = yaml.safe_load(open("rod.yaml"))
jsonschema.validate(scenario, schema)
for bad in {"kind": "stair"}, {"footfall": 1.5}, {"widht": 1}, {"friction_factor": 0}:
    scenario["ground"]["plates"]["step"] = {"from": 1} | bad
    try:
        jsonschema.validate(scenario, schema)
    except jsonschema.ValidationError:
        continue
    raise AssertionError(bad)
END

# ---- what is refused, and what is warned of --------------------------------------------------------
printf 'stance: 1\nscene: ball\ninitial: {state: {}}\nstop: {time: 0.1}\nground: {plates: {step: {from: 1}}}\n' >ball.yaml
expect "what is round is refused" 2 "$stance" check ball.yaml tells 'bottom is round and would turn about their edges'
expect "a point is not" 0 "$stance" check ball.yaml --set robot.radius=0
cat >wheel.yaml <<'END'
stance: 1
scene: mechanism
robot:
  bodies: {trunk: {joint: free, mass: 1, inertia: 0.1}}
  contacts: {wheel: {body: trunk, radius: 0.2, at: [0, 0]}, foot: {body: trunk, at: [0.1, -0.3]}}
ground: {plates: {step: {from: 1, height: -0.1}}, contacts: [foot]}
initial: {state: {z: 1}}
stop: {time: 0.1}
END
expect "nor what may not touch the ground" 0 "$stance" check wheel.yaml
expect "or else it is" 2 "$stance" check wheel.yaml --set 'ground.contacts=[wheel, foot]'
expect "at the end of an axis, too" 2 "$stance" check rod.yaml \
    --set 'sweep.grid=[{path: ground.plates.step.from, from: 0, to: 2, count: 3}]' \
    tells 'with ground.plates.step.from = 2 ground.plates.stairs.from: 2 m is not beyond step'
printf 'stance: 1\nscene: rod\nground: {plates: {a: {from: 1, height: -0.1}, b: {from: 2, height: 0.1}}}\n' >two.yaml
printf 'initial: {state: {z: 1}}\nstop: {time: 0.2}\n' >>two.yaml
a='path: ground.plates.a.from' b='path: ground.plates.b.from'
expect "where two axes meet, too" 2 "$stance" check two.yaml \
    --set "sweep.grid=[{$a, values: [0, 1.5]}, {$b, values: [3, 1]}]" \
    tells 'with ground.plates.a.from = 1.5 and ground.plates.b.from = 1 ground.plates.b.from: 1 m is not beyond a'
expect "by --of as well" 2 "$stance" critical two.yaml --set "sweep={grid: [{$b, values: [3, 1.5]}]}" \
    --of ground.plates.a.from=-1..2 -o two.h5
expect "and within an axis" 2 "$stance" check two.yaml \
    --set 'sweep.grid=[{paths: [ground.plates.a.from, ground.plates.b.from], values: [[0, 1], [2, 1.9], [3, 4]]}]' \
    tells 'with ground.plates.a.from = 2 and ground.plates.b.from = 1.9'
expect "axes that keep the order" 0 "$stance" check two.yaml \
    --set "sweep.grid=[{$a, values: [0, 1.5]}, {$b, values: [3, 1.6]}]"
expect "and one along which they move together" 0 "$stance" check two.yaml \
    --set 'sweep.grid=[{paths: [ground.plates.a.from, ground.plates.b.from], values: [[0, 1], [2, 3], [3, 4]]}]'
expect "whole numbers are asked of axes" 2 "$stance" check rod.yaml \
    --set 'sweep.grid=[{path: ground.plates.stairs.count, from: 1, to: 2, count: 3}]' \
    tells 'values that are not whole numbers'
expect "a design varies them" 0 "$stance" check rod.yaml \
    --set 'sweep.sample={method: sobol, count: 8, vary: [{path: ground.plates.stairs.count, from: 1, to: 4}]}'
expect "a search does not" 2 "$stance" check "$walks" --set "$plates" --set 'sweep={}' \
    --set 'optimise={vary: [{path: ground.plates.stairs.count}]}' tells 'takes whole numbers'
expect "a start above a plate" 0 "$stance" check "$walks" --set 'sweep={}' --set 'ground.plates={low: {from: -0.1, height: -0.05}}'
tells "... is warned of" 'warning: foot1 begins at height 0, 0.05 m above the plate that is there'
expect "one inside a plate is refused" 2 "$stance" check "$walks" --set 'sweep={}' \
    --set 'ground.plates={high: {from: -0.1, height: 0.05}}' tells 'foot1 would start 0.05 m inside the ground'
printf 'stance: 1\nscene: block\nrobot: {mass: 1}\ninitial: {state: {x: 0}}\nstop: {time: 0.1}\n' >block.yaml
printf 'ground: {plates: {a: {kind: rough, from: -1, height: 0.05, width: 0.1}}}\n' >>block.yaml
printf 'sweep: {sample: {method: random, count: 10, vary: [{path: robot.mass, from: 1, to: 2}]}}\n' >>block.yaml
for seed in 1 3; do
    expect "at any point of a sample, on its own ground, seed $seed" 2 "$stance" run block.yaml --set seed=$seed \
        -o block.h5 tells 'case [0-9]: .* would start 0.0[0-9]* m inside the ground'
done
expect "ground that begins beyond it is of no start" 0 "$stance" check block.yaml --set ground.plates.a.from=2
expect "a gait has no cycle there" 2 "$stance" gait "$walks" "${alone[@]}" tells 'leave out ground.plates'
expect "what is exported has none" 0 "$stance" export --mjcf rod.yaml -o rod.xml \
    tells 'ground.plates are left out' is grep -q 'Without ground.plates' rod.xml

# ---- results files ---------------------------------------------------------------------------------
grid='sweep={grid: [{path: ground.plates.step.height, from: -0.05, to: 0.05, count: 5}, {path: ground.friction, values: [0.4, 0.8]}]}'
expect "a study of heights" 0 "$stance" run "$walks" --set "$plates" --set "$grid" --set stop.time=0.5 -o heights.h5
expect "is gone on with" 0 "$stance" run "$walks" --set "$plates" --set "$grid" --set stop.time=0.5 -o heights.h5 --resume
expect "which other plates are not" 2 "$stance" run "$walks" --set "$plates" --set "$grid" \
    --set ground.plates.step.from=0.2 --set stop.time=0.5 -o heights.h5 --resume \
    tells 'ground.plates.step.from: 0.3, now 0.2'
holds "the file holds them in their order, and the axis" <<'END'
f = h5py.File("heights.h5")
text = f["scenario"][()] if "scenario" in f else f.attrs["scenario"]
plates = yaml.safe_load(text.decode() if isinstance(text, bytes) else text)["ground"]["plates"]
assert list(plates) == ["step", "up", "stairs", "field", "late"], plates
assert plates["stairs"]["kind"] == "stairs" and plates["late"]["footfall"] == 3, plates
axis = f["ground.plates.step.height"]
assert abs(axis[0] + 0.05) < 1e-15 and axis.shape == (5,), axis[...]
assert f["outcome"].shape == (5, 2)
END
expect "tables have the column" 0 "$stance" table heights.h5 \
    tells '^case,ground.plates.step.height,|^ground.plates.step.height,'
expect "summaries tell them" 0 "$stance" summary heights.h5 tells 'plates.stairs.width 0.1 m'

# ---- pictures --------------------------------------------------------------------------------------
# Lines of the ground, grey, in a picture: places of their corners.
cat >corners.py <<'END'
import re, sys
text = open(sys.argv[1]).read()
grey = [m for m in re.findall(r"<g[^>]*>|<path[^>]*>", text)]
pieces, colour = 0, ""
for tag in grey:
    found = re.search(r"stroke\s*[:=]\s*['\"]?\s*(rgb\(\s*160,\s*160,\s*160\)|#a0a0a0)", tag, re.I)
    if tag.startswith("<g"):
        colour = found
    elif found or colour:
        pieces += max(0, len(re.findall(r"[ML]?\s*-?[\d.]+,-?[\d.]+", tag)) - 1)
print(pieces)
END
corners() { "$python" corners.py "$1"; }
expect "the model" 0 "$stance" plot --model "$walks" "${alone[@]}" -o model.svg
expect "the model on the plane" 0 "$stance" plot --model "$walks" --set 'sweep={}' -o plane.svg
is "... has a step where the plane has none" '[ "$(corners model.svg)" -ge 4 ] && ! cmp -s model.svg plane.svg'
expect "a case with its trajectory" 0 "$stance" run "$walks" "${alone[@]}" --set stop.time=2.2 --set record.cases=all -o case.h5
for picture in strip animation; do
    expect "its $picture" 0 "$stance" replay case.h5 --case 0 --picture $picture -o $picture.svg
    is "... has corners" [ "$(corners $picture.svg)" -ge 20 ]
done
expect "one that falls" 0 "$stance" replay case.h5 --case 0 --set ground.friction=0.2 --picture strip -o falls.svg
is "... stands on plates in each figure" [ "$(corners falls.svg)" -ge 20 ]

# ---- steps that are enough -------------------------------------------------------------------------
expect "three steps are enough" 0 "$stance" run "$walks" --set 'sweep={}' --set stop.walks.enough=3 -o enough.h5
expect "where one is not" 0 "$stance" run "$walks" --set 'sweep={}' --set stop.walks.enough=100 -o alike.h5
holds "... whatever they are like; steps that are alike end it all the same" <<'END'
import h5py, numpy as np
enough, alike = h5py.File("enough.h5"), h5py.File("alike.h5")
one = lambda f, k: f[k][...].ravel()[0]
for f in enough, alike:
    words = f["outcome"].attrs["flag_meanings"]
    words = (words.decode() if isinstance(words, bytes) else words).split()
    assert words[one(f, "outcome")] == "walks"
assert one(enough, "walked_steps") == 3 and one(enough, "gait_period") < 0 and np.isnan(one(enough, "settle_time"))
assert one(alike, "walked_steps") == 11 and one(alike, "gait_period") == 1 and one(alike, "settle_time") > 0
assert abs(one(enough, "walking_speed") - one(alike, "walking_speed")) < 1e-3 and one(enough, "end_time") < 2.1
END
for method in event-driven implicit midpoint lagrange; do
    expect "enough by $method" 0 "$stance" run "$walks" --set 'sweep={}' --set stop.walks.enough=2 \
        --set method.name=$method -o by.h5 --force tells '1 walks'
done
