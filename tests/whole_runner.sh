#!/usr/bin/env bash
# `stance run`, `status` and `check` from outside: ranks, kills, resumes, full disks, other readers.
# about: runner/objects runner/run analysis/compare
. "$(dirname "$0")/scratch.sh"
span=2 # seconds that the cases of a long job last
long_tests && span=5
[ -n "${STANCE_SLOW:-}" ] && span=0.5
clause_words+="looks "
looks() { # name, kind ...
    "$python" "$tests/open_results.py" "${@:2}" >log 2>&1
    result $? "$1"
}

# $1: sweep and other keys.
scenario() {
    balance 0.001 0.1
    printf '%s\n' 'title: "Balance, with \"quotes\" and Ümlaut"' "$1"
}

# ---- what other programs see -----------------------------------------------------------------
scenario "$(grid 5 5)
stop: {time: 1}" >square.yaml
scenario "sweep:
  grid:
    - {path: method.name, values: [implicit, midpoint]}
    - {paths: [ground.friction, ground.restitution], values: [[0.5, 0], [0.8, 0.1]]}
stop: {time: 1}" >words.yaml
scenario "record: {every: 0.01, cases: all}
stop: {time: 1, settle: off}" >alone.yaml
expect "a square grid" 0 "$stance" run square.yaml looks square results/square.h5
expect "an axis of strings, and two paths together" 0 "$stance" run words.yaml -o words.h5 looks words words.h5
expect "no sweep, with a trajectory" 0 "$stance" run alone.yaml -o alone.h5 looks trajectory alone.h5
expect "one case, traced" 0 "$stance" run square.yaml --only 7 --trace looks one results/square-case7.h5 7
holds "the case alone and in the sweep agree to the bit" <<'END'
with h5py.File("results/square.h5") as sweep, h5py.File("results/square-case7.h5") as one:
    for name in ["end_time", "outcome", "iterations", "checksum"]:
        assert sweep[name][1, 2] == one[name][0], name
    assert (sweep["final_state"][1, 2] == one["final_state"][0]).all()
END

# ---- any number of ranks ---------------------------------------------------------------------
scenario "sweep:
  grid:
    - {path: robot.trunk_mass, from: 1.6, to: 2, count: 3, spacing: log}
    - {path: method.name, values: [implicit, midpoint]}
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: 11}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: 7}
record: {every: 0.02, cases: all}
stop: {time: 1}" >ranks.yaml
expect "one rank, no launcher" 0 "$stance" run ranks.yaml -o ranks0.h5 tool whole ranks0.h5 462
for n in 1 2 3 5; do
    expect "$n ranks" 0 mpirun -n $n "$stance" run ranks.yaml -o ranks$n.h5 tool same ranks0.h5 ranks$n.h5
done
# As between machines: counters in messages that rank 0 must see to.
expect "ranks that have no memory in common" 0 mpirun -n 3 --mca pml ob1 --mca btl tcp,self --mca osc pt2pt "$stance" \
    run ranks.yaml -o messages.h5 tool same ranks0.h5 messages.h5
mpirun -n 2 --mca pml ob1 --mca btl tcp,self --mca osc pt2pt "$stance" run ranks.yaml --force \
    -o messages.h5 --set stop.time="${span}0" --set stop.settle=off --set record.cases=none >log 2>&1
holds "... and all compute" 'c = h5py.File("messages.h5")["timing/cases"][...]
assert min(c) > 0, c'
for isa in $("$stance" --version | sed -n 's/^instruction sets \(.*\); in use.*/\1/p' | tr -d ,); do
    STANCE_ISA=$isa expect "instruction set $isa" 0 "$stance" run ranks.yaml -o $isa.h5 tool same ranks0.h5 $isa.h5
done
scenario "sweep: {grid: [{path: initial.offset.theta, from: 0, to: 0.01, count: 9}]}
stop: {time: 1}
record: {answers: [outcome, end_time]}" >few.yaml
expect "few answers" 0 "$stance" run few.yaml holds 'f = h5py.File("results/few.h5")
assert {k for k in f if k not in ("initial.offset.theta", "design", "timing")} == \
    {"outcome", "end_time", "checksum", "status"}, list(f)' tool whole results/few.h5 9

# ---- a file of a former version, whose scenario has a key that is no longer there ---------------
cp ranks0.h5 former.h5
holds "a file of a former version" 'import h5py, hashlib
with h5py.File("former.h5", "r+") as f:
    text = f.attrs["scenario"]
    text = (text if isinstance(text, str) else text.decode()).replace("\n  time: 1", "\n  time: 1\n  capture: estimated")
    assert text.count("capture") == 1, text
    f.attrs["scenario"], f.attrs["scenario_sha256"] = text, hashlib.sha256(text.encode()).hexdigest()'
expect "... has a summary" 0 "$stance" summary former.h5 says '^  stabilised  *[0-9]'
expect "... and a picture" 0 "$stance" plot former.h5 -o former.svg
expect "... and compares" 0 "$stance" compare --labels ranks0.h5 former.h5
expect "... but does not go on with another scenario" 2 "$stance" run ranks.yaml -o former.h5 --resume \
    --force-scenario says 'a scenario that this version cannot read'

# ---- killed, stopped, damaged, and gone on with ------------------------------------------------
scenario "$(grid 200 200)
stop: {time: $span, settle: off}
record: {every: 0.1, cases: [0, 100, 39999]}" >long.yaml
expect "the whole job" 0 mpirun -n 2 "$stance" run long.yaml -o long.h5
expect "status of a finished file" 0 "$stance" status long.h5 --json says '"done": 40000'

for n in 0 2; do
    if ((n == 0)); then name="alone"; else name="of $n ranks"; fi
    rm -f killed.h5
    is "status sees a run $name while it runs" begin $n killed.h5 long.yaml
    expect "a second writer is refused" 3 "$stance" run long.yaml -o killed.h5 --resume \
        says 'another process is writing it'
    expect "... even with force" 3 "$stance" run long.yaml -o killed.h5 --force
    kill -9 "${ranks[-1]}"
    wait $job 2>/dev/null
    tool "killed $name: every case marked done is whole" whole killed.h5
    "$stance" status killed.h5 >log 2>&1
    tells "killed $name: status says so" 'pending; not running'
    cp killed.h5 first.h5
    expect "killed $name: another scenario is refused" 2 "$stance" run long.yaml --set seed=2 -o killed.h5 --resume \
        says "^  seed: none, now 2$"
    "$python" "$tests/results_tools.py" damage killed.h5 3
    expect "killed $name, damaged, and resumed" 0 mpirun -n 3 "$stance" run long.yaml -o killed.h5 --resume \
        tool same long.h5 killed.h5
done
# A checksum for all that a resume reads but the rows: none of it is trusted when it does not fit.
scenario "sweep:
  grid:
    - {path: robot.trunk_mass, from: 1.6, to: 2, count: 3, spacing: log}
    - {path: method.name, values: [implicit, midpoint]}
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: 30}
stop: {time: 1}
record: {every: 0.1, cases: [0, 7]}" >half.yaml
expect "a job to be damaged" 0 "$stance" run half.yaml -o all.h5 holds 'shutil.copy("all.h5", "half.h5")
with h5py.File("half.h5", "r+") as f:
    status = f["status"][...]; status[1:] = 0; f["status"][...] = status' tool sealed half.h5
for part in design/gain design/equilibrium_torque design/status robot.trunk_mass \
    initial.offset.theta trajectory/time @scenario @axes; do
    "$python" "$tests/results_tools.py" flip half.h5 $part flipped.h5
    cp flipped.h5 before.h5
    for launch in "" "mpirun -n 2"; do
        with=${launch:+ ($launch)}
        # shellcheck disable=SC2086
        expect "a bit of $part is wrong: no resume$with" 3 $launch "$stance" run half.yaml -o flipped.h5 --resume \
            says '^stance run: flipped.h5: ' is cmp -s flipped.h5 before.h5
    done
    for command in summary plot status "compare all.h5"; do
        # shellcheck disable=SC2086
        expect "... and ${command%% *} refuses it" 3 "$stance" $command flipped.h5 lines 1
    done
done
"$python" -c 'import h5py; f = h5py.File("half.h5", "r+"); del f["design/gain"].attrs["checksum"]'
cp half.h5 old.h5
expect "without a checksum: no resume" 3 "$stance" run half.yaml -o half.h5 --resume says 'design/gain has no checksum'
expect "... but a summary" 0 "$stance" summary old.h5

expect "a time limit" 4 mpirun -n 2 "$stance" run long.yaml -o limited.h5 --time-limit 1s \
    says 'go on with: mpirun -n 2 .* run long.yaml .*--resume'
expect "... and it does" 0 "$stance" run long.yaml -o limited.h5 --resume tool same long.h5 limited.h5
# Cases that would take minutes each: nobody waits for their ends.
scenario "sweep:
  grid:
    - {path: method.name, values: [implicit, capturing]}
    - {path: initial.offset.theta, from: 0, to: 0.01, count: 50}
stop: {time: 500000, settle: off}" >endless.yaml
for launch in "" "mpirun -n 2"; do
    # shellcheck disable=SC2086
    expect "a time limit within long cases${launch:+ ($launch)}" 4 $launch "$stance" run endless.yaml \
        -o endless.h5 --time-limit 0.5s --force
done
"$stance" run endless.yaml -o endless.h5 --resume --quiet >log 2>&1 &
job=$!
await "$job" running endless.h5
kill -TERM $job
ends "SIGTERM within long cases stops with code 4" 4
for to in "INT 0" "TERM 0" "USR1 0" "USR1 2"; do
    rm -f signal.h5
    begin "${to#* }" signal.h5 long.yaml
    kill -"${to% *}" $job
    ends "SIG${to% *} to it, of ${to#* } ranks to mpirun, stops with code 4" 4 tool whole signal.h5
done

# ---- errors: one line, the right code, no hang -------------------------------------------------
refused() { # name, code, what it says once, command ...
    expect "$1$with" "$2" $launch "${@:4}" says "$3"
}
for launch in "" "mpirun -n 3"; do
    with=${launch:+ ($launch)}
    # shellcheck disable=SC2086
    {
        refused "an existing file" 3 'results/square.h5 exists; --force replaces it' "$stance" run square.yaml
        refused "a missing directory" 3 'no/where.h5.*No such file or directory' "$stance" run square.yaml -o no/where.h5
        refused "a missing scenario" 3 'nowhere.yaml.*No such file' "$stance" run nowhere.yaml
        refused "an unknown key" 2 'friction' "$stance" run square.yaml --set ground.frction=1
        refused "an unknown option" 2 "did you mean '--force'" "$stance" run square.yaml --forse
        refused "a case beyond the last" 2 'cases are 0 ... 24' "$stance" run square.yaml --only 25
        refused "an initial state under the ground" 2 '^square.yaml:[0-9]*:[0-9]*: .*ground' "$stance" run square.yaml \
            -o buried.h5 --set initial.offset.z=-0.1 is [ ! -e buried.h5 ]
        refused "an equilibrium that does not exist" 2 '^alone.yaml:[0-9]*:[0-9]*: ' "$stance" run alone.yaml \
            -o none.h5 --set robot.trunk_length=9
        expect "a dry run$with" 0 $launch "$stance" run long.yaml -o dry.h5 --dry-run is [ ! -e dry.h5 ]
        if mount -t tmpfs -o size=1m tmpfs "$disk" 2>/dev/null; then
            refused "a full disk" 3 'No space left on device' "$stance" run long.yaml -o disk/full.h5
            is "... and leaves nothing" [ -z "$(ls disk)" ]
            mount -o remount,ro "$disk"
            refused "a read-only disk" 3 'Read-only file system' "$stance" run square.yaml -o disk/full.h5
            umount "$disk"
        else
            skip "a full disk$with" "cannot mount"
            skip "a read-only disk$with" "cannot mount"
        fi
        rm -f limit.h5
        refused "a limit on file sizes" 3 'limit.h5.*File too large' bash -c \
            "ulimit -f 2000; exec '$stance' run long.yaml -o limit.h5"
        # Taken away while it runs: the writes of one rank fail.
        begin "$((${#launch} > 0 ? 3 : 0))" limit.h5 long.yaml
        prlimit --pid "${ranks[-1]}" --fsize=4096
        ends "a write that fails in mid-run$with" 3 says 'stance run: limit.h5: cannot write' tool whole limit.h5
        rm -f limit.h5
    }
done
# A quota shows in what is refused, not in the room that a disk has.
if ! grep -q __asan_init "$stance" && gcc -D_GNU_SOURCE -shared -fPIC -o quota.so "$tests/quota.c" -ldl 2>log; then
    launch='' with=''
    refused "a quota that leaves no room" 3 'stance run: quota.h5.part: cannot reserve its space: Disk quota exceeded' \
        env QUOTA=reserve LD_PRELOAD=./quota.so "$stance" run long.yaml -o quota.h5
    is "... and leaves nothing" [ -z "$(ls quota.h5* 2>/dev/null)" ]
    refused "a quota that is used up in mid-run" 3 'stance run: quota.h5: cannot write .*: Disk quota exceeded' env \
        QUOTA=1000000 LD_PRELOAD=./quota.so "$stance" run long.yaml -o quota.h5 --quiet tool whole quota.h5 0
    expect "... it goes on" 0 "$stance" run long.yaml -o quota.h5 --resume --quiet as long.h5
    rm -f quota.h5
else
    skip "a quota" "nothing can be preloaded"
fi
ln -sf nowhere/kept.h5 link.h5
expect "--force replaces a symbolic link" 0 "$stance" run square.yaml -o link.h5 --force
is "... by a file" '[ -f link.h5 ] && [ ! -L link.h5 ]'
# Pictures: whole ones or none, whichever disk is full.
expect "pictures" 0 "$stance" plot long.h5 -o pictures
size=$(stat -c %s pictures/long-map.svg)
for full in target scratch; do
    if mount -t tmpfs -o size=$((size + 30000)) tmpfs "$disk" 2>/dev/null; then
        rm -rf drawn && mkdir drawn
        if [ $full = target ]; then where=$disk room=/tmp; else where=drawn room=$disk; fi
        TMPDIR=$room expect "pictures and a full $full" 3 "$stance" plot long.h5 -o "$where"
        is "... says so once" [ "$(wc -l <log)" = 1 ]
        is "... and leaves nothing" [ -z "$(ls -A "$disk" drawn | grep -v :)" ]
        umount "$disk"
    else
        skip "pictures and a full $full" "cannot mount"
    fi
done
expect "check prints cases, designs, size and cost" 0 bash -c '"$0" check ranks.yaml --json 2>warnings' "$stance"
"$python" -c 'import json; d = json.load(open("log")); assert d["cases"] == 462 and \
    d["designs"] == 3 and d["recorded_cases"] == 462 and d["file_bytes"] > 0 and \
    d["seconds_on_one_rank"] > 0, d' 2>>log
result $? "... as JSON with the keys of its help"
scenario "sweep:
  grid:
    - {path: robot.trunk_length, values: [0.535, 9]}
    - {path: initial.offset.theta, values: [0, 0.001, 0.002]}
stop: {time: 1}" >designs.yaml
expect "cases whose design does not exist fail" 1 mpirun -n 2 "$stance" run designs.yaml
"$python" -c 'import h5py; f = h5py.File("results/designs.h5")
assert f["status"][...].tolist() == [[1] * 3, [2] * 3], f["status"][...]
initial = f["failure"].attrs["flag_meanings"].decode().split().index("initial")
assert f["failure"][...].tolist() == [[0] * 3, [initial] * 3] and f["design/status"][...].tolist() == [1, 2]' \
    >log 2>&1
result $? "... with status failed, failure initial, and the others done"
