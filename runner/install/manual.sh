#!/usr/bin/env bash
# The manual pages, made of what `stance -h`, `stance COMMAND -h` and `stance describe` print: FOLDER/stance.1,
# stance-COMMAND.1 of each command and stance-scenario.5.
# Usage: manual.sh STANCE FOLDER
set -eu
stance=$1 folder=$2
version=$("$stance" --version | awk 'NR == 1 {print $1, $2}')
names=$("$stance" help --options | awk -F'\t' '$2 == "-" {print $1}' | tr ' ' -)

page() { # name, section: of a text "NAME section", a synopsis, and lines, on standard input
    awk -v name="$1" -v section="$2" -v version="$version" -v others="$names" '
        function safe(line) {
            gsub(/\\/, "\\e", line); gsub(/-/, "\\-", line)
            return line ~ /^[.\047]/ ? "\\&" line : line
        }
        function close_block() { if (block) print ".fi\n.RE"; block = 0 }
        BEGIN {
            upper = toupper(name)
            printf ".TH %s %s \"\" \"%s\" \"stance\"\n.SH NAME\n", upper, section, version
        }
        NR == 1 { printf "%s \\- %s\n.SH SYNOPSIS\n.nf\n", safe(name), safe($0); synopsis = 1; next }
        synopsis && NF { sub(/^ *usage: /, ""); print safe($0); next }
        synopsis { print ".fi\n.SH DESCRIPTION"; synopsis = 0; next }
        !NF { close_block(); print ".PP"; next }
        # Tables and lists stand as they are; lines at the margin are one paragraph.
        /^ / { if (!block) print ".RS 2\n.nf"; block = 1; print safe(substr($0, match($0, /[^ ]/) > 2 ? 3 : 1)); next }
        { close_block(); print safe($0) }
        END {
            close_block()
            print ".SH SEE ALSO"
            n = split(others, other, "\n")
            if (name != "stance") printf "\\fBstance\\fR(1)"
            for (i = 1; i <= n; i++)
                if ("stance-" other[i] != name) printf "%s\\fBstance\\-%s\\fR(1)", ((i > 1 || name != "stance") ? ",\n" : ""), safe(other[i])
            if (name != "stance-scenario") printf ",\n\\fBstance\\-scenario\\fR(5)"
            print ""
        }' >"$folder/$1.$2"
}

mkdir -p "$folder"
"$stance" -h | awk 'NR == 1 { sub(/^stance /, ""); sub(/\.$/, "") } NR != 2 {print}' | page stance 1
for name in $names; do
    # The summary first, then the synopsis, then the help.
    # shellcheck disable=SC2086 # two words of some
    "$stance" ${name/-/ } -h | awk '
        part == 0 { synopsis = synopsis $0 "\n"; if (!NF) part = 1; next }
        part == 1 { sub(/\.$/, ""); print; printf "%s", synopsis; part = 2; next }
        part == 2 && !NF { part = 3; next }
        { print }' | page "stance-$name" 1
done
{
    echo "scenario files of stance"
    echo "stance: 1"
    echo "scene: NAME"
    echo "..."
    echo
    "$stance" describe
} | page stance-scenario 5
