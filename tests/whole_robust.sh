#!/usr/bin/env bash
# What a week on a cluster brings: crashes, signals to any rank, files that vanish, disks that fill,
# answers that rot, scenarios that change on the way. Each ends with one clear line, the right exit
# code, and every finished case in the file.
# about: runner/run analysis/summary
. "$(dirname "$0")/scratch.sh"
chmod 755 "$scratch"
# Under a sanitizer too it is the program that says where it crashed.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}handle_segv=0:handle_abort=0:handle_sigfpe=0:handle_sigbus=0
# Which of many alike are tried; STANCE_TEST_LONG: all.
crashes=(SEGV:139:3 ABRT:134:0) signals=(TERM) attempts=4 fills=(2)
losses=("0 rm folder/gone.h5" "2 mv folder moved")
if long_tests; then
    crashes+=(FPE:136:2 BUS:135:0) signals+=(INT USR1) attempts=20 fills+=(0)
    losses+=("0 mv folder moved" "0 mv folder/gone.h5 folder/moved.h5" "0 rm -r folder"
        "2 rm folder/gone.h5" "2 mv folder/gone.h5 folder/moved.h5" "2 rm -r folder")
fi

# Minutes of work on any machine, of which a file holds the first cases soon.
{
    balance 0.001 0.1
    echo 'stop: {time: 8, settle: off}'
    grid 600 600
} >long.yaml
# A second or less.
sed 's/0\.001/0.01/g; s/count: 600/count: 60/; s/stop: .*/stop: {time: 3}/' long.yaml >short.yaml
sed 's/, noise: 0.1//; s/count: 60/count: 150/' short.yaml >refined.yaml
cat >>refined.yaml <<END
  refine: {start: 16}
record: {every: 0.1, cases: [0, 1003]}
END

# ---- a rank that crashes -----------------------------------------------------------------------
for crash in "${crashes[@]}"; do
    IFS=: read -r signal code n <<<"$crash"
    with="SIG$signal $( ((n)) && echo "in one of $n ranks" || echo alone)"
    rm -f crash.h5
    begin "$n" crash.h5 long.yaml
    kill -"$signal" "${ranks[-1]}"
    ends "$with ends the job" "$code" tool whole crash.h5 \
        says "^stance run: rank $((n ? n - 1 : 0)) on $(hostname) crashed (SIG$signal), cases [0-9]*, .* in hand; "
done 2>/dev/null
expect "status tells that the job is dead" 0 "$stance" status crash.h5 \
    says "not running (the last sign of life was .* ago, on $(hostname))"

# ---- signals to one rank -----------------------------------------------------------------------
for signal in "${signals[@]}"; do
    rm -f signal.h5
    begin 3 signal.h5 long.yaml
    kill -$signal "${ranks[1]}"
    ends "SIG$signal to one rank of three stops all of them" 4 tool whole signal.h5 \
        says '^stance run: stopped at [0-9]* of 360000 cases; go on with: mpirun -n 3 '
done
# What mpirun does on SIGTERM is its own: code 1, and SIGKILL after a grace, usually of a second.
for grace in 1 10 100; do
    rm -f signal.h5
    OMPI_MCA_odls_base_sigkill_timeout=$grace begin 2 signal.h5 long.yaml
    kill -TERM "$job"
    await - gone "$job"
    grep -q '^stance run: stopped at' log && break
done
ends "SIGTERM to mpirun" 1 says '^stance run: stopped at' tool whole signal.h5 # ranks end by themselves before

# The line that goes on can be pasted into a shell.
odd="it's \$odd;.h5"
expect "a time limit" 4 mpirun -n 2 "$stance" run short.yaml -o "$odd" --time-limit 0.01s \
    --set 'stop={time: 2.5, settle: "off"}' --set "title=\"a 'b' c\""
line=$(sed -n 's/^.*; go on with: //p' log | sed 's/--time-limit 0.01s//')
expect "... and the line that it prints" 0 bash -c "$line" says ': 3600 cases: '
# Before the file there is the design, of some milliseconds on an idle machine.
for limit in 0.01s 0.1s 1s 10s; do
    "$stance" run refined.yaml -o limited.h5 --time-limit $limit >log 2>&1
    code=$?
    [ -e limited.h5 ] && break
done
is "a time limit while a map is refined" '((code == 4))'
says "... says how to go on" '; go on with: .* run refined.yaml -o limited.h5 .*--resume$'
expect "status of a map that is half refined" 0 "$stance" status limited.h5 says 'others to be simulated or inferred'
expect "... nor as JSON" 0 "$stance" status limited.h5 --json says '"pending": null'
sed 's/count: 60/count: 2000/; s/initial.offset.theta, from: -0.12, to: 0.06/robot.trunk_mass, from: 1.6, to: 2/' \
    short.yaml >designs.yaml
expect "a time limit while designs are computed" 4 mpirun -n 2 "$stance" run designs.yaml -o designs.h5 \
    --time-limit 0.05s says 'nothing is stored; go on with: mpirun -n 2 .*designs.yaml .*--resume$'
sed 's/count: 2000/count: 2000000/' designs.yaml >many.yaml
mpirun -n 3 "$stance" run many.yaml -o many.h5 --quiet >out 2>log </dev/null &
job=$!
designing() { "$stance" status many.h5 2>&1 | grep -q 'not there yet: a run is computing designs'; }
await "$job" designing
kill -USR1 "$(pgrep -P $job -x "$(basename "$stance")" | tail -n 1)"
ends "a signal to one rank while designs are computed" 4 is '[ -z "$(ls designs.h5* many.h5* 2>/dev/null)" ]' \
    says 'nothing is stored; go on with: mpirun -n 3 .*many.yaml .*--resume$'

# ---- seen from outside -------------------------------------------------------------------------
rm -f seen.h5
begin 2 seen.h5 long.yaml
rated() { "$stance" status seen.h5 --json 2>&1 | tee log | grep -q '"rate": [1-9]'; }
await "$job" rated
holds "status of a job that runs: ranks alive, rates, time left" 'd = said()
assert d["running"] and d["ranks"] == d["ranks_alive"] == 2 and d["doing"] == "computing", d
assert d["rate"] > 0 and d["mean_rate"] > 0 and d["seconds_left"] > 1 and d["last_sign"] < 60, d
assert d["done"] + d["failed"] + d["pending"] == d["cases"] == 360000, d'
# A job on another machine, whose lock is not seen here: its note is.
cp seen.h5 there.h5
sed "s/\"host\":\"[^\"]*\"/\"host\":\"elsewhere\"/; s/\"time\":[0-9.]*/\"time\":$(date +%s)/" seen.h5.lock >there.h5.lock
expect "status of a job on another machine" 0 "$stance" status there.h5 says '; running on 2 ranks of elsewhere'
sed -i 's/"time":[0-9.]*/"time":1000000000/' there.h5.lock
expect "... and by its silence" 0 "$stance" status there.h5 \
    says 'not running (the last sign of life was .* ago, on elsewhere)'
# The lock's file is removed: it is taken anew, and the job goes on.
rm seen.h5.lock
await "$job" test -e seen.h5.lock
expect "a lock that was removed is there again" 3 "$stance" run long.yaml -o seen.h5 --resume \
    says 'another process is writing it'
ln -s seen.h5 link.h5
expect "... also against who comes through a link" 3 "$stance" run long.yaml -o link.h5 --resume \
    says 'seen.h5: another process is writing it'
expect "status through the link" 0 "$stance" status link.h5 says '^link.h5: .*; running on 2 ranks'
kill -USR1 "$job"
cp log said
ends "... and the job runs on" 4

# ---- files that go away ------------------------------------------------------------------------
for loss in "${losses[@]}"; do
    n=${loss%% *} what=${loss#* }
    rm -rf folder moved && mkdir folder
    begin "$n" folder/gone.h5 long.yaml
    $what
    ends "$what ($n ranks)" 3 \
        says '^stance run: folder/gone.h5: was removed, moved or replaced while it was written'
    for left in folder/moved.h5 moved/gone.h5; do
        [ -e $left ] && tool "... and what is done is there" whole $left
    done
done

# ---- disks and permissions ---------------------------------------------------------------------
# Space that was reserved is there, whoever fills the disk; the sign of life needs no more of it.
sed 's/count: 60/count: 45/; s/0\.01/0.002/g' short.yaml >fits.yaml
echo 'record: {every: 0.5, cases: all}' >>fits.yaml
if mount -t tmpfs -o size=8m tmpfs "$disk" 2>/dev/null; then
    expect "a file for a disk" 0 "$stance" run fits.yaml -o fits.h5 --quiet
    mpirun -n 2 "$stance" run fits.yaml -o disk/fits.h5 --quiet >out 2>log </dev/null &
    job=$!
    await "$job" test -e disk/fits.h5
    dd if=/dev/zero of=disk/other bs=4k >/dev/null 2>&1
    ends "a disk that fills once the job has begun" 0 tool same fits.h5 disk/fits.h5
    umount "$disk"
else
    skip "a disk that fills once the job has begun" "cannot mount"
fi
# ext2 reserves nothing: there it does.
dd if=/dev/zero of=image bs=1M count=150 >/dev/null 2>&1
if mkfs.ext2 -q image 2>/dev/null && mount -o loop image "$disk" 2>/dev/null; then
    for n in "${fills[@]}"; do
        begin $n disk/full.h5 long.yaml
        dd if=/dev/zero of=disk/other bs=64k >/dev/null 2>&1
        ends "a disk that cannot reserve fills ($n ranks)" 3 says '^stance run: disk/full.h5: cannot write' \
            tool whole disk/full.h5
        rm -f disk/full.h5* disk/other
    done
    umount "$disk"
else
    skip "a disk that cannot reserve fills" "cannot mount"
fi
another=(setpriv --reuid=65534 --clear-groups env HOME="$scratch/open" TMPDIR="$scratch/open")
if "${another[@]}" ls "$stance" "$scratch" >/dev/null 2>&1; then
    mkdir -m 755 closed && mkdir -m 777 open
    "$stance" run short.yaml -o open/theirs.h5 --quiet
    chmod 644 open/theirs.h5
    for launch in "" "mpirun -n 2"; do
        # shellcheck disable=SC2086
        {
            expect "no permission for the directory ($launch)" 3 "${another[@]}" $launch "$stance" run short.yaml \
                -o closed/no.h5 says '^stance run: closed/no.h5: .*\(Permission denied\|not permitted\)'
            expect "no permission for the file ($launch)" 3 "${another[@]}" $launch "$stance" run short.yaml \
                -o open/theirs.h5 --resume says '^stance run: open/theirs.h5: .*Permission denied'
        }
    done
else
    skip "no permission" "cannot become somebody else, or that one cannot come here"
fi
for options in "" --force --resume; do
    # shellcheck disable=SC2086
    expect "output to /dev/full $options" 3 "$stance" run short.yaml -o /dev/full $options \
        says '^stance run: /dev/full' is [ -c /dev/full ] is [ ! -e /dev/full.lock ]
done

# ---- answers that rot --------------------------------------------------------------------------
expect "a refined map" 0 "$stance" run refined.yaml -o map.h5 --quiet
expect "a sweep" 0 "$stance" run short.yaml -o good.h5 --quiet
inferred=$("$python" -c 'import h5py; f = h5py.File("map.h5")
print((f["evidence"][...] == 2).ravel().nonzero()[0][7])')
rot() { # file, cases
    for case in "${@:2}"; do "$python" "$tests/results_tools.py" damage "$1" "$case"; done
}
cp good.h5 rot.h5 && rot rot.h5 3599 5 17
expect "summary of a file with rotten answers" 0 "$stance" summary rot.h5 \
    says 'warning: rot.h5: 3 cases do not verify and count as pending, the first is 5;' \
        'Outcomes of the 3597 cases done'
expect "... and compare refuses it" 3 "$stance" compare good.h5 rot.h5
cp map.h5 map-rot.h5 && rot map-rot.h5 0 "$inferred"
"$python" "$tests/results_tools.py" flip map-rot.h5 trajectory/velocity map-rot2.h5
for launch in "" "mpirun -n 3"; do
    with=${launch:+ ($launch)}
    cp rot.h5 mended.h5
    # shellcheck disable=SC2086
    expect "rotten answers$with" 0 $launch "$stance" run short.yaml -o mended.h5 --resume \
        says 'warning: mended.h5: 3 cases marked done did not verify and are computed again: 5, 17, 3599$'
    tool "... and mended" same good.h5 mended.h5
    cp map-rot2.h5 mended.h5
    # shellcheck disable=SC2086
    expect "rotten answers of a refined map$with" 0 $launch "$stance" run refined.yaml -o mended.h5 --resume \
        says "warning: mended.h5: 3 cases marked done did not verify and are computed again: 0, $inferred, 1003$" \
            tool same map.h5 mended.h5
done
"$python" "$tests/results_tools.py" flip good.h5 status status.h5
"$python" "$tests/results_tools.py" flip fits.h5 trajectory/position rot.h5 2>/dev/null
case=$(($(wc -l <fits.yaml) > 0 ? 1012 : 0))
expect "a rotten trajectory is not drawn" 3 "$stance" plot rot.h5 --case $case -o pictures \
    says 'damaged: a trajectory is not as its checksum says'

# ---- another scenario --------------------------------------------------------------------------
other=(--set controller.torque_limit=9 --set seed=5)
cp good.h5 changed.h5 # half done
"$python" -c 'import h5py
with h5py.File("changed.h5", "r+") as f:
    status = f["status"][...]; status[30:] = 0; f["status"][...] = status'
cp changed.h5 before.h5
expect "another scenario is refused" 2 mpirun -n 2 "$stance" run short.yaml "${other[@]}" -o changed.h5 --resume \
    says 'changed.h5 was made from another scenario (--force-scenario .*); 2 values ' \
        '^  controller.torque_limit: 10, now 9$' '^  seed: none, now 5$' is cmp -s changed.h5 before.h5
many=(title=x seed=9 stop.time=2 ground.friction=0.7 ground.restitution=0.1 robot.foot_mass=1 robot.hip_mass=2
    robot.trunk_mass=2 robot.leg_length=0.5 controller.torque_limit=3 'controller.poles=[-4,-4,-5,-5,-6,-6]')
expect "so are many differences" 2 "$stance" run short.yaml "${many[@]/#/--set=}" -o changed.h5 --resume lines 14 \
    tells '^  \.\.\.$' # of which the first ones are shown
expect "--force-scenario needs --resume" 2 "$stance" run short.yaml -o changed.h5 --force-scenario
for change in 'sweep.grid[0].count=61' 'record={answers: [outcome]}' 'controller.poles=[-3,-3,-4,-4,-5,-5]' \
    robot.trunk_mass=2 'record={every: 0.5, cases: [1]}' 'sweep.refine={start: 4}'; do
    expect "what does not fit is refused: $change" 2 "$stance" run short.yaml --set "$change" -o changed.h5 --resume \
        --force-scenario says '^stance run: changed.h5: --force-scenario cannot change '
done
cat >drawn.yaml <<END
stance: 1
scene: block
initial: {state: {x: 0}}
method: {name: capturing, step: 0.01}
stop: {time: 0.1}
sweep:
  grid:
    - {path: ground.friction, from: 0.1, to: 1, spacing: log, count: 4}
  sample:
    method: random
    count: 10
    vary: [{path: robot.slope, from: 0, to: 0.6}]
END
expect "a sample and a logarithmic axis" 0 "$stance" run drawn.yaml -o drawn.h5 --quiet
cp drawn.h5 drawn-before.h5
# Their values are in the file: nobody must take these for the new scenario's own.
for change in seed=2 'sweep.sample.vary[0].to=0.5' sweep.sample.method=sobol 'sweep.grid[0].from=0.01'; do
    expect "what does not fit is refused: $change" 2 "$stance" run drawn.yaml --set "$change" -o drawn.h5 --resume \
        --force-scenario says '^stance run: drawn.h5: --force-scenario cannot change '
done
is "... and the file stays" cmp -s drawn.h5 drawn-before.h5
# One case of many has a design that changes.
cat >words.yaml <<END
stance: 1
scene: biped
ground: {contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}}
controller: {kind: state-feedback, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6],
             weights: {states: [1, 1, 1, 1, 1, 1], torques: [1, 1]}}
method: {name: midpoint, step: 0.01}
stop: {time: 0.1}
sweep:
  sample:
    method: random
    count: 40
    vary: [{path: controller.design, values: [$(printf 'place, %.0s' {1..19}) lqr]}]
END
expect "many designs" 0 "$stance" run words.yaml -o words.h5 --quiet
expect "a change in a few of them is refused" 2 "$stance" run words.yaml -o words.h5 --resume --force-scenario \
    --set 'controller.weights.torques=[9, 9]' \
    says '^stance run: words.h5: --force-scenario cannot change what its controller designs depend on'
is "... and the file stays" cmp -s changed.h5 before.h5
"$python" "$tests/results_tools.py" damage changed.h5 4
# Killed on the way, again and again: it is the one file or the other.
tried=0 changed=0
cp before.h5 killed.h5
whole=$(span "$stance" run short.yaml "${other[@]}" -o killed.h5 --resume --force-scenario --quiet)
for attempt in $(seq $attempts); do
    cp before.h5 killed.h5
    timeout -s KILL "$(seconds $((whole * attempt / attempts)))" "$stance" run short.yaml "${other[@]}" -o killed.h5 \
        --resume --force-scenario --quiet 2>log
    "$python" "$tests/results_tools.py" whole killed.h5 1800 >>log 2>&1 || break
    if "$stance" run short.yaml "${other[@]}" -o killed.h5 --resume --quiet >>log 2>&1; then
        changed=$((changed + 1))
    else
        "$stance" run short.yaml -o killed.h5 --resume --quiet >>log 2>&1 || break
    fi
    "$python" "$tests/results_tools.py" whole killed.h5 3600 >>log 2>&1 || break
    tried=$((tried + 1))
done 2>/dev/null
((tried == attempts))
result $? "killed while it changes, the file goes on with one scenario or the other ($changed of $attempts changed)"
cp before.h5 killed.h5 && cp before.h5 killed.h5.next
"$stance" run short.yaml -o killed.h5 --resume --quiet >log 2>&1 && [ ! -e killed.h5.next ]
result $? "a successor that was left is cleared by whoever goes on with the file"
echo mine >killed.h5.next
"$stance" run short.yaml -o killed.h5 --resume --quiet >log 2>&1 && [ "$(cat killed.h5.next)" = mine ]
result $? "... but what is no successor is left alone"
rm -f killed.h5*
expect "another scenario, forced" 0 mpirun -n 2 "$stance" run short.yaml "${other[@]}" -o changed.h5 --resume \
    --force-scenario \
    says 'goes on with another scenario; 1799 of its 3600 cases are done and stay as they are, 1 did not verify'
tool "... every case is whole" whole changed.h5 3600
expect "the new scenario alone" 0 "$stance" run short.yaml "${other[@]}" -o new.h5 --quiet
holds "... cases of either are those of a run of its own, and both texts are kept" <<'END'
old, new, both = (h5py.File(name) for name in ("good.h5", "new.h5", "changed.h5"))
number = both["scenario_number"][...]
expected = numpy.repeat([0, 1], 1800).reshape(60, 60)
expected.flat[4] = 1
assert (number == expected).all()
for name in ("outcome", "end_time", "final_state", "steps"):
    first = (expected == 0).reshape(expected.shape + (1,) * (old[name].ndim - 2))
    assert numpy.array_equal(both[name][...], numpy.where(first, old[name], new[name]), True), name
assert both["history/scenario"][0].decode() == old.attrs["scenario"].decode()
assert both["history/date"][0] == old.attrs["date"]
assert both.attrs["scenario"] == new.attrs["scenario"]
assert (both["design/gain"][...] == old["design/gain"][...]).all()
END
expect "summary tells" 0 "$stance" summary changed.h5 says 'Made from 2 scenarios'
expect "the newest one is resumed" 0 "$stance" run short.yaml "${other[@]}" -o changed.h5 --resume
expect "the first one is not" 2 "$stance" run short.yaml -o changed.h5 --resume
"$python" "$tests/results_tools.py" flip changed.h5 scenario_number flipped.h5
expect "a wrong number of a scenario is seen" 0 "$stance" summary flipped.h5 says '1 case does not verify'
"$python" "$tests/results_tools.py" flip changed.h5 history/scenario flipped.h5
is "nothing is left behind" [ -z "$(ls ./*.next ./*.part 2>/dev/null)" ]

# ---- a share of the campaigns ------------------------------------------------------------------
share() { # name, program, arguments
    "$python" "${@:2}" >log 2>&1
    result $? "$1"
    grep '^ok\|^not ok' log | sed 's/^\(not \)\?ok/#/'
}
if long_tests; then
    share "200 kills" "$tests/campaign_kills.py" --kills 200
    share "50 truncations, 200 turned bits" "$tests/campaign_damage.py" --truncations 50 --flips 200
else
    few=("$tests"/campaign/refined.yaml)
    share "a few kills" "$tests/campaign_kills.py" --kills 3 "${few[@]}"
    share "some damage" "$tests/campaign_damage.py" --truncations 2 --flips 6 "${few[@]}"
fi
