#!/usr/bin/env bash
# Designs that cannot work are said before a run is wasted on them, and only those; and the time at
# which a case has settled is continuous in its start.
# about: runner/run analysis/summary
# shellcheck disable=SC2016,SC2034
. "$(dirname "$0")/scratch.sh"
map=$shipped/basin_one_foot.yaml

warns() { # name, what is said, check's arguments: exactly one line
    expect "$1" 0 "$stance" check "${@:3}" says "warning: $2" warning:
}
warns "a loop that is unstable as it is sampled" "the loop is unstable: spectral radius [0-9.]* at a sample time of 0.2 s" "$map" --set controller.sample_time=0.2
warns "a loop that is unstable a sample late" "the loop is unstable: spectral radius [0-9.]* at a sample time of 0.1 s, a sample late" "$map" --set controller.sample_time=0.1 --set controller.delay=1
expect "a loop that is hardly unstable" 0 "$stance" check "$shipped/mechanisms/cart_pole.yaml" --set controller.sample_time=0.02 --set controller.delay=2 --set controller.lag=0.0601743
says "... is told as far as it is" "spectral radius 1.0*[1-9][0-9]* at"
warns "noise that does not let it settle" "noise makes .* wander by [0-9.]* rms, more than settle.rate, 0.01" "$map" --set controller.rate_noise=0.03 --set stop.settle.rate=0.01
warns "noise beyond the torque limit" "noise on the command of hip[12] is [0-9.]* rms, more than the [0-9.]* that its limit leaves" "$map" --set controller.noise=4.6
warns "a torque limit below the equilibrium's" "the equilibrium takes [0-9.]* of hip[12], which gives 0.5 at most" "$map" --set controller.torque_limit=0.5
warns "friction below what standing takes" "standing on foot1 takes friction 0.3[0-9]*, there is 0.1" "$shipped/mechanisms/pushed.yaml" --set ground.slope=0.3 --set ground.friction=0.1
warns "degrees" "theta begins at -23.54 rad, more than a turn.*angles are in radians" "$shipped/balance_recovers.yaml" --set initial.equilibrium='{theta: -23.5, q2: 47}' --set controller.torque_limit=100
warns "some of many cases" ".*case [0-9]*; so it is in [0-9]* of 64 cases, evenly spread" "$shipped/sample_time_sweep.yaml"
warns "an axis that leaves out the equilibrium" "the 64 points of initial.offset.vtheta leave out the equilibrium, at 0; write count: 65" "$map" --set 'sweep.grid[1].count=64'
expect "with that count" 0 "$stance" check "$map" --set 'sweep.grid[1].count=65' is ! grep -q warning log
inside=(--set 'sweep.grid[0]={path: initial.offset.theta, from: -0.01, to: 0.01, count: 11}'
    --set 'sweep.grid[1]={path: initial.offset.vtheta, from: -0.03, to: 0.03, count: 11}')
outside=(--set 'sweep.grid[0]={path: initial.offset.theta, from: 0.1, to: 0.3, count: 11}'
    --set 'sweep.grid[1]={path: initial.offset.vtheta, from: 0.3, to: 0.6, count: 11}')
warns "ranges within the domain" "9 of 121 cases tried: all are stabilised: the ranges end within the domain; stance ranges $map finds" "$map" "${inside[@]}"
warns "ranges beside the domain" "9 of 121 cases tried: all fell: the ranges do not meet a domain; stance ranges $map finds" "$map" "${outside[@]}"
for where in inside outside; do
    declare -n box=$where
    expect "a run $where" 0 mpirun -n 2 "$stance" run -o "$where.h5" "$map" "${box[@]}" \
        says 'stance run: warning: all cases \(are stabilised: the ranges end within\|fell: the ranges do not meet\)'
    expect "its summary" 0 "$stance" summary "$where.h5" \
        says "^  the ranges \(end within the domain\|do not meet a domain\): stance ranges SCENARIO finds"
done
for sound in basin_one_foot basin_both_feet topple friction_sweep controllers/gain_choice balance_falls rod_fall walk_attempt balance_recovers mechanisms/rabbit mechanisms/cart_pole mechanisms/pushed; do
    expect "$sound" 0 "$stance" check "$shipped/$sound.yaml" is ! grep -q warning log
done
expect "run" 0 mpirun -n 2 "$stance" run --quiet -o run.h5 "$map" --set controller.sample_time=0.2 \
    --set 'sweep.grid[0].count=4' --set 'sweep.grid[1].count=3' says 'stance run: warning'

export STANCE_CACHE=$scratch/cache
expect "the cost of a robot of one's own" 0 "$stance" check "$shipped/mechanisms/cart_pole.yaml" \
    says "^cost *.*about .* that run compiles for this robot$" \
        "^compiling *about .*, once for robots of this structure" is [ ! -e "$STANCE_CACHE" ]
expect "with that kernel in the cache" 0 "$stance" build "$shipped/mechanisms/cart_pole.yaml"
kept() { stat -c '%n %y' "$STANCE_CACHE" "$STANCE_CACHE"/*; }
kept >before
expect "... its cost is measured" 0 "$stance" check "$shipped/mechanisms/cart_pole.yaml" \
    is ! grep -q '^compiling\|compiles' log tells '^cost *about [0-9.]* s on 1 rank$' is 'cmp before <(kept)'

# What a design stands on, where it is not level earth.
expect "the design on a slope of the moon" 0 "$stance" design "$shipped/mechanisms/pushed.yaml" --set ground.slope=0.1 \
    --set ground.gravity=1.62 says "^  slope  *0.10* rad  of the ground" "^  gravity  *1.620* m/s^2"
expect "on level earth" 0 "$stance" design "$shipped/mechanisms/pushed.yaml" is ! grep -q '^  slope\|^  gravity' log

# Starts at rest on a line through the equilibrium. What never leaves the window has settled at 0; beyond, the
# time jumps once, where a motion touches the window's edge, and is continuous from there.
expect "starts about the equilibrium" 0 "$stance" run --quiet -o edge.h5 "$map" \
    --set 'sweep.grid[0].from=-0.02' --set 'sweep.grid[0].to=0.015' --set 'sweep.grid[0].count=351' \
    --set 'sweep.grid[1].from=0' --set 'sweep.grid[1].to=0' --set 'sweep.grid[1].count=1'
holds "... settle at once or in a time that is continuous" <<'END'
time = h5py.File("edge.h5")["settle_time"][...].ravel()
assert numpy.isfinite(time).all()
inside = numpy.flatnonzero(time == 0)
assert 0 in inside - 200 and (numpy.diff(inside) == 1).all(), inside  # case 200 is the equilibrium
for side in time[:inside[0]][::-1], time[inside[-1] + 1:]:
    assert side[0] > 0.5 and len(side) > 50 and 0 < numpy.diff(side)[5:].max() < 0.02 and (numpy.diff(side) > 0).all(), side
END
