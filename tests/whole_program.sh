#!/usr/bin/env bash
# Every shipped scenario, reduced, from file to picture; the commands' messages and exit codes;
# equal results whatever the ranks; results opened by other programs' readers.
# Uses bin/stance, or the program that STANCE names.
set -u
cd "$(dirname "$0")/.."
stance=${STANCE:-$PWD/bin/stance} python=${PYTHON:-/usr/bin/python3} build=${BUILD:-build}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
count=0
check() { # description, command ...
    local what=$1
    shift
    count=$((count + 1))
    cat "$work/out" "$work/err" >"$work/last" 2>/dev/null # for a look at what came before
    if "$@" >"$work/out" 2>"$work/err"; then
        echo "ok $count - $what"
    else
        echo "not ok $count - $what"
        sed 's/^/# /' "$work/out" "$work/err" | head -n 20
    fi
}
exits() { # code, command ...
    local code=$1
    shift
    "$@"
    [ $? = "$code" ]
}
png() { # is it a picture of a sensible size?
    [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] && [ "$(stat -c %s "$1")" -gt 5000 ]
}

# ---- every shipped scenario, and the studies of the controllers ----
names=()
for scenario in scenarios/*.yaml scenarios/controllers/*.yaml; do
    name=$(basename "$scenario" .yaml) reduce=()
    case $name in
    basin_refined) reduce=(--set 'sweep.grid[0].count=64' --set 'sweep.grid[1].count=64') ;;
    basin_*) reduce=(--set 'sweep.grid[0].count=24' --set 'sweep.grid[1].count=24') ;;
    *_sweep | gain_choice | friction_check | switching*)
        reduce=(--set 'sweep.grid[1].count=9' --set 'sweep.grid[2].count=9') ;;
    gain_choice_sampled | walk_gains)
        reduce=(--set 'sweep.grid[2].count=5' --set 'sweep.grid[3].count=5') ;;
    friction | noise | torque_limit | torque_rate | friction_needed)
        reduce=(--set 'sweep.grid[0].count=13' --set 'sweep.grid[1].count=13') ;;
    delay | lag | sensors) reduce=(--set 'sweep.grid[1].count=13' --set 'sweep.grid[2].count=13') ;;
    sampled) reduce=(--set sweep.sample.count=100) ;;
    what_decides)
        reduce=(--set 'sweep.grid[0].count=4' --set 'sweep.grid[1].count=4' --set sweep.sample.count=8) ;;
    topple) reduce=(--set 'sweep.grid[0].count=65' --set sweep.sample.count=40) ;;
    decoupling_*) reduce=(--set 'sweep.grid[1].count=7') ;;
    esac
    check "$name: check" "$stance" check "$scenario"
    check "$name: run" "$stance" run "$scenario" "${reduce[@]}" --quiet -o "$work/$name.h5"
    check "$name: summary" "$stance" summary "$work/$name.h5"
    check "$name: summary --json" sh -c "'$stance' summary --json '$work/$name.h5' | '$python' -m json.tool"
    check "$name: plot" "$stance" plot "$work/$name.h5" -o "$work"
    grep -E '\.png$' "$work/out" >"$work/pictures"
    check "$name: draws pictures" test -s "$work/pictures"
    while read -r picture; do check "$(basename "$picture")" png "$picture"; done <"$work/pictures"
    names+=("$name")
done
# In one process: it takes longer to begin than to look at a file.
"$python" - "$work" "${names[@]}" >"$work/opened" 2>"$work/not_opened" <<'END'
import sys, traceback, xarray
for name in sys.argv[2:]:
    try:
        with xarray.open_dataset(f"{sys.argv[1]}/{name}.h5") as d:
            assert (d.status == 1).all()
            assert d.status.dims == d.outcome.dims
            print(name)
    except Exception:
        print(name, traceback.format_exc(), file=sys.stderr)
END
opened() { grep -qx "$1" "$work/opened" || { cat "$work/not_opened" && false; }; }
for name in "${names[@]}"; do check "$name: xarray opens it" opened "$name"; done

# ---- large jobs ----
check "a schedule of 1e10 cases, simulated" sh -c "'$build/tests/bench_schedule' '$work/basin_one_foot.h5' \
    >'$work/schedule.csv' && '$python' -c \"
import csv
rows = {int(row['ranks']): row for row in csv.DictReader(open('$work/schedule.csv'))}
assert len(rows) == 7 and all(int(row['cases']) == 10**10 for row in rows.values())
assert float(rows[1024]['efficiency']) > 0.95 and float(rows[16384]['efficiency']) > 0.7\""
check "1e9 and 1e10 cases are planned in 200 MB" "$python" -c "
import resource, subprocess, sys
for n in 32768, 100000:
    for command in ['check'], ['run', '--dry-run']:
        out = subprocess.run([sys.argv[1], *command, 'scenarios/basin_one_foot.yaml', '--set',
                              f'sweep.grid[0].count={n}', '--set', f'sweep.grid[1].count={n}'],
                             check=True, capture_output=True, text=True).stdout
        assert f'{n * n} cases' in out, out
assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 200e3" "$stance"

# ---- studies of the methods ----
for scenario in scenarios/{accuracy,failure,mechanisms,truth}/*.yaml; do
    [ "$scenario" = scenarios/truth/truths.yaml ] || check "$(basename "$(dirname "$scenario")"), $(basename "$scenario" .yaml): check" "$stance" check "$scenario"
done
block=$work/block.yaml # two starts of its eight: event-driven, which is interpreted, would take long
sed 's/count: 8/count: 2/' scenarios/accuracy/block.yaml >"$block"
check "bench accuracy" "$stance" bench accuracy "$block" -o "$work/accuracy"
check "bench accuracy: picture" png "$work/accuracy/block.png"
check "bench accuracy --json" sh -c "'$stance' bench accuracy --reuse --json '$block' \
    -o '$work/accuracy' >'$work/accuracy.json'"
check "observed orders" "$python" -c "
import json, sys
orders = {o['method']: o['position'] for o in json.load(open(sys.argv[1]))['studies'][0]['orders']}
assert 0.8 < orders['implicit'] < 1.2 and orders['midpoint'] > 0.9, orders
assert orders['lagrange'] > 3.5 and 0.6 < orders['capturing'] < 1.3, orders" "$work/accuracy.json"
mkdir "$work/other" && sed 's/^title.*/title: Another block/' "$block" >"$work/other/block.yaml"
refused() { # name, code, words, arguments of bench accuracy ...: before anything is simulated
    local name=$1 code=$2 words=$3 said status
    shift 3
    said=$("$stance" bench accuracy "$@" 2>&1)
    status=$?
    check "bench accuracy: $name" test "$status $said" = "$code $words"
}
refused "one is no study" 2 "stance bench accuracy: scenarios/ball_bounce.yaml: the first axis does not vary method.name" \
    scenarios/accuracy/ball.yaml scenarios/ball_bounce.yaml -o "$work/accuracy"
refused "one is missing" 3 "nosuch.yaml: No such file or directory" scenarios/accuracy/ball.yaml nosuch.yaml -o "$work/accuracy"
refused "two of a name" 2 "stance bench accuracy: $block and $work/other/block.yaml would write the same files" \
    "$block" "$work/other/block.yaml" -o "$work/accuracy"
refused "another's file" 3 "stance bench accuracy: $work/other/block.yaml: $work/accuracy/block.h5 is of another scenario" \
    "$work/other/block.yaml" -o "$work/accuracy" --reuse
check "... nothing was simulated" test ! -e "$work/accuracy/ball.h5"

# Cells of a grid are counted: no interval, and none that are unlike is fewer than one.
sed 's/- \[\(implicit\|lagrange\|capturing\).*//; s/count: 64/count: 6/; s/^title.*/title: Few cells/' \
    scenarios/accuracy/basin_one_foot.yaml >"$work/few_cells.yaml"
check "bench accuracy: labels" sh -c "'$stance' bench accuracy '$work/few_cells.yaml' -o '$work/accuracy' \
    >'$work/labels.txt'"
check "... counts" grep -Eq '^  midpoint .* [0-9]+ of 36 +[0-9.]+ % +0$' "$work/labels.txt"
check "... no intervals" sh -c "! grep -Eq 'interval|\.\.\.' '$work/labels.txt'"
check "... picture" png "$work/accuracy/few_cells.png"

# ---- an answer as a picture; what summary tells of the controllers ----
check "plot --answer" "$stance" plot "$work/friction_needed.h5" --answer friction_used --of stabilised -o "$work"
check "plot --answer: map" png "$work/friction_needed-friction_used.png"
check "plot --answer: one axis" "$stance" plot "$work/ball_bounce.h5" --answer steps -o "$work"
check "plot --answer: curve" png "$work/ball_bounce-steps.png"
check "plot --answer: no such" exits 2 "$stance" plot "$work/friction_needed.h5" --answer nonsense -o "$work"
check "... names those there are" grep -q friction_used "$work/last"
check "plot --answer: a code" exits 2 "$stance" plot "$work/friction_needed.h5" --answer outcome -o "$work"
check "plot --of: no such" exits 2 "$stance" plot "$work/friction_needed.h5" --answer steps --of failed -o "$work"
check "plot --of alone" exits 2 "$stance" plot "$work/friction_needed.h5" --of fell -o "$work"
check "plot --answer: nobody has one" exits 3 "$stance" plot "$work/ball_bounce.h5" --answer settle_time --of fell -o "$work"
check "summary tells the decoupling law" sh -c "'$stance' summary '$work/walk_attempt.h5' |
    tr '\n' ' ' | tr -s ' ' | grep -q 'controlled x-theta, proportional.x 75 1/s^2, proportional.theta 50 1/s^2'"
check "summary tells the switching law" sh -c "'$stance' summary '$work/switching.h5' |
    tr '\n' ' ' | tr -s ' ' | grep -q 'design place, design_time continuous, far hold, kp 100 N m/rad'"
check "summary: two parameters at once" "$python" -c "
import json, subprocess, sys, h5py
stance, path = sys.argv[1:]
pairs = json.loads(subprocess.run([stance, 'summary', '--json', path], capture_output=True).stdout)['pairs']
assert pairs['paths'] == ['controller.design', 'controller.design_time']
want = (h5py.File(path)['outcome'][...] == 1).mean(axis=(2, 3))
assert pairs['share'] == want.tolist(), (pairs, want)" "$stance" "$work/gain_choice_sampled.h5"
check "friction that sufficed suffices" sh -c "'$stance' run scenarios/controllers/friction_needed.yaml \
    --set ground.friction=0.402 --set 'sweep.grid[0].count=13' --set 'sweep.grid[1].count=13' --quiet -o '$work/enough.h5' &&
    '$python' -c \"
import h5py
a, b = h5py.File('$work/friction_needed.h5'), h5py.File('$work/enough.h5')
recovers = a['outcome'][...] == 1
assert recovers.sum() > 20 and a['friction_used'][...][recovers].max() < 0.402
for k in ('final_state', 'settle_time', 'least_normal_force'):
    assert (a[k][...][recovers] == b[k][...][recovers]).all(), k\""

# ---- outcomes ----
outcome() { "$python" -c "
import sys, h5py
f = h5py.File(sys.argv[1]); assert (f['outcome'][...] == int(sys.argv[2])).all(), f['outcome'][...]" "$1" "$2"; }
check "section 3.2, test 1 recovers" outcome "$work/balance_recovers.h5" 1
check "section 3.2, test 2 falls" outcome "$work/balance_falls.h5" 2
check "section 3.4 ends in a fall" outcome "$work/walk_attempt.h5" 2
check "section 3.4: phases" "$python" -c "
import sys, h5py
t = h5py.File(sys.argv[1])['trajectory']
time, load = t['time'][...], t['force'][0, :, :, 0]
first = lambda foot, after: time[(load[:, foot] > 1) & (time > after)][0]
assert abs(first(0, 0) - 0.010) < 0.003 and abs(first(1, 0) - 0.366) < 0.01
assert abs(first(1, 0.7) - 0.852) < 0.03, first(1, 0.7)
assert (load[(time > 0.92) & (time < 1.0)] == 0).all()" "$work/walk_attempt.h5"
check "section 2.4 ends at rest" outcome "$work/drop.h5" 3
check "the scuffing free foot costs domain" "$python" -c "
import sys, h5py
one, both = (h5py.File(f)['outcome'][...] for f in sys.argv[1:])
assert (both == 1).sum() < 0.5 * (one == 1).sum() and not (both == 3).any()" \
    "$work/basin_one_foot.h5" "$work/basin_both_feet.h5"

# ---- ranks ----
for ranks in 2 3 5; do
    check "run on $ranks ranks" mpirun -n $ranks "$stance" run scenarios/basin_both_feet.yaml --quiet \
        --set 'sweep.grid[0].count=24' --set 'sweep.grid[1].count=24' -o "$work/ranks$ranks.h5"
    check "$ranks ranks: compare says identical" "$stance" compare "$work/basin_both_feet.h5" "$work/ranks$ranks.h5"
done
check "compare sees a difference" exits 1 "$stance" compare "$work/basin_both_feet.h5" "$work/basin_one_foot.h5"
check "compare --json" sh -c "'$stance' compare --json '$work/drop.h5' '$work/drop.h5' | '$python' -m json.tool"

# ---- instruction sets ----
mapfile -t sets < <("$stance" --version | sed -n 's/^instruction sets \(.*\); in use: .*/\1/p' | tr -d ' ' | tr , '\n')
check "--version tells the instruction sets" test ${#sets[@]} -ge 1
names_set() { "$python" -c "
import sys, h5py
assert h5py.File(sys.argv[1]).attrs['instruction_set'] in (sys.argv[2], sys.argv[2].encode())" "$1" "$2"; }
fastest=$("$stance" --version | sed -n 's/.*in use: //p')
for set in "${sets[@]}"; do
    built=$set # with lanes: `make ISAS=all` has all, else what is not compiled for the scene has the most
    ((${#sets[@]} > 2)) || built=$fastest
    check "$set: --version" sh -c "STANCE_ISA=$set '$stance' --version | grep -q 'in use: $set\$'"
    for name in drop basin_both_feet walk_attempt; do
        reduce=()
        [ $name = basin_both_feet ] && reduce=(--set 'sweep.grid[0].count=24' --set 'sweep.grid[1].count=24')
        check "$set: run $name" env STANCE_ISA="$set" "$stance" run scenarios/$name.yaml "${reduce[@]}" --quiet \
            -o "$work/$name-$set.h5"
        check "$set: the file says so" names_set "$work/$name-$set.h5" "$built"
        check "$set: compare says identical" "$stance" compare "$work/$name.h5" "$work/$name-$set.h5"
    done
done
for command in check design run; do
    check "$command: an unknown instruction set" exits 2 env STANCE_ISA=mmx "$stance" $command scenarios/drop.yaml
    check "... one line that names those there are" sh -c "[ \$(wc -l <'$work/last') = 1 ] &&
        grep -q \"STANCE_ISA is 'mmx'.*${sets[0]}\" '$work/last'"
done
for command in bench 'bench accuracy' 'bench failure'; do
    check "$command: an unknown instruction set" exits 2 env STANCE_ISA=mmx "$stance" $command
done
check "two ranks: an unknown instruction set" exits 2 env STANCE_ISA=mmx mpirun -n 2 "$stance" run scenarios/drop.yaml
check "... said once" sh -c "[ \$(grep -c STANCE_ISA '$work/last') = 1 ]"

# ---- one case again ----
cd "$work" || exit 1
check "--only --trace" "$stance" run "$OLDPWD/scenarios/basin_one_foot.yaml" --only 300 --trace \
    --set 'sweep.grid[0].count=24' --set 'sweep.grid[1].count=24' --quiet
check "--only gives the sweep's answers" "$python" -c "
import h5py, numpy
a, b = h5py.File('basin_one_foot.h5'), h5py.File('results/basin_one_foot-case300.h5')
for k in ('outcome', 'end_time', 'steps', 'friction_used'):
    assert a[k][...].ravel()[300] == b[k][...].ravel()[0], k
assert numpy.isfinite(b['trajectory/position'][0, 0]).all()"
check "plot of one case" "$stance" plot results/basin_one_foot-case300.h5 -o .
check "... says which" grep -q 'initial.offset.theta = -0.026087 rad' \
    basin_one_foot-case300-coordinates.svg
check "... in six digits" sh -c "! grep -hE '<text>.*[0-9.]{9,}' basin_one_foot-case300-*.svg"
cd "$OLDPWD" || exit 1

# ---- bad scenarios: one line, exit code 2, no file ----
refused() {
    mkdir "$work/refused" && "$stance" run "$1" -o "$work/refused/out.h5" >"$work/o" 2>"$work/e"
    local code=$? lines files
    lines=$(wc -l <"$work/e") files=$(ls "$work/refused" | wc -l)
    rm -rf "$work/refused"
    [ $code = 2 ] && [ "$lines" = 1 ] && [ "$files" = 0 ] && grep -qE "^$1:[0-9]+:[0-9]+: ." "$work/e"
}
for bad in tests/bad/*.yaml; do check "refused: $(basename "$bad" .yaml)" refused "$bad"; done

# ---- design, describe, help, bad use ----
check "design" "$stance" design scenarios/balance_recovers.yaml
check "design prints T*" grep -q 0.1363 "$work/last"
check "design --json" sh -c "'$stance' design --json scenarios/balance_recovers.yaml | '$python' -m json.tool"
check "design --json: sampled, late, T*" sh -c "'$stance' design --json scenarios/balance_recovers.yaml \
    --set controller.delay=1 --set controller.design_time=sampled | '$python' -c '
import json, sys
c = json.load(sys.stdin)[\"controller\"]
assert c[\"design\"] == \"place\" and c[\"design_time\"] == \"sampled\" and c[\"stable\"]
assert len(c[\"sampled_loop\"][\"eigenvalues\"]) == 8 and c[\"sampled_loop\"][\"delay\"] == 1
assert 0.9 < c[\"sampled_loop\"][\"spectral_radius\"] < 1 and c[\"lyapunov\"] is None
assert c[\"critical_sample_time_delayed\"] < c[\"critical_sample_time\"]'"
check "design --json: what any controller is allowed" sh -c "'$stance' design --json scenarios/balance_recovers.yaml | '$python' -c '
import json, sys
a = json.load(sys.stdin)[\"allowed\"]
assert abs(a[\"low\"][\"theta\"] + 0.20485) < 1e-5 and abs(a[\"high\"][\"theta\"] - 0.11614) < 1e-5
assert [round(re, 3) for re, im in a[\"unstable_modes\"]] == [5.616, 3.601]'"
check "design --json: the set within bounds" sh -c "'$stance' design --json scenarios/balance_recovers.yaml | '$python' -c '
import json, sys
s = json.load(sys.stdin)[\"controller\"][\"lyapunov\"]
assert s[\"sampled\"] and s[\"level\"] > 0 and s[\"binding\"].startswith(\"torque limit of hip1\")
assert all(0 < s[\"alone\"][k] <= s[\"extent\"][k] for k in s[\"alone\"]) and len(s[\"P\"]) == 6'"
check "describe" "$stance" describe
check "describe controller.poles" "$stance" describe controller.poles
check "describe --schema" sh -c "'$stance' describe --schema | '$python' -m json.tool"
check "bench" "$stance" bench --repeats 1 --cases 8
check "bench --json" sh -c "'$stance' bench --json --repeats 1 --cases 8 --scene biped --method implicit | '$python' -c '
import json, sys
rows = json.load(sys.stdin)
assert {r[\"regime\"] for r in rows} == {\"flight\", \"one foot\", \"two feet\"}
assert all(r[\"ns_min\"] <= r[\"ns_per_step\"] <= r[\"ns_max\"] and r[\"failed\"] == 0 for r in rows)
assert all(r[\"steps\"] == 8000 and abs(r[\"ns_per_second\"] / r[\"ns_per_step\"] - 1000) < 1e-6 for r in rows)'"
check "bench --csv" sh -c "'$stance' bench --csv --repeats 1 --cases 8 --scene biped --method implicit >'$work/speed.csv'"
check "bench --csv: one width" sh -c "awk -F, 'NF != 21 {exit 1}' '$work/speed.csv'"
check "bench: one instruction set" sh -c "STANCE_ISA=scalar '$stance' bench --repeats 1 --cases 8 --scene biped --regime flight --method event-driven \
    | awk 'NR > 2 && \$4 != \"scalar\" {exit 1} END {exit NR != 3}'"
check "bench: no such regime" exits 2 "$stance" bench --scene biped --regime 'three feet'
check "bench plot" "$stance" bench plot "$work/speed.csv" -o "$work"
check "bench plot: picture" png "$work/speed.png"
check "bench plot: not a table" exits 3 "$stance" bench plot Makefile
cat >"$work/pair.yaml" <<'EOF'
stance: 1
scene: biped
initial: {state: {z: 1.5}}
controller:
  kind: decoupling
  controlled: x-z
  sample_time: 0.01
stop: {time: 0.05}
EOF
for command in check design run; do
    check "$command: a pair that is singular at the start" exits 2 "$stance" "$command" "$work/pair.yaml"
    check "$command: at its place in the file" grep -q 'pair.yaml:6:3: controller.controlled: x-z is singular in the initial posture' "$work/last"
done
check "design: coordinates under the decoupling law" "$stance" design "$work/pair.yaml" --set controller.controlled=x-q1
check "design: marks the scenario's" grep -q '[*] x-q1 .*on a surface' "$work/last"
check "design --json: selections" sh -c "'$stance' design --json '$work/pair.yaml' --set controller.controlled=theta-q1 | '$python' -c '
import json, sys
pairs = json.load(sys.stdin)[\"selections\"]
assert len(pairs) == 10 and sum(p[\"singular\"] for p in pairs) == 7
assert [p[\"coordinates\"] for p in pairs if p[\"controlled\"]] == [\"theta-q1\"]'"
check "run: decoupling" "$stance" run "$work/pair.yaml" --set controller.controlled=x-q1 --quiet -o "$work/pair.h5"
check "summary names the law" sh -c "'$stance' summary '$work/pair.h5' | grep -q 'kind decoupling'"

# ---- export; what MuJoCo makes of it is checked in test_export ----
check "export" "$stance" export --mjcf scenarios/mechanisms/rabbit.yaml -o "$work/rabbit.xml"
check "export: well-formed, with all joints" sh -c "'$python' -c '
import sys, xml.etree.ElementTree as tree
root = tree.parse(sys.argv[1]).getroot()
assert len(list(root.iter(\"joint\"))) == 7 and len(list(root.iter(\"motor\"))) == 4' '$work/rabbit.xml'"
check "export: standard output, --set" sh -c "'$stance' export --mjcf scenarios/mechanisms/rabbit.yaml --set ground.slope=0.1 | grep -q zaxis=.0.0998"
check "export: no format" exits 2 "$stance" export scenarios/mechanisms/rabbit.yaml
check "export: what the program carries" sh -c "'$stance' export --mjcf scenarios/drop.yaml | grep -q \"joint name='theta'\""
check "export: no such scenario" exits 3 "$stance" export --mjcf "$work/nothing.yaml"
check "export: cannot write" exits 3 "$stance" export --mjcf scenarios/mechanisms/rabbit.yaml -o "$work/nowhere/x.xml"

for command in check design build export run status summary plot replay compare describe bench; do
    check "$command -h" "$stance" $command -h
    check "$command rejects nonsense" exits 2 "$stance" $command --nonsense
done
check "unknown command" exits 2 "$stance" sumary "$work/drop.h5"
check "names the nearest" grep -q summary "$work/last"
for command in summary plot status; do
    check "$command: no such file" exits 3 "$stance" $command "$work/nothing.h5"
    check "$command: not a results file" exits 3 "$stance" $command Makefile
done
head -c 3000 "$work/basin_one_foot.h5" >"$work/cut.h5"
for command in summary plot status; do
    check "$command: a cut file" exits 3 "$stance" $command "$work/cut.h5"
done

# ---- output that goes nowhere ----
unheard() { # where, command ...: exit code 3 and one line
    local where=$1
    shift
    if [ "$where" = closed ]; then "$@" >&- 2>"$work/heard"; else "$@" >/dev/full 2>"$work/heard"; fi
    local code=$?
    [ $code = 3 ] && [ "$(wc -l <"$work/heard")" = 1 ]
}
for where in closed full; do
    check "summary, output $where" unheard $where "$stance" summary "$work/drop.h5"
    check "summary --json, output $where" unheard $where "$stance" summary --json "$work/drop.h5"
    check "compare, output $where" unheard $where "$stance" compare "$work/drop.h5" "$work/drop.h5"
    check "compare that differs, output $where" \
        unheard $where "$stance" compare "$work/drop.h5" "$work/basin_one_foot.h5"
    check "plot, output $where" unheard $where "$stance" plot "$work/drop.h5" -o "$work"
    check "status, output $where" unheard $where "$stance" status "$work/drop.h5"
    check "describe --schema, output $where" unheard $where "$stance" describe --schema
    check "run, output $where" unheard $where "$stance" run scenarios/drop.yaml -o "$work/unheard.h5" --force
done
quiet() { "$stance" run scenarios/drop.yaml -o "$work/unheard.h5" --force --quiet >&- 2>&- <&-; }
check "run --quiet needs no streams" quiet
check "... and writes what it should" "$stance" compare "$work/drop.h5" "$work/unheard.h5"
check "run -h tells of symbolic links" sh -c "'$stance' run -h | grep -q 'symbolic link'"
echo "1..$count"
