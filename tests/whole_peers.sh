#!/usr/bin/env bash
# Other simulators on the charts of error against cost (bench_peers): our own engine in a peer's place gets the
# errors that it has without; what a peer may do wrong is said in one line; MuJoCo in short, where it is
# installed.
# long
. "$(dirname "$0")/scratch.sh"
programs=$(cd "$tests/.." && cd "${BUILD:-build}/tests" && pwd)

# A few rows and starts of a study.
study() { # NAME COUNT PATTERN...
    local name=$1 count=$2
    shift 2
    grep -vE '^ +- \[' "$shipped/accuracy/$name.yaml" | sed "s/count: [0-9]*/count: $count/" >"$name.yaml"
    sed -i '/values:/r /dev/stdin' "$name.yaml" <<<"$(printf '        - [%s]\n' "$@")"
}
study drop 2 'event-driven, 0.01, 1.0e-12' 'midpoint, 0.01, 1' 'capturing, 0.01, 1.0e-6'
study basin_one_foot 13 'event-driven, 0.02, 1.0e-10' 'midpoint, 0.01, 1'
ask=("$programs/bench_peers")

# ---- our own engine as a peer ----------------------------------------------------------------------
expect "a peer that is our own engine" 0 "${ask[@]}" drop.yaml basin_one_foot.yaml --peer "$programs/peer_self" -o self --json
holds "... has the errors and the labels that it has without" <<'END'
drop, basin = json.loads("{" + open("log").read().split("{", 1)[1])["studies"]
def rows(study, step):
    return [r for r in study["rows"] if r["method"] in ("midpoint", "self") and r["step"] == step]
ours, theirs = rows(drop, 0.01)
assert theirs["setting"] == "midpoint" and ours["setting"] is None
for name in "position_error", "velocity_error":
    assert abs(ours[name] - theirs[name]) < 1e-9 * ours[name], (ours, theirs)
peer = drop["peers"][0]
assert peer["acceleration_difference"] < 1e-9 and peer["settings"] == 2
assert peer["best"]["error"] == theirs["position_error"] or peer["best"]["step"] == 0.005
assert {m["method"] for m in peer["best"]["methods"]} == {"midpoint", "capturing"}
ours, theirs = rows(basin, 0.01)
assert ours["cells_unlike"] == theirs["cells_unlike"] and theirs["cases"] == 169
END
expect "fewer starts, as text and picture" 0 "${ask[@]}" basin_one_foot.yaml --reuse --peer "$programs/peer_self" \
    --peer-starts 50 -o self says "self  *midpoint  *1.0e-02 .* of 36 " \
    "self, at its best .midpoint, 0.01 s.: [a-z0-9]* of 36 cells unlike" is [ -s self/basin_one_foot.svg ]

# ---- what peers do wrong ---------------------------------------------------------------------------
fake() { # NAME COMMANDS
    printf '#!/bin/sh\n%s\n' "$2" >"$1" && chmod +x "$1"
}
wrong() { # WHAT EXPECTED COMMANDS OPTIONS ...: it has ten minutes to say it, unless there is a --peer-effort
    fake peer "$3"
    expect "$1" 3 "${ask[@]}" drop.yaml --reuse --peer ./peer "${@:4}" -o self says "$2"
    lines=$(grep -c 'bench_peers: drop: ' log)
    is "... in one line" '[ "$lines" = 1 ] && [ "$(wc -l <log)" = 1 ]'
}
wrong "a line that is none" "line 2 is not understood: hello" 'echo peer fake; echo hello; cat >/dev/null'
wrong "no name" "line 1 is not understood: setting" 'echo setting 0.001 0 x'
wrong "states without accelerations" "accelerations were not told first" 'echo peer fake; echo setting 0.001 0 x; echo state 0 0 1 2 3 4 5 1 2 3 4 5'
wrong "another robot" "is another robot: accelerations differ" 'echo peer fake; echo setting 0.001 0 x; echo acceleration 0 1 2 3 4 5'
wrong "numbers that are none" "line 3 is not understood: acceleration 0 1 2 z" 'echo peer fake; echo setting 0.001 0 x; echo acceleration 0 1 2 z 4 5'
wrong "one that stops in the middle" "stopped in the middle" 'echo peer fake'
wrong "one that dies" "died of signal 9" 'echo peer fake; kill -9 $$'
wrong "one that gives up" "ended with exit code 7" 'echo peer fake; exit 7'
wrong "one that is silent" "has said nothing for 1 s" 'exec sleep 1000' --peer-effort 0.1
wrong "cases that are missing" "2 of 2 cases are missing" "\"$programs/peer_self\" | grep -v '^case'"
wrong "states that are missing" "has 120 of 121 states" "\"$programs/peer_self\" | grep -v '^state 1 120 '"
wrong "no time" ".midpoint.: no time" "\"$programs/peer_self\" | grep -v '^time'"
expect "one that is not there" 3 "${ask[@]}" drop.yaml --reuse --peer ./nowhere -o self says "exit code 127"
expect "a number that is none" 2 "${ask[@]}" drop.yaml --peer ./peer --peer-starts many
fake peer 'cat >/dev/null; echo peer fake; echo cannot no feet; echo end'
expect "one that cannot is no mistake" 0 "${ask[@]}" drop.yaml --reuse --peer ./peer -o self says "fake cannot: no feet"

# ---- those that are installed ----------------------------------------------------------------------
for peer in mujoco siconos; do
    if [ -x "$programs/peer_$peer" ]; then
        expect "$peer computes the drop" 0 "${ask[@]}" drop.yaml --reuse --peer "$programs/peer_$peer" -o self --json
        holds "... the same robot, and lands with it" <<'END'
study = json.loads("{" + open("log").read().split("{", 1)[1])["studies"][0]
assert study["peers"][0]["acceleration_difference"] < 1e-9
assert study["peers"][0]["best"]["error"] < 0.1, study["peers"]
END
    else
        skip "$peer computes the drop" "it is not installed"
    fi
done
expect "what the product had" 2 "$stance" bench accuracy drop.yaml --peer ./peer \
    says 'other simulators are asked by `make bench-peers` in the source tree'
