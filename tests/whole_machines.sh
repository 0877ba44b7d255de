#!/usr/bin/env bash
# One hash for each kernel whatever the machine: this processor's instruction sets, an x86-64 without
# AVX and fused multiply-adds (emulated), a 64-bit ARM (`make test-neon`: cross-compiled and
# emulated), and WebAssembly under node and in a browser (`make test-web`). What cannot be had is skipped with a
# notice. GOLDEN_CASES of each scene and method; 500 are 24,000 in all.
# long
set -u
cd "$(dirname "$0")/.."
build=${BUILD:-build} neon=build/neon${NEON_CFLAGS:=-O1} cases=${GOLDEN_CASES:-10} count=0
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
web() { # is there all that it takes?
    command -v node >/dev/null && command -v llvm-ar >/dev/null &&
        clang --target=wasm32-wasi -x c - -o "$work/probe" <<<'int main(void) { return 0; }' 2>/dev/null
}
if ! web; then
    echo "# skipped: WebAssembly (make test-web installs compiler and node)"
else
    check "WebAssembly builds" env -u BUILD make golden-web
    check "WebAssembly runs" sh -c "node --no-warnings tests/wasi.mjs build/web/tests/golden $cases >'$work/web'"
    check "WebAssembly: wasm128 alone" only wasm128 "$work/web"
    check "WebAssembly: all of them" [ "$(awk '$3 == "wasm128"' "$work/web" | wc -l)" = 48 ]
    check "WebAssembly: the same" same "$work/here" "$work/web"
    if node -e 'import("./tests/web.mjs").then((web) => process.exit(web.browser ? 0 : 1))'; then
        check "WebAssembly in a browser runs" sh -c "node --no-warnings tests/wasi.mjs --browser build/web/tests/golden $cases >'$work/browser'"
        check "WebAssembly in a browser: the same" cmp "$work/web" "$work/browser"
    else
        echo "# skipped: a browser (make packages-pages installs one)"
    fi
fi
echo "1..$count"
