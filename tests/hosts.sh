#!/usr/bin/env bash
# A run on three "hosts": network namespaces of this machine with host names of their own, joined by
# a switch in a fourth, so that ranks can reach each other by TCP alone. One is cut off, or frozen,
# in mid-run; what comes out in the end is compared, bit by bit, with a run on one host.
#
# Nothing outside these namespaces is changed. Speaks TAP, ends with "N passed, N failed"; takes
# some three minutes, with STANCE_TEST_LONG=1 a quarter of an hour. Needs root and iproute2.
# Usage: tests/hosts.sh   (make test-hosts)
set -u
cd "$(dirname "$0")/.." || exit 1
stance=${STANCE:-$PWD/bin/stance} python=${PYTHON:-/usr/bin/python3} tests=$PWD/tests
scratch=$(mktemp -d)
hosts=(1 2 3) name=stance$$ # of the namespaces: stance123-1 ...

everything() { # every process on the hosts
    local i
    for i in "${hosts[@]}"; do
        ip netns pids "$name-$i"
    done 2>/dev/null
}
# shellcheck disable=SC2317,SC2046 # called by the trap; a list of numbers
clean_up() {
    trap '' INT TERM
    kill -9 $(everything) 2>/dev/null
    wait
    for i in "${hosts[@]}" switch; do
        ip netns del "$name-$i" 2>/dev/null
    done
    rm -rf "$scratch"
}
trap clean_up EXIT
trap 'exit 130' INT TERM HUP
skip_all() {
    echo "test-hosts skips everything: $1"
    echo "0 passed, 0 failed"
    exit 0
}

for program in ip unshare mpirun; do
    command -v $program >/dev/null || skip_all "there is no $program (make test-hosts installs it)"
done
[ "$(id -u)" = 0 ] || skip_all "it needs root"
cd "$scratch" || exit 1
ip netns add "$name-switch" 2>log || skip_all "no network namespaces here: $(head -n 1 log)"
unshare --uts true 2>log || skip_all "no host names of their own here: $(head -n 1 log)"
{
    ip -n "$name-switch" link add switch type bridge && ip -n "$name-switch" link set switch up
} 2>log || skip_all "no bridges here: $(head -n 1 log)"
for i in "${hosts[@]}"; do
    {
        ip netns add "$name-$i" &&
            ip -n "$name-switch" link add "port$i" type veth peer name eth0 netns "$name-$i" &&
            ip -n "$name-switch" link set "port$i" master switch up &&
            ip -n "$name-$i" addr add "10.1.1.$i/24" dev eth0 &&
            ip -n "$name-$i" link set eth0 up &&
            ip -n "$name-$i" link set lo up
    } 2>log || skip_all "no cables between namespaces here: $(head -n 1 log)"
done

# What mpirun calls instead of ssh: launch HOST COMMAND...
cat >launch <<END_OF_FILE
#!/bin/bash
i=\${1##*.}
shift
exec ip netns exec "$name-\$i" unshare --uts bash -c 'hostname "\$0"; eval "\$*"' "host\$i" "\$@"
END_OF_FILE
chmod +x launch
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none PMIX_MCA_gds=hash
# The hosts share their processors: none may take one for itself.
export OMPI_MCA_hwloc_base_binding_policy=none
# As scenarios/cluster/ has them, but quicker to notice that a host has gone: after 8 s.
export OMPI_MCA_oob_tcp_keepalive_time=4 OMPI_MCA_oob_tcp_keepalive_intvl=2 \
    OMPI_MCA_oob_tcp_keepalive_probes=2 OMPI_MCA_odls_base_sigkill_timeout=5
on_hosts() { # 1,2,3 command ...: a rank on each of these hosts; mpirun on the first
    local list=${1//,/ } all='' i
    shift
    for i in $list; do all="$all,10.1.1.$i:1"; done
    exec bash launch "10.1.1.${list%% *}" exec mpirun --host "${all#,}" \
        --mca plm_rsh_agent "$PWD/launch" --mca plm_rsh_no_tree_spawn 1 \
        --mca oob_tcp_if_include 10.1.1.0/24 --mca btl_tcp_if_include 10.1.1.0/24 "$@"
}
on_one_host=(mpirun --oversubscribe -n)

count=0
# shellcheck source=tests/outside.sh
. "$tests/outside.sh"
same() { expect "$1" 0 "$stance" compare "$2" "$3" says '^identical'; } # name, file, file: bit by bit
value() { # key, file
    "$stance" status "$2" --json 2>/dev/null | sed -n "s/.*\"$1\": *\([a-z0-9]*\).*/\1/p"
}
{
    balance 0.001 0.1
    cat <<'END_OF_FILE'
title: Balance on three hosts
stop: {time: 5, settle: off}
sweep:
  grid:
    - {path: initial.offset.theta, from: -0.05, to: 0.01, count: 100}
    - {path: initial.offset.vtheta, from: -0.2, to: 0.05, count: 300}
END_OF_FILE
} >sweep.yaml

# ---- three hosts, one host: the same, and as fast ------------------------------------------------
received() { ip netns exec "$name-2" cat /sys/class/net/eth0/statistics/rx_bytes; }
expect "a run on one host" 0 "${on_one_host[@]}" 2 "$stance" run sweep.yaml -o whole.h5
before=$(received)
(on_hosts 1,2,3 "$stance" run sweep.yaml -o three.h5) >log 2>&1 </dev/null
result $? "a run on three hosts"
says "... with a rank on each" 'on 3 ranks$'
is "... which talk over the network" '(($(received) > before + 10000))'
holds "... and every host computes its share" 'f = h5py.File("three.h5")
hosts, cases = f.attrs["hosts"], f["timing/cases"][...]
hosts = hosts.decode() if isinstance(hosts, bytes) else hosts
assert hosts == "host1,host2,host3" and min(cases) > 3000, (hosts, cases)'
same "... and write the same" whole.h5 three.h5
# As fast: what ranks on two hosts compute in a second, against two on one host, in turn.
for _ in 1 2 3; do
    for kind in one two; do
        if [ $kind = one ]; then
            "${on_one_host[@]}" 2 "$stance" run sweep.yaml -o $kind.h5 --force --quiet
        else
            (on_hosts 1,2 "$stance" run sweep.yaml -o $kind.h5 --force --quiet) </dev/null
        fi 2>/dev/null
        "$python" -c "import h5py; t = h5py.File('$kind.h5')['timing/wall_time'][...]
print('$kind', 30000 / t.max())" >>rates
    done
done
holds "two hosts compute about as much in a second as one with both ranks" <<'END_OF_FILE'
import statistics
rows = [line.split() for line in open("rates")]
rate = {kind: [float(r) for k, r in rows if k == kind] for kind in ("one", "two")}
share = statistics.median(b / a for a, b in zip(rate["one"], rate["two"]))
print(f"{statistics.median(rate['one']):.0f} cases/s on one host, "
      f"{statistics.median(rate['two']):.0f} on two: {100 * share:.1f} %")
assert share > 0.7
END_OF_FILE
sed 's/^/# /' facts

# ---- one that goes in mid-run --------------------------------------------------------------------
cable() { ip -n "$name-switch" link set "port$1" "$2"; } # host, up or down
ranks() { # how many there are on a host
    local pid n=0
    for pid in $(ip netns pids "$name-$1"); do
        [ "$(readlink -f "/proc/$pid/exe")" != "$(readlink -f "$stance")" ] || n=$((n + 1))
    done
    echo $n
}
begin_run() { # file, options: in the background; sets job, begin
    rm -f "$1"
    (on_hosts 1,2,3 "$stance" run sweep.yaml -o "$1" --quiet "${@:2}") >out 2>&1 </dev/null &
    job=$!
    await $job computing "$1"
    done_then=$(value "done" "$1")
    begin=$SECONDS
}
none_left() { # hosts
    local i
    for i in "$@"; do (($(ranks "$i") == 0)) || return 1; done
}
# What must hold when a run has lost a host: nothing that had been done is lost, the rest follows.
# shellcheck disable=SC2046 # a list of numbers
goes_on() { # file
    kill -9 $(everything) 2>/dev/null
    wait $job 2>/dev/null
    echo "$done_then done when the host went, $(value "done" "$1") in the end" >log
    cat out >>log
    ((done_then > 0 && $(value "done" "$1") >= done_then && $(value pending "$1") > 0))
    result $? "... what was done is kept, and there is more to do"
    tool "... every case marked done is whole" whole "$1"
    (on_hosts 2,3 "$stance" run sweep.yaml -o "$1" --resume) >log 2>&1 </dev/null
    result $? "... the others go on"
    same "... to the same end" whole.h5 "$1"
}

begin_run cut.h5
cable 3 down
await - gone $job
result $? "a host is cut off: mpirun notices and ends the job (after $((SECONDS - begin)) s)"
is "... on every host, cut off or not" await - none_left 1 2 3
cable 3 up
goes_on cut.h5

begin_run first.h5
cable 1 down
await - none_left 1 2 3
result $? "the host of rank 0 and mpirun is cut off: all ranks end (after $((SECONDS - begin)) s)"
cable 1 up
goes_on first.h5

# A frozen host answers every question of the network: only time ends this.
begin_run frozen.h5 --time-limit 10s
# shellcheck disable=SC2046 # a list of numbers
kill -STOP $(ip netns pids "$name-1")
await - none_left 2 3
result $? "the host of rank 0 is frozen: the limit ends the others (after $((SECONDS - begin)) s)"
goes_on frozen.h5

# Without a limit a rank that says nothing is waited for for five minutes.
if [ -n "${STANCE_TEST_LONG:-}" ]; then
    begin_run frozen.h5
    # shellcheck disable=SC2046
    kill -STOP $(ip netns pids "$name-1")
    await - none_left 2 3
    result $? "the same without a limit: the others leave (after $((SECONDS - begin)) s)"
    goes_on frozen.h5
    begin_run silent.h5
    # shellcheck disable=SC2046
    kill -STOP $(ip netns pids "$name-2")
    await - none_left 1 3
    result $? "another host is frozen: the others stop without it (after $((SECONDS - begin)) s)"
    cp out log
    says "... and rank 0 says which" "rank 1 has said nothing"
    goes_on silent.h5
fi

echo "1..$count"
echo "$((count - failed)) passed, $failed failed"
exit $((failed > 0))
