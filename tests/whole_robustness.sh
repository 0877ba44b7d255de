#!/usr/bin/env bash
# How robust a gait is, in a study's reduced form: pushes, steps, slopes, floors, noise and rough ground of the paper's biped,
# and of gaits like its own what is cheap to compute beside what they walk over; and steps of the ground in `stance gait`.
# about: analysis/gait analysis/critical analysis/python runner/run
# shellcheck disable=SC2154
. "$(dirname "$0")/scratch.sh"
walks=$shipped/gaits/walk_pushes.yaml

# ---- steps of the ground -------------------------------------------------------------------------
step='ground.plates={step: {footfall: 1, from: 0.1, height: 0}}'
by=(--sensitivity ground.plates.step.height=-0.001..0.001)
expect "by how much steps of the ground vary a gait" 0 "$stance" gait "$walks" --set "$step" "${by[@]}"
grep -qE '^  ground.plates.step.height +-0.001 +0.001 +1\.8[12][0-9]*e-02 +1\.5[67][0-9]*e-03 ' log
result $? "... counts what they do to the step after"
expect "steps in a range close to what is known" 0 "$stance" gait "$walks" --set "$step" "${by[@]//0.001/1e-10}" \
    tells '^  ground.plates.step.height .* [0-9.]+e(-01|\+0[0-9])$'
expect "a step that is never met" 2 "$stance" gait "$walks" --set "${step/: 1/: 2}" "${by[@]}" \
    tells "changes nothing in the gait's returns"
expect "a step that is there each time" 2 "$stance" gait "$walks" --set "${step/height: 0/height: 0.01}" \
    tells 'the same plane in each step'
expect "nor is ground that is uneven where it is" 2 "$stance" gait "$walks" \
    --set 'ground.plates={up: {from: 0.4, height: 0.01}}' tells 'but for one with footfall: 1'

# ---- the study -----------------------------------------------------------------------------------
if ! "$python" -c 'import h5py, xarray, yaml' 2>/dev/null || ! command -v gnuplot >/dev/null; then
    skip "a study of robustness" "no python3-h5py, python3-xarray, python3-yaml or gnuplot"
else
    expect "a study of robustness" 0 env PYTHONPATH="$tests/../analysis/python" "$python" "$shipped/gaits/robustness.py" --quick study
    holds "... has brackets, shares and gaits that hold" <<'END_'
rows = {row["what"]: [float(row[end] or "nan") for end in ("value", "low", "high")] for row in csv.DictReader(open("study/robustness.csv"))}
fine = {"push forwards at 0/4": 2.489, "push backwards at 0/4": 0.759, "step down": 28.61, "step up": 6.35,
        "slope down": 0.04934, "least friction": 0.4844}
for what, value in fine.items():
    assert rows[what][1] <= value <= rows[what][2], (what, value, rows[what])
share, low, high = rows["share of grounds of 1 mm"]
assert low < share == 1 <= high, rows
gaits = list(csv.DictReader(open("study/robust_gaits.csv")))
assert len(gaits) >= 2 and all(float(g["multiplier"]) < 1 and float(g["norm_period"]) > 0 for g in gaits), gaits
END_
    is "... and a picture" [ "$(head -c 4 study/robustness.png | tail -c 3)" = PNG ]
fi
