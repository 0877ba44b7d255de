#!/usr/bin/env bash
# The house: floors (# NAME), on each the rooms, and what files of a room may include: what stands in their
# own room, and in those named beside it, all of them above it in this list, from the top, by "room/file.h".
# Prints every include that does not; exit code 1 if there is one. With rooms as arguments: prints these,
# what they may use, and so on. --house: the floors, how many lines of C they have, their rooms.
cd "$(dirname "$0")/.." || exit 1
runner='engine engine/control runner/base runner/ranks runner/objects runner/scenario runner/plan runner/store runner/run runner/optimise runner/import'
numbers="engine $runner analysis/statistics analysis/table"
rooms="# engine: core
engine:
engine/core/lanes: engine
engine/core/contact: engine engine/core/lanes
engine/core/law: engine engine/core/lanes engine/core/contact
engine/core/implicit: engine engine/core/lanes engine/core/contact engine/core/law
engine/core/mode: engine engine/core/lanes engine/core/contact engine/core/law engine/core/implicit
engine/core/loop: engine engine/core/lanes engine/core/contact engine/core/law engine/core/implicit engine/core/mode
# engine: tree
engine/scenes: engine engine/core/lanes
engine/laws: engine
engine/methods: engine engine/core/implicit engine/core/mode engine/core/loop
# engine: control
engine/control: engine
# base
runner/base: engine
runner/ranks: engine runner/base
runner/objects: engine runner/base runner/ranks
runner/objects/law: engine/core/lanes
# study
runner/scenario: engine runner/base
runner/plan: engine engine/control runner/base runner/ranks runner/objects runner/scenario
runner/import: engine runner/base runner/ranks runner/objects runner/scenario runner/plan
# store
runner/store: engine runner/base runner/ranks runner/scenario runner/plan
# run
runner/run: engine runner/base runner/ranks runner/scenario runner/plan runner/store
runner/optimise: engine engine/control runner/base runner/ranks runner/objects runner/scenario runner/plan runner/store runner/run
# look
analysis/statistics: $runner
analysis/table: $runner analysis/statistics
analysis/draw: $numbers
analysis/optimise: $numbers analysis/draw
analysis/summary: $numbers analysis/draw analysis/optimise
analysis/basin: $numbers analysis/draw
analysis/critical: $numbers analysis/draw analysis/basin
analysis/sensitivity: $numbers analysis/draw analysis/optimise analysis/summary
analysis/compare: $numbers analysis/draw
analysis/gait: $numbers analysis/draw
analysis/plot: $numbers analysis/draw analysis/optimise analysis/summary analysis/basin analysis/critical analysis/sensitivity
# bench
analysis/bench: $numbers analysis/draw analysis/optimise analysis/summary analysis/basin analysis/sensitivity analysis/plot
# page
analysis/view: $numbers analysis/draw analysis/optimise analysis/summary analysis/basin analysis/sensitivity analysis/plot analysis/bench
analysis/view/wasm: $runner
analysis/python/stance: $numbers analysis/draw analysis/optimise analysis/summary analysis/basin analysis/critical analysis/sensitivity analysis/compare analysis/gait analysis/plot analysis/view
# main
runner: $runner"
if [ "${1:-}" = --house ]; then
    git ls-files -co --exclude-standard 'engine/*.[ch]' 'runner/*.[ch]' 'analysis/*.[ch]' | xargs wc -l |
        awk -v rooms="$rooms" '{ path = $2; if (sub(/\/[^\/]*$/, "", path)) lines[path] += $1 }
            END {
                n = split(rooms, row, "\n")
                for (i = 1; i <= n + 1; i++)
                    if (i > n || row[i] ~ /^#/) {
                        if (i > 1) printf "%-16s %6d %s\n", floor, sum, names
                        floor = substr(row[i], 3); sum = 0; names = ""
                    } else {
                        split(row[i], part, ":")
                        sum += lines[part[1]]; names = names " " part[1]
                    }
            }'
    exit
fi
if (($# > 0)); then
    awk -v wanted="$*" '{ name = $1; sub(/:$/, "", name); $1 = ""; may[name] = $0 }
        function use(name,   part, n, i) {
            if (name in used) return
            used[name]
            print name
            n = split(may[name], part, " ")
            for (i = 1; i <= n; i++) use(part[i])
        }
        END { n = split(wanted, first, " "); for (i = 1; i <= n; i++) use(first[i]) }' <<<"$rooms"
    exit
fi
git ls-files -co --exclude-standard 'engine/*.[ch]' 'runner/*.[ch]' 'analysis/*.[ch]' |
    xargs -r grep -HE '^[[:space:]]*#[[:space:]]*include' /dev/null |
    awk -v rooms="$rooms" '
    BEGIN {
        n = split(rooms, row, "\n")
        for (i = 1; i <= n; i++) {
            if (row[i] ~ /^#/) continue
            split(row[i], part, ":")
            m = split(part[2], use, " ")
            for (k = 1; k <= m; k++) {
                may[part[1], use[k]] = 1
                if (!(use[k] in known)) { print part[1] " may not use " use[k] ", which is not above it"; wrong = 1 }
            }
            known[part[1]] = 1
        }
    }
    function room(path) { sub(/\/[^\/]*$/, "", path); return path }
    function bad(text) { print text ": " file " includes " name; wrong = 1 }
    {
        file = name = $0
        sub(/:.*/, "", file)
        sub(/^[^:]*:[[:space:]]*#[[:space:]]*include[[:space:]]*/, "", name)
        ours = name ~ /^"/ || name ~ /^<(engine|runner|analysis)\//
        if (name !~ /^["<]/ && name != "STANCE_SCENE_LANES") bad("not a name")
        if (!ours) next
        path = substr(name, 2)
        sub(/[">].*/, "", path)
        from = room(file)
        to = index(path, "/") ? room(path) : from
        if (!(from in known) || !(to in known)) bad("no such room")
        else if (from != to && !((from, to) in may)) bad("may not")
    }
    END { exit wrong }'
