#!/usr/bin/env bash
# What adding a law, an outcome, an answer, a method and a picture takes: done in a copy of the tree, as the pages
# of the rooms say, it touches three files at most each, builds, and works.
# long
source=$(cd "$(dirname "$0")/.." && pwd)
. "$source/tests/scratch.sh"
ok() { echo "ok $((++count)) - $1"; }
bad() { echo "not ok $((++count)) - $1"; tail -n 20 log | sed 's/^/# /'; }
check() { # name, command ...
    local name=$1
    shift
    if "$@" >log 2>&1; then ok "$name"; else bad "$name"; fi
}
says() { # pattern, command ...
    local pattern=$1
    shift
    "$@" 2>&1 | tee said | grep -q -- "$pattern"
}

mkdir copy && (cd "$source" && git ls-files -co --exclude-standard engine runner analysis Makefile |
    xargs cp --parents -t "$scratch/copy") || exit 1
cd copy || exit 1
# One method, two scenes: what is not built need not be waited for.
sed -i 's/^METHODS = .*/METHODS = implicit/; s/^SCALAR_METHODS = .*/SCALAR_METHODS =/' Makefile
# Of the page its data: neither a browser nor an engine for it.
sed -i "s/-DSTANCE_PAGE_ENGINES='[^']*'/-DSTANCE_PAGE_ENGINES=/" Makefile
echo '<!--stance:data--><!--stance:more-->' >page.html
"$python" "$tests/adding.py" . >places 2>log
check "the additions find their places" test -s places
while read -r kind places files; do
    check "$kind: $places places ($files)" test "$places" -le 3
done <places
isa=$("$stance" --version | sed -n 's/.*in use: //p')
check "it builds" make -j"$(nproc)" ISAS="$isa" PAGE="$PWD/page.html" KERNEL_CFLAGS=-O1 CFLAGS=-O0 BUILD="$scratch/build" \
    PROGRAM="$scratch/stance" "$scratch/stance"
cd "$scratch" || exit 1

cat >law.yaml <<'Y'
stance: 1
scene: biped
initial: {state: {z: 2, vq1: 1, vq2: -1}}
controller: {kind: damped, damping: 20}
method: {name: middle, step: 0.001}
stop: {time: 0.3, settle: off}
Y
cat >ball.yaml <<'Y'
stance: 1
scene: ball
initial: {state: {z: 2}}
method: {name: middle, step: 0.001}
stop: {time: 1}
sweep: {grid: [{path: initial.state.vz, from: 1, to: 10, count: 4}]}
Y
check "the law's parameter is described" says "damping of every joint" ./stance describe controller.damping
check "the law runs" ./stance run law.yaml -o law.h5
check "it brakes the joints" "$python" -c "
import h5py
rates = h5py.File('law.h5')['final_state'][...].ravel()[8:]
assert abs(rates).max() < 0.1, rates"
check "another law refuses the parameter" says "controller.kind damped" ./stance check law.yaml --set controller.kind=hold
check "the method and the outcome are in the file" says "2 flew" ./stance run ball.yaml -o ball.h5
check "the summary counts the outcome" says "flew *2 " ./stance summary ball.h5
check "the outcome is in files as its number and name" "$python" -c "
import h5py
outcome = h5py.File('ball.h5')['outcome']
assert outcome[...].tolist() == [4, 4, 6, 6] and outcome.attrs['flag_meanings'].split()[6] == b'flew'"
check "the answer is in the file" "$python" -c "
import h5py
highest = h5py.File('ball.h5')['highest'][...]
assert abs(highest[1] - 2 - 16 / 2 / 9.81) < 1e-2 and 2.99 < highest[3] < 3.1, highest"
check "the answer is drawn" ./stance plot ball.h5 --answer highest
check "the picture is in the help" says "NAME-ends: how many cases have ended" ./stance plot -h
check "the picture is drawn" says '^ball-ends.png$' ./stance plot ball.h5
check "it shows its labels" grep -q '<text>How many have ended by each time</text>' ball-ends.svg
check "the table has both" says "flew" ./stance table ball.h5
check "the page colours the outcome as pictures do" "$python" -c "
import re, subprocess
subprocess.run(['./stance', 'view', 'ball.h5'], check=True)
assert re.search('\"name\":\"flew\",\"colour\":\"#[0-9a-f]{6}\"', open('ball.html').read())"
