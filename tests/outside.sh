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
