#!/usr/bin/env bash
# Designs that cannot work are said before a run is wasted on them, and only those; and the time at
# which a case has settled is continuous in its start. Speaks TAP.
# shellcheck disable=SC2016,SC2034
set -u
# shellcheck source=tests/scratch.sh
. "$(dirname "$0")/scratch.sh"
map=$shipped/basin_one_foot.yaml

warns() { # name, what is said, check's arguments: exactly one line
    expect "$1" 0 "$stance" check "${@:3}"
    says "... is said" "warning: $2"
    [ "$(grep -c warning: log)" = 1 ]
    result $? "... once"
}
warns "a loop that is unstable as it is sampled" "the loop is unstable: spectral radius [0-9.]* at a sample time of 0.2 s" "$map" --set controller.sample_time=0.2
warns "a loop that is unstable a sample late" "the loop is unstable: spectral radius [0-9.]* at a sample time of 0.1 s, a sample late" "$map" --set controller.sample_time=0.1 --set controller.delay=1
warns "a torque limit below the equilibrium's" "the equilibrium takes [0-9.]* of hip[12], which gives 0.5 at most" "$map" --set controller.torque_limit=0.5
warns "friction below what standing takes" "standing on foot1 takes friction 0.3[0-9]*, there is 0.1" "$shipped/mechanisms/pushed.yaml" --set ground.slope=0.3 --set ground.friction=0.1
warns "degrees" "theta begins at -23.54 rad, more than a turn.*angles are in radians" "$shipped/balance_recovers.yaml" --set initial.equilibrium='{theta: -23.5, q2: 47}' --set controller.torque_limit=100
warns "some of many cases" ".*case [0-9]*; so it is in [0-9]* of 64 cases, evenly spread" "$shipped/sample_time_sweep.yaml"
for sound in basin_one_foot balance_recovers mechanisms/rabbit mechanisms/cart_pole mechanisms/pushed; do
    expect "$sound" 0 "$stance" check "$shipped/$sound.yaml"
    ! grep -q warning log
    result $? "... has nothing to be warned of"
done
expect "run" 0 mpirun -n 2 "$stance" run --quiet -o run.h5 "$map" --set controller.sample_time=0.2 --set 'sweep.grid[0].count=2' --set 'sweep.grid[1].count=2'
[ "$(grep -c 'stance run: warning' log)" = 1 ]
result $? "... warns once, whatever the ranks"

# Starts at rest on a line through the equilibrium. What never leaves the window has settled at 0; beyond, the
# time jumps once, where a motion touches the window's edge, and is continuous from there.
expect "starts about the equilibrium" 0 "$stance" run --quiet -o edge.h5 "$map" \
    --set 'sweep.grid[0].from=-0.02' --set 'sweep.grid[0].to=0.015' --set 'sweep.grid[0].count=351' \
    --set 'sweep.grid[1].from=0' --set 'sweep.grid[1].to=0' --set 'sweep.grid[1].count=1'
"$python" - <<'END'
import h5py, numpy
time = h5py.File("edge.h5")["settle_time"][...].ravel()
assert numpy.isfinite(time).all()
inside = numpy.flatnonzero(time == 0)
assert 0 in inside - 200 and (numpy.diff(inside) == 1).all(), inside  # case 200 is the equilibrium
for side in time[:inside[0]][::-1], time[inside[-1] + 1:]:
    assert side[0] > 0.5 and len(side) > 50 and 0 < numpy.diff(side)[5:].max() < 0.02 and (numpy.diff(side) > 0).all(), side
END
result $? "... settle at once or in a time that is continuous"
echo "1..$count"
