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
# Runs a command, not for ever; ok when it exits with this code.
expect() { # name, code, command ...
    local name=$1 code=$2 status
    shift 2
    timeout "$patience" "$@" >log 2>&1 </dev/null
    status=$?
    ((status == code)) || echo "exit code $status, expected $code" >>log
    result $((status != code)) "$name"
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
computing() { "$stance" status "$1" 2>/dev/null | grep -v 'not running' | grep -q ': [1-9][0-9]* of .*running'; } # ... and has stored cases
# The log has exactly one line of the program, and it matches.
says() { # name, pattern
    [ "$(grep -c -- "$2" log)" = 1 ]
    result $? "$1"
}
tool() { # name, task ...
    local name=$1
    shift
    "$python" "$tests/results_tools.py" "$@" >log 2>&1
    result $? "$name"
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
