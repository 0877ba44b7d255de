#!/usr/bin/env bash
# The engine of pages has the program's bits: all scenes, described ones too, by all methods with lanes, with noise,
# samples, logarithmic axes, other laws. PAGE_CASES (24) of each page, of maps of PAGE_SIDE (7) places a side: see
# page_cases.mjs.
# about: analysis/view
# long
. "$(dirname "$0")/scratch.sh"
node=$(command -v node) && "$stance" view -h >/dev/null && "$stance" view "$shipped/topple.yaml" 2>&1 | grep -qv 'built without' ||
    { skip "pages" "no node, or the program was built without the page"; exit 0; }
cases=${PAGE_CASES:-24} side=${PAGE_SIDE:-7}
pages=()
page() { # name, scenario, --set ...
    "$stance" run --quiet "$shipped/$2.yaml" "${@:3}" -o "$1.h5" >"$1.log" 2>&1
    "$stance" view "$1.h5" >>"$1.log" 2>&1 || cat "$1.log" >&2
    pages+=("$1.html")
}
grid() { # count of the first axes
    local k=0 n
    for n in "$@"; do sets+=(--set "sweep.grid[$k].count=$n"); k=$((k + 1)); done
}
for method in implicit midpoint capturing lagrange; do
    for scenario in ball_bounce rod_fall block_threshold basin_one_foot mechanisms/acrobot mechanisms/cart_pole; do
        sets=(--set "method.name=$method")
        [ "$scenario" = ball_bounce ] || grid "$side" "$side"
        [ "$scenario" = rod_fall ] && sets+=(--set record.cases=none)
        page "$method-$(basename "$scenario")" "$scenario" "${sets[@]}"
    done
done
sets=() && grid 5 5 && page feet basin_both_feet "${sets[@]}"
page friction friction_sweep --set 'sweep.grid[1].count=5' --set 'sweep.grid[2].count=5'
page sampled sampled --set sweep.sample.count=32
sets=() && grid 65 65 && page refined basin_refined "${sets[@]}"
page pushed mechanisms/pushed --set 'sweep.grid[1].count=5'
sets=() && grid 5 5 && page compass mechanisms/compass_gait "${sets[@]}"
sets=() && grid "$side" "$side" && page walks gaits/walks "${sets[@]}"
page rabbit-walks gaits/rabbit_walks "${sets[@]}"
page walk-pushes gaits/walk_pushes "${sets[@]}"
page without-model gaits/walks_without_model --set 'sweep.grid[0].count=7'
page clock gaits/walks_by_the_clock --set 'sweep.grid[0].count=7'
page compass-walks mechanisms/compass_gait "${sets[@]}" --set stop.walks.steps=10 --set stop.time=30
for law in bimodal switching sensors delay lag; do
    page "$law" "controllers/$law" --set 'sweep.grid=[{path: initial.offset.theta, from: -0.1, to: 0.1, count: 6}, {path: initial.offset.vtheta, from: -0.4, to: 0.4, count: 5}]'
done
sets=() && page flight controllers/decoupling_flight
page log basin_one_foot --set 'sweep.grid=[{path: ground.friction, from: 0.01, to: 1, count: 9, spacing: log}, {path: controller.noise, values: [0, 0.3]}]'
page single balance_recovers
# Laws of the user's own, as modules beside the engine.
export XDG_CONFIG_HOME=$scratch/config
mkdir -p config
sets=(--trust) && grid 5 5 && page swing laws/swing_up "${sets[@]}" --set method.name=capturing
sets=(--trust) && page hopper laws/raibert_hopper "${sets[@]}" --set stop.time=4
sets=(--trust) && page network laws/network "${sets[@]}" --set sweep.sample.count=32 --set stop.time=4
# Changes in a page are changes by --set. A designed controller stays what it was while its model does.
study() { study=$1 && sets=() && grid 6 6 && page "base-$(basename "$study")" "$study" "${sets[@]}" && base=${pages[-1]}; }
change() { # PATH=VALUE ...
    local name=change${#pages[@]} set all=$base
    local of=("${sets[@]}")
    for set in "$@"; do of+=(--set "$set") all+="|$set"; done
    page "$name" "$study" "${of[@]}"
    pages[-1]="$all|$name.html"
}
study basin_one_foot
change ground.friction=0.25
change robot.trunk_mass=3 controller.model.trunk_mass=1.8
change controller.torque_limit=7
change controller.noise=0.5 seed=7
change controller.sample_time=0.01
change controller.lag=0.01 controller.delay=2
change method.name=capturing ground.restitution=0.5
change stop.time=3 stop.settle.hold=0.1
study mechanisms/cart_pole
change ground.gravity=5 controller.model.gravity=9.81
change controller.torque_limit=20 method.step=0.002
study gaits/walks
change ground.friction=0.6 ground.slope=0.02
change controller.torque_limit=8 controller.sample_time=0.005
"$node" "$tests/page_cases.mjs" "$cases" "${pages[@]}"
