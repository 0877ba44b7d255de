#!/usr/bin/env bash
# The rooms of the program in their order: a file may include what stands in its own room or in one
# that comes before it here. Prints every arrow that runs back up; exit code 1 if there is one.
cd "$(dirname "$0")/.."
rooms="
engine
engine/core/lanes engine/core/contact engine/core/law engine/core/implicit engine/core/mode engine/core/loop
engine/scenes engine/laws engine/methods engine/control
runner/base runner/ranks runner/scenario runner/plan runner/store runner/run
analysis/statistics analysis/table analysis/draw
analysis/summary analysis/basin analysis/sensitivity analysis/compare analysis/plot analysis/bench
runner"
git ls-files -co --exclude-standard 'engine/*.[ch]' 'runner/*.[ch]' 'analysis/*.[ch]' | xargs -r grep -H '^#include "' /dev/null |
    awk -F: -v rooms="$rooms" '
    BEGIN { n = split(rooms, name, /[ \n]+/); for (i = 1; i <= n; i++) if (name[i] != "") order[name[i]] = i }
    function room(path) { sub(/\/[^\/]*$/, "", path); return path }
    {
        split($2, word, "\""); to = index(word[2], "/") ? room(word[2]) : room($1)
        from = room($1)
        if (!(from in order) || !(to in order)) { print "no such room: " $1 " -> " word[2]; bad = 1 }
        else if (order[to] > order[from]) { print "runs back up: " $1 " -> " word[2]; bad = 1 }
    }
    END { exit bad }'
