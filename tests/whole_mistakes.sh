#!/usr/bin/env bash
# Mistakes on the command line, and the line that mends each: the wrong one is told in one line what to
# write instead, and what it says then works. Mistakes in scenario files: tests/mistakes.txt.
. "$(dirname "$0")/scratch.sh"
cp "$shipped"/{ball_bounce,balance_falls,basin_one_foot}.yaml .
cp "$shipped"/mechanisms/hopper.yaml .
"$stance" run ball_bounce.yaml --quiet
"$stance" run balance_falls.yaml --quiet
"$stance" run "$shipped/basin_one_foot.yaml" --quiet -o map.h5 --set 'sweep.grid[0].count=12' --set 'sweep.grid[1].count=12' \
    --set controller.sample_time=0.01 --set method.step=0.01
mv results/ball_bounce.h5 ball.h5 && mv results/balance_falls.h5 robot.h5
"$stance" run "$shipped/basin_one_foot.yaml" --quiet -o lag.h5 --set 'sweep.grid[1]={path: controller.lag, values: [0.001, 0.02]}' \
    --set 'sweep.grid[0].count=13' --set controller.sample_time=0.01 --set method.step=0.01
cp "$shipped/mechanisms/cart_pole.yaml" cart.yaml
{ cat map.h5 && head -c 2000000 /dev/zero; } >large.h5
head -c 5000 ball.h5 >cut.h5
: >empty.h5

cat >lamp.yaml <<'YAML'
stance: 1
scene: mechanism
robot:
  bodies:
    foot: {joint: free, mass: 1, inertia: 0.01, centre: [0.05, 0.02]}
    arm: {joint: hinge, parent: foot, mass: 3, inertia: 0.1, at: [0, 0.1], centre: [0, 0.5], limits: [-0.3, 1]}
  contacts: {plate: {body: foot, from: [-0.1, 0], to: [0.2, 0]}}
  actuators: {ankle: {body: arm, limit: 10}}
initial: {equilibrium: {arm: 0.5}}
stop: {time: 1}
YAML

# Each row a wrong command => what the one line on standard error says, where it is long in a line of its own; then,
# after ok, the right one for those above it.
while read -r row; do
    if [[ $row == "ok "* ]]; then
        right=${row#ok }
        is "... mended: $right" 'eval "timeout $patience ${right/#stance/\"\$stance\"}" >log 2>&1 </dev/null'
        continue
    fi
    [[ $row == *" => "* ]] || { read -r said && row+=" $said"; }
    wrong=${row%% => *} said=${row#* => }
    eval "timeout $patience ${wrong/#stance/\"\$stance\"}" >/dev/null 2>log </dev/null
    status=$?
    is "$wrong" '((status == 2 || status == 3)) && [ "$(wc -l <log)" = 1 ] && grep -qF -- "$said" log'
done <<'END'
stance check ball_bounce.yaml --set ground.friction 0.2 => unexpected argument '0.2'; write --set ground.friction=0.2
stance check ball_bounce.yaml --set ground.friction = 0.2 => write --set ground.friction=0.2
stance check ball_bounce.yaml ground.friction=0.2
  => unexpected argument 'ground.friction=0.2'; write --set ground.friction=0.2
stance check ball_bounce.yaml --set ground.friction:0.2 => write ground.friction=0.2
stance check ball_bounce.yaml --set ground.friction => write ground.friction=VALUE
stance check ball_bounce.yaml --set friction=0.2 => did you mean 'ground.friction'?
stance check ball_bounce.yaml --set ground.friction=0,2 => found '0,2'; write 0.2
stance check ball_bounce.yaml --set --set ground.friction=0.2 => write --set ground.friction=0.2
  ok stance check ball_bounce.yaml --set ground.friction=0.2
stance check ball_bounce.yaml --set=ground.friction 0.2 => write --set ground.friction=0.2
  ok stance check ball_bounce.yaml --set=ground.friction=0.2
stance check ball_bounce.yaml --set stop.time=5s
  => stop.time: expected a number, found '5s' (numbers only; time is in s); write 5
  ok stance check ball_bounce.yaml --set stop.time=5
stance check hopper.yaml --set robot.shoe.mass=0.6 => robot: unknown key 'shoe'
  ok stance check hopper.yaml --set robot.bodies.shoe.mass=0.6
stance check ball_bounce => did you mean 'ball_bounce.yaml'?
stance describe ball_bounce.yaml => write stance check ball_bounce.yaml
stance chek ball_bounce.yaml => did you mean 'check'?
stance check large.h5 => a results file, not a scenario; write stance summary large.h5
stance check => a scenario file must be given
  ok stance check ball_bounce.yaml
stance check ball.h5 => a results file, not a scenario; write stance summary ball.h5
stance run ball.h5 => a results file, not a scenario; write stance summary ball.h5
stance summary ball_bounce.yaml => a scenario, not a results file; stance run makes one of it
stance summary cut.h5 => bytes are there; copy it again, or compute it anew
stance summary empty.h5 => an empty file
stance summary ball => No such file or directory
stance ball.h5 => write stance summary ball.h5
stance summary => a results file must be given
  ok stance summary ball.h5
stance design robot.h5 => a results file, not a scenario; write stance summary robot.h5
  ok stance summary robot.h5
stance plot ball_bounce.yaml => a scenario, not a results file; stance run makes one of it
  ok stance plot ball.h5 -o .
stance basin ball_bounce.yaml => a scenario, not a results file; stance run makes one of it
  ok stance run ball_bounce.yaml --quiet --force
stance table ball_bounce.yaml => a scenario, not a results file; stance run makes one of it
  ok stance table ball.h5
stance compare ball_bounce.yaml ball.h5 => a scenario, not a results file; stance run makes one of it
  ok stance compare ball.h5 ball.h5
stance status cut.h5 => only 5000 of its
  ok stance status ball.h5
stance run ball_bounce.yaml --resume -o cut.h5 => bytes are there; copy it again, or compute it anew
  ok stance run ball_bounce.yaml --force -o cut.h5
stance describe friction => write stance describe ground.friction
  ok stance describe ground.friction
stance describe slope => 'slope' is the end of ground.slope, controller.model.slope, robot.slope
  ok stance describe ground.slope
stance describe lqr => 'lqr' is a word of controller.design; write stance describe controller.design
  ok stance describe controller.design
stance describe sample_tim => did you mean 'controller.sample_time'?
  ok stance describe controller.sample_time
stance ball_bounce.yaml => write stance run ball_bounce.yaml
stance run ball_bounce.yaml --forse => did you mean '--force'?
stance run ball_bounce.yaml => --force
  ok stance run ball_bounce.yaml --force
stance run ball_bounce.yaml -n 2 => for several ranks write mpirun -n N stance run
  ok mpirun -n 2 "$stance" run ball_bounce.yaml --force --quiet
stance run ball_bounce.yaml --output new.h5 => did you mean '-o'?
  ok stance run ball_bounce.yaml -o new.h5
stance run ball_bounce.yaml --only => a value must follow '--only'
  ok stance run ball_bounce.yaml --only 3 --quiet
stance run ball_bounce.yaml --only 3.5 => --only takes the flat index of a case, not '3.5'
  ok stance run ball_bounce.yaml --only 3 --quiet --force
stance run ball_bounce.yaml --trace => --trace needs --only
  ok stance run ball_bounce.yaml --only 3 --trace --quiet --force
stance run ball_bounce.yaml --force --resume => --resume and --force exclude each other
  ok stance run ball_bounce.yaml --force --quiet
stance compare ball.h5 ball.h5 --of rested => --of needs --labels
  ok stance compare ball.h5 ball.h5 --labels --of rested
stance compare ball.h5 ball.h5 --labels --tolerance 0.1 => --labels and --tolerance exclude each other
  ok stance compare ball.h5 ball.h5 --labels
stance plot map.h5 --of fell => --of needs --answer or --outline
  ok stance plot map.h5 --of fell --answer fall_time
stance plot map.h5 --picture map --for journal => --for takes one of column, page, not 'journal'
  ok stance plot map.h5 --picture map --for column
stance basin map.h5 --rank 2 --boundary => --rank and --boundary exclude each other
  ok stance basin map.h5 --boundary
stance export hopper.yaml => --mjcf must be given
  ok stance export hopper.yaml --mjcf
stance describe --schema stop.time => --schema and PATH exclude each other
  ok stance describe stop.time
stance plot ball.h5 --answer freinds => --answer
  ok stance plot ball.h5 --answer energy_gain -o .
stance plot robot.h5 --case one => --case takes the number of a case, not 'one'
  ok stance plot robot.h5 --case 0 -o .
stance plot map.h5 --answer settle-time => did you mean 'settle_time'?
  ok stance plot map.h5 --answer settle_time -o .
stance basin map.h5 --of stabilized => takes one of stabilised, walks, rested, fell, undecided, not 'stabilized'
  ok stance basin map.h5 --of stabilised
stance basin map.h5 --level 95 => --level takes a number from 0.5 to 0.999999, not '95'
  ok stance basin map.h5 --level 0.95
stance basin map.h5 --box 2.5 => --box takes a whole number from 2 to 1000, not '2.5'
  ok stance basin map.h5 --box 3
stance table map.h5 --answer outcomes => did you mean 'outcome'?
  ok stance table map.h5 --answer outcome
stance table map.h5 --of stable => takes one of stabilised, walks, rested, fell
  ok stance table map.h5 --of stabilised
stance compare ball.h5 ball.h5 --tolerance 1% => --tolerance takes RELATIVE[,ABSOLUTE]
  ok stance compare ball.h5 ball.h5 --tolerance 0.01
stance sensitivity map.h5 => its scenario needs sweep.sample (stance describe sweep.sample)
  ok stance summary map.h5
stance run ball_bounce.yaml --only 19 => --only 19: the scenario's cases are 0 ... 18
  ok stance run ball_bounce.yaml --only 18 --force --quiet
stance replay map.h5 --near theta=0.1 vtheta=0.2 -o near.svg => write --near theta=0.1,vtheta=0.2
  ok stance replay map.h5 --near theta=0.1,vtheta=0.2 -o near.svg
stance basin lag.h5 --threshold 0.8 --of lag => not 'lag'; did you mean 'controller.lag'?
  ok stance basin lag.h5 --threshold 0.8 --of controller.lag
stance basin lag.h5 --lost lag => not 'lag'; did you mean 'controller.lag'?
  ok stance basin lag.h5 --lost controller.lag
stance basin lag.h5 --by lag => did you mean 'controller.lag'?
  ok stance basin lag.h5 --by controller.lag
stance basin map.h5 --weight theta=0.1 => did you mean 'initial.offset.theta'?
  ok stance basin map.h5 --weight initial.offset.theta=0.1
stance plot map.h5 -o film.mp4
  => -o takes a directory or, without --format, a file that ends in svg, png or pdf, of replay in gif, too, not 'film.mp4'
  ok stance plot map.h5 -o film
stance plot map.h5 --picture map -o map.EPS => not 'map.EPS'
  ok stance plot map.h5 --picture map -o map.pdf
stance run ball_bounce.yaml -o foo.pdf --quiet => -o takes the results, FILE.h5
  ok stance run ball_bounce.yaml -o foo.h5 --quiet
stance check cart.yaml --set initial.equilibrium.pole=180
  => no equilibrium at pole = 180 rad, more than a turn: angles are in radians (are these degrees?)
stance check cart.yaml --set initial.equilibrium.pole=3.14159 => pole cannot be balanced: 1.3e-06 N m are left on it
  ok stance check cart.yaml --set initial.equilibrium.pole=3.141592653589793
stance check lamp.yaml => plate_toe would have to pull, with 8.80082 N; there is one with arm from -0.3 to 0.3046 rad
  ok stance check lamp.yaml --set initial.equilibrium.arm=0.3046
stance design lamp.yaml --set initial.equilibrium.arm=-0.35
  => arm would be at -0.35 rad, beyond its limits -0.3 ... 1; there is one with arm from -0.3 to 0.3046 rad
  ok stance design lamp.yaml --set initial.equilibrium.arm=-0.3
stance check lamp.yaml --set initial='{state: {arm: -0.5}, support: [plate]}'
  => initial.state.arm: arm would start at -0.5 rad, below its lower limit of -0.3 rad
  ok stance check lamp.yaml --set initial='{state: {arm: -0.2}, support: [plate]}'
stance design basin_one_foot.yaml --set controller.poles='[-3, -3.001, -3.002, -3.003, -3.004, -3.005]'
  => controller.poles: pole placement did not converge in 20000 sweeps: set the poles further apart, or take controller.design place-schur
  ok stance design basin_one_foot.yaml --set controller.poles='[-3, -3.001, -3.002, -3.003, -3.004, -3.005]' --set controller.design=place-schur
stance help ruun => unknown command 'ruun'; did you mean 'run'?
  ok stance help run
stance describe robot.bodies.trunk.mas => unknown path 'robot.bodies.trunk.mas'
  ok stance describe robot.bodies.trunk.mass
END
# Several files, names as long as a file system takes, shards without a case.
expect "status of several files" 0 "$stance" status ball.h5 robot.h5 times 2 'complete$'
expect "... as JSON, one of which is not there" 3 bash -c '"$0" status ball.h5 none.h5 robot.h5 --json 2>/dev/null' "$stance"
holds "... is a list" 'd = said(); assert [x and x["file"] for x in d] == ["ball.h5", None, "robot.h5"], d'
long=$(printf 'a%.0s' $(seq 247))
cp ball_bounce.yaml "$long.yaml"
expect "a name of 252 letters" 0 "$stance" run --quiet "$long.yaml" is [ -s "results/$long.h5" ]
"$stance" run ball_bounce.yaml --dry-run >/dev/null
for k in 1 2; do
    "$stance" run ball_bounce.yaml --quiet -o "shard$k.h5" --shard $k/2 && cp "shard$k.h5" "empty$k.h5"
    "$python" -c 'import h5py, sys; f = h5py.File(sys.argv[1], "a"); f["status"][...] = 0' "empty$k.h5"
done
expect "shards with cases" 0 "$stance" merge whole.h5 shard1.h5 shard2.h5
expect "shards without" 2 "$stance" merge none.h5 empty1.h5 empty2.h5 \
    says "none of the 2 files has a case that is computed" is '[ ! -e none.h5 ] && [ ! -e none.h5.next ]'
# What check says of what is asked for.
expect "a study without a controller" 0 "$stance" check ball_bounce.yaml says "^controller  none$"
expect "very many trajectories" 0 "$stance" check ball_bounce.yaml --set record='{cases: all, every: 0.01}' \
    --set 'sweep.grid=[{path: ground.friction, from: 0, to: 1, count: 10000}, {path: ground.restitution, from: 0, to: 0.9, count: 10000}]' \
    says "warning: .*\(needs about 4.5 TB but only\|the file takes about 4.5 TB\)"
expect "a sample time that is no number of steps" 0 "$stance" check balance_falls.yaml --set controller.sample_time=0.003 --set method.step=0.002
says "... is cut" "^step        0.0015 s: a sample of 0.003 s is cut into 2 steps of at most 0.002 s"
expect "one that is" 0 "$stance" check balance_falls.yaml --set controller.sample_time=0.004 --set method.step=0.002
is "... is not told" ! grep -q '^step' log
expect "a body without inertia" 0 "$stance" check lamp.yaml --set initial.equilibrium.arm=0.1 --set 'robot.bodies.arm={joint: hinge, parent: foot, mass: 3, at: [0, 0.1], centre: [0, 0.5]}'
says "... is a point mass" 'warning: arm: no inertia is given, which makes a point mass of it; if meant so, write inertia: 0'
cat >box.yaml <<'YAML'
stance: 1
scene: mechanism
robot:
  bodies: {box: {joint: free, mass: 2, inertia: 0.05, centre: [0.1, 0.2]}}
  contacts: {sole: {body: box, from: [-0.1, 0], to: [0.1, 0]}}
initial: {state: {box: 0}}
stop: {time: 2}
YAML
expect "a box above the edge of its sole" 0 "$stance" check box.yaml \
    says "warning: the robot begins with its centre of mass above the very edge"
for x in 0.0999 0.1001; do
    expect "one beside it, $x" 0 "$stance" check box.yaml --set "robot.bodies.box.centre[0]=$x" is ! grep -q warning log
done
# A lone case that has no length.
expect "a start that has fallen" 0 "$stance" check cart.yaml --set 'sweep.grid=[{path: initial.offset.pole, values: [0]}]' --set robot.points.tip.lowest=2
says "... has a cost" "^cost *\(at most \)\?about"
sed '/^sweep:/,$d' cart.yaml >lone.yaml
expect "alone" 0 "$stance" check lone.yaml --set robot.points.tip.lowest=2 \
    says "warning: the robot has fallen where it begins, by its tip"
