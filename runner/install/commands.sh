#!/usr/bin/env bash
# What the help texts say of the commands, as lines of fields between tabs; of a command
#   COMMAND  -       OPERAND  SUMMARY    OPERAND as the synopsis has it: SCENARIO, FILE, PATH; - where none
# and of each option that stands in its synopsis
#   COMMAND  OPTION  VALUE    TEXT       VALUE: - where it takes none; TEXT: the beginning of what the help says
# Manual pages and completions are made of these lines and of the help texts alone.
# Usage: commands.sh STANCE
set -eu
stance=$1
"$stance" -h | awk '/^  [a-z]/ {print $1}' | while read -r name; do
    echo "$name"
    "$stance" "$name" -h | grep -o "stance $name [a-z]* -h" | awk '{print $2, $3}' || true
done | while read -r name; do
    # shellcheck disable=SC2086 # two words of some
    "$stance" $name -h | awk -v name="$name" '
        BEGIN { part = 1 } # the synopsis, the summary, the help
        part == 1 && NF { synopsis = synopsis " " $0; next }
        part == 1 {
            part = 2
            sub(/^ *usage: stance /, "", synopsis)
            for (rest = synopsis; match(rest, /(^|[^a-z-])--?[a-z][a-z-]*/);) {
                word = substr(rest, RSTART, RLENGTH); sub(/^[^-]*/, "", word)
                rest = substr(rest, RSTART + RLENGTH)
                of = match(rest, /^ (\[[A-Z]+=\])?[A-Za-z]/) ? substr(rest, 2) : "-"
                gsub(/\[[^]]*\]/, "", of); sub(/[] ].*/, "", of)
                if (!(word in value)) order[++n] = word
                value[word] = of
            }
            sub(/\[--?[a-z-]+ \| /, "", synopsis) # one or the other
            while (gsub(/\[-[^][]*(\[[^][]*\][^][]*)*\](\.\.\.)?/, "", synopsis)) { }
            operand = match(synopsis, /[A-Z][A-Z]+/) ? substr(synopsis, RSTART, RLENGTH) : "-"
            next
        }
        part == 2 && NF { summary = $0; sub(/\.$/, "", summary); part = 3; next }
        part == 3 && match($0, /^ *--?[a-z][a-z-]*/) {
            word = substr($0, RSTART, RLENGTH); gsub(/ /, "", word)
            line = substr($0, RSTART + RLENGTH)
            if (!(word in value) || word in text) next
            sub(/^[:,]?( [A-Z]+(=[A-Z]+)?)?:? */, "", line); sub(/^\.\.\. /, "", line)
            if (match(line, /([;:,(]|\. |\.$)/) && RSTART > 8) line = substr(line, 1, RSTART - 1)
            sub(/ +$/, "", line)
            text[word] = line
        }
        END {
            printf "%s\t-\t%s\t%s\n", name, operand, summary
            for (i = 1; i <= n; i++) printf "%s\t%s\t%s\t%s\n", name, order[i], value[order[i]], text[order[i]]
        }'
done
