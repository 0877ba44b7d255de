#!/usr/bin/env bash
# Pages of files of many kinds, in a headless Chromium: see view.mjs.
# about: analysis/view
# long
. "$(dirname "$0")/scratch.sh"
node=$(command -v node) && [ -x "$(command -v chromium || command -v google-chrome)" ] || { skip "pages in a browser" "no node, or no chromium"; exit 0; }
make_page() { # name, scenario, --set ...
    local name=$1 scenario=$2
    shift 2
    "$stance" run "$shipped/$scenario" "$@" -o "$name.h5" >/dev/null && "$stance" view "$name.h5" -o "$name.html" >/dev/null
}
make_page map basin_one_foot.yaml --set 'sweep.grid[0].count=41' --set 'sweep.grid[1].count=41' ||
    { skip "pages in a browser" "the program was built without the page: make web"; exit 0; }
# Of the case in the middle of that map: what the page is to find.
"$stance" critical "$shipped/basin_one_foot.yaml" --of controller.torque_limit=10..0.01 --count 16385 --set 'sweep={}' --set 'initial.offset={theta: -0.03}' \
    -o middle.h5 --json >critical.json 2>/dev/null
make_page refined basin_refined.yaml --set 'sweep.grid[0].count=129' --set 'sweep.grid[1].count=129'
make_page sample sampled.yaml --set sweep.sample.count=64
make_page single balance_recovers.yaml
make_page mechanism mechanisms/hopper.yaml --set 'sweep.grid[1].count=5' --set 'sweep.grid[2].count=5'
make_page walker gaits/walks.yaml --set 'sweep.grid[0].count=15' --set 'sweep.grid[1].count=15'
make_page axes ball_bounce.yaml --set 'record={answers: [outcome, failure, end_time]}' --set method.step=0.01 --set stop.time=1 --set 'sweep={grid: [
    {path: ground.restitution, from: 0, to: 0.6, count: 4}, {path: ground.friction, from: 0, to: 1, count: 4}, {path: initial.state.z, from: 0.2, to: 1, count: 4},
    {path: initial.state.vx, from: -1, to: 1, count: 4}, {path: initial.state.vz, from: -1, to: 1, count: 4}]}'
make_page methods topple.yaml --set 'sweep={grid: [{path: method.name, values: [implicit, event-driven, lagrange]}]}'
make_page tiny basin_one_foot.yaml --set 'sweep={grid: [{path: initial.offset.vtheta, from: -5e-324, to: 5e-324, count: 3}, {path: ground.friction, from: 1, to: 1.000000000001, count: 5}]}'
make_page delays controllers/delay.yaml --set 'sweep={grid: [{path: initial.offset.theta, from: -0.1, to: 0.1, count: 9}, {path: controller.delay, from: 0, to: 2, count: 3}]}'
make_page pairs basin_one_foot.yaml --set 'sweep={grid: [{paths: [method.name, method.step], values: [[implicit, 0.002], [lagrange, 0.001]]}, {path: initial.offset.q1, from: -0.1, to: 0.1, count: 5}, {path: controller.torque_limit, values: [none, 5]}]}'
make_page bare basin_one_foot.yaml --set 'sweep.grid[0].count=9' --set 'sweep.grid[1].count=9' --set 'record={answers: [end_time]}'
# A law of the user's own; a page made where no clang compiles it.
cat >spring.c <<'END'
#define PARAMETERS(X) X(stiffness, 20, "N m/rad", 0, 100, "of both legs")
#define MEMORY(X) X(calls)
#include "stance_law.h"
void law(const struct sample *now, const struct parameters *is, struct memory *mine, struct torques *out)
{
    mine->calls += 1;
    out->hip1 = -is->stiffness * sin(now->q.q1 - now->target.q1) - now->v.q1 + now->rest.hip1;
    out->hip2 = -is->stiffness * tanh(now->q.q2 - now->target.q2) - now->v.q2 + now->rest.hip2;
}
END
grep -v -e design: -e poles: -e kind: "$shipped/balance_recovers.yaml" | sed 's/^controller:/&\n  kind: program\n  file: spring.c/' >law.yaml
export XDG_CONFIG_HOME=$scratch/config
mkdir config
"$stance" run --trust law.yaml -o law.h5 >/dev/null && "$stance" view law.h5 -o law.html >/dev/null
# The first half by one scenario, the other by another.
few=(--set 'sweep.grid[0].count=12' --set 'sweep.grid[1].count=12')
"$stance" run "$shipped/basin_one_foot.yaml" "${few[@]}" -o scenarios.h5 >/dev/null 2>&1
"$python" -c 'import h5py
with h5py.File("scenarios.h5", "r+") as f:
    status = f["status"][...]; status[6:] = 0; f["status"][...] = status'
"$stance" run "$shipped/basin_one_foot.yaml" "${few[@]}" --set ground.friction=0.15 --resume --force-scenario -o scenarios.h5 >/dev/null 2>&1
"$stance" view scenarios.h5 -o scenarios.html >/dev/null
"$node" "$tests/view.mjs" "$scratch" "$@"
