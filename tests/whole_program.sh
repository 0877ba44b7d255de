#!/usr/bin/env bash
# Every shipped scenario, reduced, from file to picture; the commands' messages and exit codes;
# equal results whatever the ranks; results opened by other programs' readers.
build=$(cd "$(dirname "$0")/../${BUILD:-build}" && pwd)
. "$(dirname "$0")/scratch.sh"
png() { # is it a picture of a sensible size?
    [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] && [ "$(stat -c %s "$1")" -gt 5000 ]
}

# ---- every shipped scenario, and the studies of the controllers ----
names=()
for scenario in "$shipped"/*.yaml "$shipped"/controllers/*.yaml; do
    name=$(basename "$scenario" .yaml) reduce=()
    case $name in # axes of the grid and their points
    basin_refined) few="0:64 1:64" ;;
    basin_*) few="0:24 1:24" ;;
    *_sweep | gain_choice | friction_check | switching*) few="1:9 2:9" ;;
    gain_choice_sampled | walk_gains) few="2:5 3:5" ;;
    friction | noise | torque_limit | torque_rate | friction_needed) few="0:13 1:13" ;;
    delay | lag | sensors) few="1:13 2:13" ;;
    sampled) few=sample:100 ;;
    what_decides) few="0:4 1:4 sample:8" ;;
    topple) few="0:65 sample:40" ;;
    decoupling_*) few=1:7 ;;
    *) few= ;;
    esac
    for axis in $few; do
        place="grid[${axis%:*}]"
        [[ $axis == sample* ]] && place=sample
        reduce+=(--set "sweep.$place.count=${axis#*:}")
    done
    expect "$name: check" 0 "$stance" check "$scenario"
    expect "$name: run" 0 "$stance" run "$scenario" "${reduce[@]}" --quiet -o "$name.h5"
    expect "$name: summary" 0 "$stance" summary "$name.h5"
    expect "$name: summary --json" 0 "$stance" summary --json "$name.h5" is "$python" -m json.tool log
    expect "$name: plot" 0 "$stance" plot "$name.h5" -o . tells '\.png$'
    while read -r picture; do is "$(basename "$picture")" png "$picture"; done < <(grep '\.png$' log)
    names+=("$name")
done
# In one process: it takes longer to begin than to look at a file.
"$python" - "${names[@]}" >opened 2>not_opened <<'END'
import sys, traceback, xarray
for name in sys.argv[1:]:
    try:
        with xarray.open_dataset(f"{name}.h5") as d:
            assert (d.status == 1).all()
            assert d.status.dims == d.outcome.dims
            print(name)
    except Exception:
        print(name, traceback.format_exc(), file=sys.stderr)
END
mv not_opened log
for name in "${names[@]}"; do is "$name: xarray opens it" grep -qx "$name" opened; done

# ---- large jobs ----
is "a schedule of 1e10 cases, simulated" "$build/tests/bench_schedule basin_one_foot.h5 >schedule.csv"
holds "... as efficient as it should be" 'rows = {int(row["ranks"]): row for row in table("schedule.csv")}
assert len(rows) == 7 and all(int(row["cases"]) == 10**10 for row in rows.values())
assert float(rows[1024]["efficiency"]) > 0.95 and float(rows[16384]["efficiency"]) > 0.7'
holds "1e9 and 1e10 cases are planned in 200 MB" - "$stance" "$shipped" <<'END'
import resource
for n in 32768, 100000:
    for command in ["check"], ["run", "--dry-run"]:
        out = subprocess.run([sys.argv[1], *command, sys.argv[2] + "/basin_one_foot.yaml", "--set",
                              f"sweep.grid[0].count={n}", "--set", f"sweep.grid[1].count={n}"],
                             check=True, capture_output=True, text=True).stdout
        assert f"{n * n} cases" in out, out
assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 200e3
END

# ---- studies of the methods ----
for scenario in "$shipped"/{accuracy,failure,mechanisms,truth}/*.yaml; do
    [[ $scenario == */truths.yaml ]] || expect "${scenario#"$shipped"/}: check" 0 "$stance" check "$scenario"
done
# Two starts of its eight: event-driven, which is interpreted, would take long.
sed 's/count: 8/count: 2/' "$shipped/accuracy/block.yaml" >block.yaml
expect "bench accuracy" 0 "$stance" bench accuracy block.yaml -o accuracy is png accuracy/block.png
expect "bench accuracy --json" 0 bash -c "$stdout_alone" - "$stance" bench accuracy --reuse --json block.yaml -o accuracy \
    holds 'orders = {o["method"]: o["position"] for o in said()["studies"][0]["orders"]}
assert 0.8 < orders["implicit"] < 1.2 and orders["midpoint"] > 0.9, orders
assert orders["lagrange"] > 3.5 and 0.6 < orders["capturing"] < 1.3, orders'
mkdir other && sed 's/^title.*/title: Another block/' block.yaml >other/block.yaml
refused() { # name, code, words, arguments of bench accuracy ...: before anything is simulated
    expect "bench accuracy: $1" "$2" "$stance" bench accuracy "${@:4}" lines 1 is grep -qxF "$3" log
}
ball=$shipped/accuracy/ball.yaml other=$shipped/ball_bounce.yaml
refused "one is no study" 2 "stance bench accuracy: $other: the first axis does not vary method.name" "$ball" "$other" \
    -o accuracy
refused "one is missing" 3 "nosuch.yaml: No such file or directory" "$ball" nosuch.yaml -o accuracy
refused "two of a name" 2 "stance bench accuracy: block.yaml and other/block.yaml would write the same files" \
    block.yaml other/block.yaml -o accuracy
refused "another's file" 3 "stance bench accuracy: other/block.yaml: accuracy/block.h5 is of another scenario" \
    other/block.yaml -o accuracy --reuse
is "... nothing was simulated" [ ! -e accuracy/ball.h5 ]

# Cells of a grid are counted: no interval, and none that are unlike is fewer than one.
sed 's/- \[\(implicit\|lagrange\|capturing\).*//; s/count: 64/count: 6/; s/^title.*/title: Few cells/' \
    "$shipped/accuracy/basin_one_foot.yaml" >few_cells.yaml
expect "bench accuracy: labels" 0 "$stance" bench accuracy few_cells.yaml -o accuracy \
    tells '^  midpoint .* [0-9]+ of 36 +[0-9.]+ % +0$' is ! grep -q 'interval\|\.\.\.' log \
    is png accuracy/few_cells.png

# ---- an answer as a picture; what summary tells of the controllers ----
expect "plot --answer" 0 "$stance" plot friction_needed.h5 --answer friction_used --of stabilised -o . \
    is png friction_needed-friction_used.png
expect "plot --answer: one axis" 0 "$stance" plot ball_bounce.h5 --answer steps -o . is png ball_bounce-steps.png
expect "plot --answer: no such" 2 "$stance" plot friction_needed.h5 --answer nonsense -o . tells friction_used
expect "plot --answer: a code" 2 "$stance" plot friction_needed.h5 --answer outcome -o .
expect "plot --of: no such" 2 "$stance" plot friction_needed.h5 --answer steps --of failed -o .
expect "plot --of alone" 2 "$stance" plot friction_needed.h5 --of fell -o .
expect "plot --answer: nobody has one" 3 "$stance" plot ball_bounce.h5 --answer settle_time --of fell -o .
summary_tells() { # law, file, words: in the summary, its lines joined
    "$stance" summary "$2" >log 2>&1
    tr -s '\n ' '  ' <log | grep -q "$3"
    result $? "summary tells the $1 law"
}
summary_tells decoupling walk_attempt.h5 'controlled x-theta, proportional.x 75 1/s^2, proportional.theta 50 1/s^2'
summary_tells switching switching.h5 'design place, design_time continuous, far hold, kp 100 N m/rad'
expect "summary: two parameters at once" 0 "$stance" summary --json gain_choice_sampled.h5 holds '
pairs = said()["pairs"]
assert pairs["paths"] == ["controller.design", "controller.design_time"]
want = (h5py.File("gain_choice_sampled.h5")["outcome"][...] == 1).mean(axis=(2, 3))
assert pairs["share"] == want.tolist(), (pairs, want)'
expect "friction that sufficed suffices" 0 "$stance" run "$shipped/controllers/friction_needed.yaml" -o enough.h5 \
    --set ground.friction=0.402 --set 'sweep.grid[0].count=13' --set 'sweep.grid[1].count=13' --quiet holds '
a, b = h5py.File("friction_needed.h5"), h5py.File("enough.h5")
recovers = a["outcome"][...] == 1
assert recovers.sum() > 20 and a["friction_used"][...][recovers].max() < 0.402
for k in ("final_state", "settle_time", "least_normal_force"):
    assert (a[k][...][recovers] == b[k][...][recovers]).all(), k'

# ---- outcomes ----
outcome() { # name, file, code
    holds "$1" 'found = h5py.File(sys.argv[1])["outcome"][...]
assert (found == int(sys.argv[2])).all(), found' "$2" "$3"
}
outcome "section 3.2, test 1 recovers" balance_recovers.h5 1
outcome "section 3.2, test 2 falls" balance_falls.h5 2
outcome "section 3.4 ends in a fall" walk_attempt.h5 2
outcome "section 2.4 ends at rest" drop.h5 3
holds "section 3.4: phases" 't = h5py.File("walk_attempt.h5")["trajectory"]
time, load = t["time"][...], t["force"][0, :, :, 0]
first = lambda foot, after: time[(load[:, foot] > 1) & (time > after)][0]
assert abs(first(0, 0) - 0.010) < 0.003 and abs(first(1, 0) - 0.366) < 0.01
assert abs(first(1, 0.7) - 0.852) < 0.03, first(1, 0.7)
assert (load[(time > 0.92) & (time < 1.0)] == 0).all()'
holds "the scuffing free foot costs domain" '
one, both = (h5py.File(f)["outcome"][...] for f in ("basin_one_foot.h5", "basin_both_feet.h5"))
assert (both == 1).sum() < 0.5 * (one == 1).sum() and not (both == 3).any()'

# ---- ranks ----
small=(--set 'sweep.grid[0].count=24' --set 'sweep.grid[1].count=24' --quiet)
for ranks in 2 3 5; do
    expect "run on $ranks ranks" 0 mpirun -n $ranks "$stance" run "$shipped/basin_both_feet.yaml" "${small[@]}" \
        -o ranks$ranks.h5 as basin_both_feet.h5
done
expect "compare sees a difference" 1 "$stance" compare basin_both_feet.h5 basin_one_foot.h5
expect "compare --json" 0 "$stance" compare --json drop.h5 drop.h5 is "$python" -m json.tool log

# ---- instruction sets ----
mapfile -t sets < <("$stance" --version | sed -n 's/^instruction sets \(.*\); in use: .*/\1/p' | tr -d ' ' | tr , '\n')
is "--version tells the instruction sets" [ ${#sets[@]} -ge 1 ]
fastest=$("$stance" --version | sed -n 's/.*in use: //p')
for set in "${sets[@]}"; do
    built=$set # with lanes: `make ISAS=all` has all, else what is not compiled for the scene has the most
    ((${#sets[@]} > 2)) || built=$fastest
    STANCE_ISA=$set expect "$set: --version" 0 "$stance" --version tells "in use: $set\$"
    for name in drop basin_both_feet walk_attempt; do
        reduce=(--quiet)
        [ $name = basin_both_feet ] && reduce=("${small[@]}")
        STANCE_ISA=$set expect "$set: run $name" 0 "$stance" run "$shipped/$name.yaml" "${reduce[@]}" \
            -o "$name-$set.h5" as $name.h5
        holds "$set: the file says so" 'assert h5py.File(sys.argv[1]).attrs["instruction_set"] in (sys.argv[2],
            sys.argv[2].encode())' "$name-$set.h5" "$built"
    done
done
for command in check design run; do
    STANCE_ISA=mmx expect "$command: an unknown instruction set" 2 "$stance" $command "$shipped/drop.yaml" lines 1 \
        tells "STANCE_ISA is 'mmx'.*${sets[0]}"
done
for command in bench 'bench accuracy' 'bench failure'; do
    # shellcheck disable=SC2086
    STANCE_ISA=mmx expect "$command: an unknown instruction set" 2 "$stance" $command
done
STANCE_ISA=mmx expect "two ranks: an unknown instruction set" 2 mpirun -n 2 "$stance" run "$shipped/drop.yaml" \
    says STANCE_ISA

# ---- one case again ----
expect "--only --trace" 0 "$stance" run "$shipped/basin_one_foot.yaml" --only 300 --trace "${small[@]}" holds '
a, b = h5py.File("basin_one_foot.h5"), h5py.File("results/basin_one_foot-case300.h5")
for k in ("outcome", "end_time", "steps", "friction_used"):
    assert a[k][...].ravel()[300] == b[k][...].ravel()[0], k
assert numpy.isfinite(b["trajectory/position"][0, 0]).all()'
expect "plot of one case" 0 "$stance" plot results/basin_one_foot-case300.h5 -o . \
    is grep -q 'initial.offset.theta = -0.026087 rad' basin_one_foot-case300-coordinates.svg
is "... in six digits" '! grep -hE "<text>.*[0-9.]{9,}" basin_one_foot-case300-*.svg'

# ---- bad scenarios: one line, exit code 2, no file ----
for bad in "$tests"/bad/*.yaml; do
    mkdir refused
    expect "refused: $(basename "$bad" .yaml)" 2 bash -c "$stderr_alone" - "$stance" run "$bad" -o refused/out.h5 lines 1 is [ ! -s out ] \
        is grep -qE "^$bad:[0-9]+:[0-9]+: ." log is rmdir refused
done

# ---- design, describe, help, bad use ----
recovers=$shipped/balance_recovers.yaml
expect "design" 0 "$stance" design "$recovers" tells 0.1363
expect "design --json: sampled, late, T*" 0 "$stance" design --json "$recovers" --set controller.delay=1 \
    --set controller.design_time=sampled holds 'c = said()["controller"]
assert c["design"] == "place" and c["design_time"] == "sampled" and c["stable"]
assert len(c["sampled_loop"]["eigenvalues"]) == 8 and c["sampled_loop"]["delay"] == 1
assert 0.9 < c["sampled_loop"]["spectral_radius"] < 1 and c["lyapunov"] is None
assert c["critical_sample_time_delayed"] < c["critical_sample_time"]'
expect "design --json: what any controller is allowed, a set within bounds" 0 "$stance" design --json "$recovers" holds '
a, s = said()["allowed"], said()["controller"]["lyapunov"]
assert abs(a["low"]["theta"] + 0.20485) < 1e-5 and abs(a["high"]["theta"] - 0.11614) < 1e-5
assert [round(re, 3) for re, im in a["unstable_modes"]] == [5.616, 3.601]
assert s["sampled"] and s["level"] > 0 and s["binding"].startswith("torque limit of hip1")
assert all(0 < s["alone"][k] <= s["extent"][k] for k in s["alone"]) and len(s["P"]) == 6'
expect "describe" 0 "$stance" describe
expect "describe controller.poles" 0 "$stance" describe controller.poles
expect "describe --schema" 0 "$stance" describe --schema is "$python" -m json.tool log
expect "bench" 0 "$stance" bench --repeats 1 --cases 8
biped=(--repeats 1 --cases 8 --scene biped)
expect "bench --json" 0 "$stance" bench --json "${biped[@]}" --method implicit holds 'rows = said()
assert {r["regime"] for r in rows} == {"flight", "one foot", "two feet"}
assert all(r["ns_min"] <= r["ns_per_step"] <= r["ns_max"] and r["failed"] == 0 for r in rows)
assert all(r["steps"] == 8000 and abs(r["ns_per_second"] / r["ns_per_step"] - 1000) < 1e-6 for r in rows)'
expect "bench --csv: one width" 0 "$stance" bench --csv "${biped[@]}" --method implicit \
    is awk -F, 'NF != 21 {exit 1}' log
cp log speed.csv
STANCE_ISA=scalar expect "bench: one instruction set" 0 "$stance" bench "${biped[@]}" --regime flight \
    --method event-driven is awk 'NR > 2 && $4 != "scalar" {exit 1} END {exit NR != 3}' log
expect "bench: no such regime" 2 "$stance" bench --scene biped --regime 'three feet'
expect "bench plot" 0 "$stance" bench plot speed.csv -o . is png speed.png
expect "bench plot: not a table" 3 "$stance" bench plot "$tests/run.sh"
cat >pair.yaml <<'END'
stance: 1
scene: biped
initial: {state: {z: 1.5}}
controller:
  kind: decoupling
  controlled: x-z
  sample_time: 0.01
stop: {time: 0.05}
END
for command in check design run; do
    expect "$command: a pair that is singular at the start" 2 "$stance" "$command" pair.yaml \
        tells 'pair.yaml:6:3: controller.controlled: x-z is singular in the initial posture'
done
expect "design: coordinates under the decoupling law" 0 "$stance" design pair.yaml --set controller.controlled=x-q1 \
    tells '[*] x-q1 .*on a surface'
expect "design --json: selections" 0 "$stance" design --json pair.yaml --set controller.controlled=theta-q1 holds '
pairs = said()["selections"]
assert len(pairs) == 10 and sum(p["singular"] for p in pairs) == 7
assert [p["coordinates"] for p in pairs if p["controlled"]] == ["theta-q1"]'
expect "run: decoupling" 0 "$stance" run pair.yaml --set controller.controlled=x-q1 --quiet -o pair.h5
expect "summary names the law" 0 "$stance" summary pair.h5 tells 'kind decoupling'

# ---- export; what MuJoCo makes of it is checked in test_export ----
rabbit=$shipped/mechanisms/rabbit.yaml
expect "export" 0 "$stance" export --mjcf "$rabbit" -o rabbit.xml holds 'import xml.etree.ElementTree as tree
root = tree.parse("rabbit.xml").getroot()
assert len(list(root.iter("joint"))) == 7 and len(list(root.iter("motor"))) == 4'
expect "export: standard output, --set" 0 bash -c "$stdout_alone" - "$stance" export --mjcf "$rabbit" --set ground.slope=0.1 tells zaxis=.0.0998
expect "export: no format" 2 "$stance" export "$rabbit"
expect "export: what the program carries" 0 bash -c "$stdout_alone" - "$stance" export --mjcf "$shipped/drop.yaml" tells "joint name='theta'"
expect "export: no such scenario" 3 "$stance" export --mjcf nothing.yaml
expect "export: cannot write" 3 "$stance" export --mjcf "$rabbit" -o nowhere/x.xml

for command in check design build export run status summary plot replay compare describe bench; do
    expect "$command -h" 0 "$stance" $command -h
    expect "$command rejects nonsense" 2 "$stance" $command --nonsense
done
expect "unknown command" 2 "$stance" sumary drop.h5 tells summary
head -c 3000 basin_one_foot.h5 >cut.h5
for command in summary plot status; do
    for file in nothing.h5 "$tests/run.sh" cut.h5; do # not there, no results, a part of them
        expect "$command: ${file##*/}" 3 "$stance" $command "$file"
    done
done

# ---- output that goes nowhere ----
unheard() { # command ...: exit code 3 and one line, whether output is closed or full
    for where in '>&-' '>/dev/full'; do
        expect "$*, output $where" 3 bash -c "exec \"\$@\" $where" - "$stance" "$@" lines 1
    done
}
unheard summary drop.h5
unheard summary --json drop.h5
unheard compare drop.h5 drop.h5
unheard compare drop.h5 basin_one_foot.h5
unheard plot drop.h5 -o .
unheard status drop.h5
unheard describe --schema
unheard run "$shipped/drop.yaml" -o unheard.h5 --force
is "run --quiet needs no streams" '"$stance" run "$shipped/drop.yaml" -o unheard.h5 --force --quiet >&- 2>&- <&-'
expect "... and writes what it should" 0 "$stance" compare drop.h5 unheard.h5
expect "run -h tells of symbolic links" 0 bash -c "$stdout_alone" - "$stance" run -h tells 'symbolic link'
