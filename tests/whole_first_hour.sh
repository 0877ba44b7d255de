#!/usr/bin/env bash
# A newcomer's first hour, as the README tells it: every command there works, and what each leaves is what a
# newcomer needs next.
# long
# shellcheck disable=SC2154
. "$(dirname "$0")/scratch.sh"
mkdir bin && ln -s "$stance" bin/stance
begins() { # file, bytes
    [ "$(head -c ${#2} "$1")" = "$2" ] && [ "$(stat -c %s "$1")" -gt 2000 ]
}

"$python" "$tests/told.py" --calm "$tests/../README.md" The first hour >told
count=$(grep -cE '^(not )?ok' told)
cat told
commands=$(grep -c '^ok .* - bin/stance' told)
((commands >= 6 && commands <= 10)) && ! grep -q '^not ok' told
result $? "ten commands at the most"
begins own-model.svg '<?xml' && begins own-model.png $'\x89PNG'
result $? "the robot is drawn"
grep -A9 '^sweep:' own.yaml | grep -q 'path: initial.offset.body, from: -'
result $? "its scenario has ranges"
bin/stance basin results/own.h5 --json >basin.json
holds "the map shows a bounded domain" <<'END'
row, = said("basin.json")["rows"]
assert row["bounded"] and 0.9 < row["connected"] < 1.3 and 0.04 < row["share"] < 0.2, row
END
bin/stance basin results/ankles.h5 --threshold 0.8 --of robot.actuators.ankle.limit --json >threshold.json
holds "the ankle's limit has an interval" <<'END'
row, = said("threshold.json")["rows"]
assert 60 < row["high"] < row["value"] < row["low"] < 110, row
END
begins fig1.pdf %PDF- && bin/stance plot results/own.h5 --picture map --for column --format svg -o column >log 2>&1 &&
    grep -q 'width="88.00mm"' column/own-map.svg
result $? "the figure is a PDF, a column wide"
begins recovery.gif GIF89a && (($(grep -c . <(tr -c '\041' '\n' <recovery.gif)) > 20))
result $? "the film has frames"
