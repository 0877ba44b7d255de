# shellcheck shell=bash disable=SC2154
# What tests of the whole program share: commands with the exit codes and lines that they must give.
# Sourced in a scratch folder by a script that sets count=0, patience (s), python and tests; failed
# counts what was not ok.
failed=0

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
# Runs a command, not for ever; ok when it exits with this code.
expect() { # name, code, command ...
    local name=$1 code=$2 status
    shift 2
    timeout $patience "$@" >log 2>&1 </dev/null
    status=$?
    ((status == code)) || echo "exit code $status, expected $code" >>log
    result $((status != code)) "$name"
}
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
