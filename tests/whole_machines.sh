#!/usr/bin/env bash
# One hash for each kernel whatever the machine: this processor's instruction sets, an x86-64 without
# AVX and fused multiply-adds (emulated), and a 64-bit ARM (`make test-neon`: cross-compiled and
# emulated). What cannot be had is skipped with a notice.
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build} neon=build/neon${NEON_CFLAGS:=-O1} cases=10 count=0
export NEON_CFLAGS
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
check() { # description, command ...
    local what=$1
    shift
    count=$((count + 1))
    if "$@" >"$work/out" 2>&1; then
        echo "ok $count - $what"
    else
        echo "not ok $count - $what"
        sed 's/^/# /' "$work/out" | head -n 20
    fi
}
# The kernels in file $2 have the hashes that those of file $1 have, and at least one is there.
same() {
    awk 'NR == FNR { hash[$1 " " $2] = $4; next }
        hash[$1 " " $2] == $4 { same++; next }
        { print "differs:", $0; bad = 1 }
        END { exit bad || !same }' "$1" "$2"
}
only() { # instruction set, file: no kernel with lanes has another
    [ "$(awk '$2 != "event-driven" {print $3}' "$2" | sort -u)" = "$1" ]
}

check "golden" sh -c "'$build/tests/golden' $cases >'$work/here'"
check "every instruction set of this machine" same "$work/here" "$work/here"

# Lanes never add and subtract in turns: a compiler that does has fused what the source does not.
if [ "$(uname -m)" = x86_64 ] && command -v objdump >/dev/null; then
    check "nothing is fused but by the source" \
        sh -c "! objdump -d '$build'/kernel/*.o | grep -E 'vfm(addsub|subadd)'"
fi

x86=$(command -v qemu-x86_64-static qemu-x86_64 | head -n 1)
if [ "$(uname -m)" != x86_64 ] || [ -z "$x86" ]; then
    echo "# skipped: an x86-64 without fused multiply-adds (make test-neon installs the emulator)"
elif nm "$build/tests/golden" | grep -q __asan_init; then
    echo "# skipped: emulation of what the address sanitizer instruments"
else
    check "x86-64 without AVX runs" sh -c "'$x86' -cpu Nehalem '$build/tests/golden' $cases >'$work/nehalem'"
    check "x86-64 without AVX: sse2 alone" only sse2 "$work/nehalem"
    check "x86-64 without AVX: the same" same "$work/here" "$work/nehalem"
fi

arm=$(command -v qemu-aarch64-static qemu-aarch64 | head -n 1)
if [ -z "$arm" ] || ! command -v aarch64-linux-gnu-gcc >/dev/null; then
    echo "# skipped: 64-bit ARM (make test-neon installs compiler and emulator)"
else
    check "64-bit ARM builds" env -u BUILD make golden-neon
    check "64-bit ARM runs" sh -c "'$arm' $neon/tests/golden $cases >'$work/arm'"
    check "64-bit ARM: NEON among its sets" grep -q neon "$work/arm"
    check "64-bit ARM: the same" same "$work/here" "$work/arm"
fi
echo "1..$count"
