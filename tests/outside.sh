# shellcheck shell=bash disable=SC2154
# What tests of the whole program share: commands with the exit codes and lines that they must give, and
# events that they wait for. Sourced in a scratch folder by a script that sets count=0, stance, python and
# tests; failed counts what was not ok.
failed=0
read -r patience _ <"$tests/patience" # s

long_tests() { [ -n "${STANCE_TEST_LONG:-}" ]; } # make test-long: all, not a share
result() { # status, name
    count=$((count + 1))
    if (($1 == 0)); then
        echo "ok $count - $2"
    else
        failed=$((failed + 1))
        echo "not ok $count - $2"
        sed 's/^/# /' log 2>/dev/null | tail -n 20
    fi
}
# Milliseconds that a command takes here and now: by which others are killed on their way.
span() { # command ...
    local begin=${EPOCHREALTIME//[.,]/}
    "$@" >/dev/null 2>&1 </dev/null
    echo $(((${EPOCHREALTIME//[.,]/} - begin) / 1000))
}
seconds() { printf '%d.%03d' $(($1 / 1000)) $(($1 % 1000)); } # milliseconds
# Runs a command, not for ever; ok when it exits with this code. What its log must have, and what must hold then, may
# follow, each a check of its own:
#     says PATTERN...    exactly one line matches            as FILE     compare finds its results the same to the bit
#     tells PATTERN...   some line does (an ERE)             lines N     there are so many
#     times N PATTERN    N lines do
#     is COMMAND..., tool TASK..., holds CODE                the functions below; a script may add its own
# What it has said is kept by: into FILE
clause_words=" says tells times as lines into is tool holds "
# bash -c "$stdout_alone" - COMMAND...: the log has what it writes there; the other stream is in the file stderr, or out.
stdout_alone='"$@" 2>stderr' stderr_alone='"$@" >out'
expect() { # name, code, command ... [clause ...]
    local name=$1 code=$2 status words=()
    shift 2
    before_clause "$@"
    timeout "$patience" "${words[@]}" >log 2>&1 </dev/null
    status=$?
    ((status == code)) || echo "exit code $status, expected $code" >>log
    result $((status != code)) "$name"
    clauses "$@"
}
clauses() { # [command ...] clause ...
    local clause pattern file='' words=()
    before_clause "$@"
    [[ " ${words[*]} " =~ " "(-o|merge)" "([^ ]+)" " ]] && file=${BASH_REMATCH[2]}
    while shift ${#words[@]} && (($#)); do
        clause=$1
        shift
        before_clause "$@"
        ((${#words[@]} > 0)) || [ "$clause" = holds ] || { result 1 "... $clause nothing" && continue; }
        case $clause in
        says) for pattern in "${words[@]}"; do says "... says $pattern" "$pattern"; done ;;
        tells) for pattern in "${words[@]}"; do tells "... tells $pattern" "$pattern"; done ;;
        as) "$stance" compare "${words[0]}" "$file" >facts 2>&1; found $? "... as ${words[0]}" ;;
        lines) is "... in ${words[0]} lines" [ "$(wc -l <log)" = "${words[0]}" ] ;;
        holds) holds "... holds" "${words[@]}" ;;
        into) cp log "${words[0]}" ;;
        *) "$clause" "... $clause ${words[*]}" "${words[@]}" ;;
        esac
    done
}
times() { # name, how many lines of the log, pattern
    [ "$(grep -c -- "$3" log)" = "$2" ]
    result $? "$1"
}
# The log has some line for each of these.
tells() { # name, pattern ...
    local pattern
    for pattern in "${@:2}"; do grep -qE -- "$pattern" log || { result 1 "$1"; return; }; done
    result 0 "$1"
}
before_clause() { # words ...: those before the next clause
    words=()
    while (($#)) && [[ $clause_words != *" $1 "* ]]; do words+=("$1") && shift; done
}
# Ok when a command succeeds, or with ! does not; one word with blanks is a script. What it says is not heard.
is() { # name, [!] command ...
    if [ "$2" = ! ]; then
        ! "${@:3}" >/dev/null 2>&1
    elif (($# == 2)); then
        eval "$2" >/dev/null 2>&1
    else
        "${@:2}" >/dev/null 2>&1
    fi
    result $? "$1"
}
# Ok when what is asserted in Python holds (facts.py): the code, or that of the standard input.
holds() { # name, [code or -, argument ...]
    "$python" "$tests/facts.py" "${@:2}" >facts 2>&1
    found $? "$1"
}
# Waits until a command succeeds; false: the process on which that depends (-: none) has ended before.
await() { # process, command ...
    local process=$1 end=$((SECONDS + patience))
    shift
    until "$@"; do
        if ((SECONDS > end)) || { [ "$process" != - ] && gone "$process"; }; then
            echo "waited in vain for: $*" >>log
            return 1
        fi
        sleep 0.05
    done
}
gone() { ! kill -0 "$1" 2>/dev/null; } # process
running() { "$stance" status "$1" 2>/dev/null | grep -v 'not running' | grep -q running; } # file: a job is at it
# ... and has stored cases (of a shard, too)
computing() { "$stance" status "$1" 2>/dev/null | grep -v 'not running' | grep -q '[:,] [1-9][0-9]* of .*running'; }
# A job of N ranks (0: no launcher) that has stored some cases: its process, and those of its ranks.
begin() { # N, file, scenario, option ...
    local n=$1 launch=()
    ((n > 0)) && launch=(mpirun -n "$n")
    "${launch[@]}" "$stance" run "${@:3}" -o "$2" --quiet >out 2>log </dev/null &
    job=$! ranks=($!)
    await "$job" computing "$2" || return
    ((n == 0)) || mapfile -t ranks < <(pgrep -P $job -x "$(basename "$stance")")
    ((${#ranks[@]} > 0)) || ranks=("$job")
}
# It ends by itself with this code.
ends() { # name, code [clause ...]
    local status
    await - gone "$job"
    kill -9 "$job" 2>/dev/null && echo "it hung" >>log
    wait $job 2>/dev/null
    status=$?
    ((status == $2)) || echo "exit code $status, expected $2" >>log
    result $((status != $2)) "$1"
    clauses "${@:3}"
}
# The log has exactly one line of the program, and it matches.
says() { # name, pattern
    [ "$(grep -c -- "$2" log)" = 1 ]
    result $? "$1"
}
tool() { # name, task ...
    "$python" "$tests/results_tools.py" "${@:2}" >facts 2>&1
    found $? "$1"
}
found() { # status, name: what Python said of it is in facts
    (($1 == 0)) || cat facts >>log
    result "$1" "$2"
}
# Another program's lines of TAP, counted on here.
retold() { # file
    local line
    while read -r line; do
        case $line in
        "ok "*) result 0 "${line#* - }" ;;
        "not ok "*) result 1 "${line#* - }" ;;
        "# "*) echo "$line" ;;
        esac
    done <"$1"
}

# A robot on one foot under state feedback: how most scenarios of the tests begin.
balance() { # sample time and longest step (s), half-width of the torques' noise (N m)
    cat <<END
stance: 1
scene: biped
ground: {friction: 0.8, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, design: place, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6],
             sample_time: $1, torque_limit: 10, noise: $2}
method: {name: implicit, step: $1}
END
}
grid() { # points of each of two axes: starts about its equilibrium, of which some recover
    cat <<END
sweep:
  grid:
    - {path: initial.offset.theta, from: -0.12, to: 0.06, count: $1}
    - {path: initial.offset.vtheta, from: -0.6, to: 0.6, count: $2}
END
}
