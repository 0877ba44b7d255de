#!/usr/bin/env bash
# Completion of commands, options, files and paths of scenarios for bash, zsh or fish, from the program's tables
# of options (stance help --options); paths are asked of `stance describe` when they are wanted.
# Usage: completion.sh STANCE bash|zsh|fish
set -eu
lines=$("$1" help --options)
paths="stance describe 2>/dev/null | grep -E '^[a-z_]+([.][][a-zA-Z_]+)*\$' | sort -u"

# What may stand for a word of the synopsis: a kind that each shell completes in its own way.
kinds='
    function kind(word) {
        if (word == "-" || word == "") return "none"
        if (word ~ /\|/) return "words"
        if (word == "SCENARIO") return "scenario"
        if (word == "FILE" || word == "OUT") return "file"
        if (word ~ /^DIR/) return "folder"
        if (word ~ /^PATH/) return "path"
        return "any"
    }
    BEGIN { FS = "\t"; quote = "\047" }
    { gsub(/[`"$\\]/, ""); gsub(quote, "") } # nothing that a shell would read
    $2 == "-" { sub(/[. ].*/, "", $3) } # of operands the first
    $2 != "-" { sub(/^[.][.][.] /, "", $4); if (match($4, /([;:,(]|[.] |[.]$)/) && RSTART > 8) $4 = substr($4, 1, RSTART - 1) }
'
case $2 in
bash)
    cat <<END
# bash completion of stance
_stance() {
    local word=\${COMP_WORDS[COMP_CWORD]} before=\${COMP_WORDS[COMP_CWORD - 1]} command=\${COMP_WORDS[1]} options='' kind=any
    COMPREPLY=()
    ((COMP_CWORD > 2)) && [[ "\$command" == bench && \${COMP_WORDS[2]} != -* ]] && command="bench \${COMP_WORDS[2]}"
    if ((COMP_CWORD == 1)); then
        command=
    fi
    case "\$command:\$before" in
END
    awk "$kinds"'
        $2 != "-" && kind($3) != "none" && kind($3) != "any" {
            printf "    \"%s:%s\") kind=%s ;;\n", $1, $2, kind($3) == "words" ? quote $3 quote : kind($3)
        }
        $2 != "-" && kind($3) == "any" { printf "    \"%s:%s\") kind=any ;;\n", $1, $2 }
        $2 == "-" { last[++n] = $1; operand[$1] = kind($3) }
        $2 != "-" { options[$1] = options[$1] " " $2 }
        END {
            for (i = 1; i <= n; i++) {
                more = ""
                for (k = 1; k <= n; k++)
                    if (index(last[k], last[i] " ") == 1) more = more " " substr(last[k], length(last[i]) + 2)
                printf "    \"%s:\"*) kind=%s options=\"%s%s -h\" ;;\n", last[i], operand[last[i]], substr(options[last[i]], 2), more
            }
            printf "    *) kind=none options=\""
            for (i = 1; i <= n; i++) if (last[i] !~ / /) printf "%s ", last[i]
            print "-h --version\" ;;"
        }' <<<"$lines"
    cat <<END
    esac
    case \$kind in
    scenario) mapfile -t COMPREPLY < <(compgen -f -X '!*.yaml' -- "\$word"; compgen -d -- "\$word") ;;
    file) mapfile -t COMPREPLY < <(compgen -f -X '!*.h5' -- "\$word"; compgen -d -- "\$word") ;;
    folder) mapfile -t COMPREPLY < <(compgen -d -- "\$word") ;;
    path) mapfile -t COMPREPLY < <(compgen -W "\$($paths)" -- "\$word") ;;
    none | any) ;;
    *) options=\${kind//|/ } ;;
    esac
    [[ \$word == -* || \$kind == none || \$kind == *'|'* ]] && mapfile -t -O "\${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "\$options" -- "\$word")
}
complete -o filenames -F _stance stance
END
    ;;
zsh)
    cat <<END
#compdef stance
# zsh completion of stance
_stance_paths() { local -a paths; paths=(\${(f)"\$($paths)"}); compadd -a paths }
_stance() {
    local -a commands
    commands=(
END
    awk "$kinds"'$2 == "-" && $1 !~ / / { gsub(/:/, "\\:", $4); printf "        %s%s:%s%s\n", quote, $1, $4, quote }' <<<"$lines"
    cat <<END
    )
    if ((CURRENT == 2)); then
        _describe command commands
        return
    fi
    local command=\$words[2]
    [[ \$command == bench && CURRENT -gt 3 && \$words[3] != -* ]] && command="bench \$words[3]"
    shift words
    ((CURRENT--))
    case \$command in
END
    awk "$kinds"'
        function action(word,    k) {
            k = kind(word)
            if (k == "words") { gsub(/\|/, " ", word); return ":value:(" word ")" }
            return k == "none" ? "" : k == "scenario" ? ":scenario:_files -g \"*.yaml\"" : k == "file" ? ":file:_files -g \"*.h5\"" : \
                   k == "folder" ? ":folder:_files -/" : k == "path" ? ":path:_stance_paths" : ":" tolower(word) ":"
        }
        $2 == "-" {
            if (NR > 1) print " ;;"
            printf "    %s%s%s) _arguments %s*%s%s", quote, $1, quote, quote, $3 == "-" ? ":word:" : action($3), quote
            next
        }
        {
            gsub(/\[|\]|:/, "", $4)
            printf " \\\n        %s*%s[%s]%s%s", quote, $2, $4, action($3), quote
        }
        END { print " ;;" }' <<<"$lines"
    cat <<END
    esac
}
[[ \$funcstack[1] == _stance ]] && _stance "\$@" || compdef _stance stance
END
    ;;
fish)
    echo '# fish completion of stance'
    echo 'complete -c stance -f'
    awk "$kinds"'
        function action(word,    k) {
            k = kind(word)
            if (k == "words") { gsub(/\|/, " ", word); return " -x -a " quote word quote }
            return k == "none" ? "" : k == "scenario" ? " -x -a " quote "(__fish_complete_suffix .yaml)" quote : \
                   k == "file" ? " -x -a " quote "(__fish_complete_suffix .h5)" quote : \
                   k == "folder" ? " -x -a " quote "(__fish_complete_directories)" quote : \
                   k == "path" ? " -x -a " quote "(" paths ")" quote : " -x"
        }
        function within(name,    part, n) {
            n = split(name, part, " ")
            return "\"__fish_seen_subcommand_from " part[1] (n > 1 ? "; and __fish_seen_subcommand_from " part[2] : "") "\""
        }
        BEGIN { paths = "stance describe 2>/dev/null | string match -rg \"^([a-z_]+(?:[.][][a-zA-Z_]+)*)\\$\"" }
        $2 == "-" {
            n = split($1, part, " ")
            printf "complete -c stance -n %s -a %s -d %s%s%s\n", (n > 1 ? within(part[1]) : "__fish_use_subcommand"), part[n], quote, $4, quote
            if ($3 != "-") printf "complete -c stance -n %s%s\n", within($1), action($3)
            next
        }
        {
            printf "complete -c stance -n %s %s%s -d %s%s%s\n", within($1), \
                $2 ~ /^--/ ? "-l " substr($2, 3) : "-s " substr($2, 2), action($3), quote, $4, quote
        }' <<<"$lines"
    ;;
*) exit 2 ;;
esac
