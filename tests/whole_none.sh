#!/usr/bin/env bash
# Axes and samples among whose values a limit is "none": computed, read by every command and drawn, each at a place
# of its own.
# shellcheck disable=SC2016,SC2034
. "$(dirname "$0")/scratch.sh"
cart=$shipped/mechanisms/cart_pole.yaml

for path in controller.torque_rate controller.torque_limit robot.actuators.push.limit; do
    expect "$path" 0 "$stance" run --quiet --force -o grid.h5 "$cart" --set "sweep.grid=[{path: $path, values: [none, 10]},
        {path: initial.offset.pole, from: -0.6, to: 0.6, count: 5}]"
    expect "... its summary" 0 "$stance" summary grid.h5 says "^  *none  *5  "
    for command in basin table "replay --near pole=0,${path##*.}=none -o case.svg" "compare grid.h5" plot; do
        # shellcheck disable=SC2086
        expect "... $command" 0 "$stance" ${command%% *} grid.h5 $(sed 's/^[a-z]*//' <<<"$command")
    done
    is "... stands in the map" grep -q '>none<' grid-map.svg
done
expect "the words of an axis, in their order" 0 "$stance" summary --json grid.h5 \
    holds 'assert [said()["axes"][0][k] for k in ("first", "last")] == ["none", "10"]'
expect "a threshold along it" 2 "$stance" basin grid.h5 --threshold 0.5 --of robot.actuators.push.limit \
    says "whose values rise or fall"

expect "sampled" 0 "$stance" run --quiet -o sample.h5 "$cart" --set 'sweep={sample: {method: sobol, count: 64, vary: [
    {path: controller.torque_rate, values: [none, 10, 100]}, {path: initial.offset.pole, from: -0.6, to: 0.6}]}}'
expect "... and drawn" 0 "$stance" plot sample.h5 --picture sample
is "... in the scatter and in the shares" [ "$(grep -o '>none<' sample-sample.svg | wc -l)" -ge 2 ]
expect "its table" 0 "$stance" table sample.h5
[ "$(grep -c '^[0-9]*,[0-9]*,none,' log)" -gt 9 ] && ! grep -q inf log
result $? "... says none"
