#!/usr/bin/env bash
# What the stepping kernels execute in one case-step: instructions, how many of them work on vector
# registers, how many of those touch the stack (spills, and state that lives there), and the
# arithmetic by kind. Counted by callgrind, which runs every instruction of the kernel's functions
# (up to AVX2: it knows no AVX-512); cycles by perf, where the machine lets it count them. A second
# table counts the same in the object files, executed or not.
# Usage: tests/profile.sh [SCENE REGIME [METHOD]...]   default: biped 'one foot' implicit midpoint capturing
set -u
cd "$(dirname "$0")/.."
stance=${STANCE:-bin/stance} build=${BUILD:-build}
scene=${1:-biped} regime=${2:-one foot}
shift $(($# < 2 ? $# : 2))
methods=("${@:-implicit}")
(($# > 0)) || methods=(implicit midpoint capturing)
cases=16
scratch=$(mktemp -d) && trap 'rm -rf "$scratch"' EXIT
command -v objdump >/dev/null || { echo "profile: objdump is missing (apt-get install binutils)" >&2; exit 1; }

# address <tab> letters, one for each class: v vector register, s stack, + - * / fused root.
classify='
function flush(    i) {
    for (i = 1; i <= n; i++) {
        text = line[i]; class = "i"
        vector = text ~ /%[xyz]mm/
        if (vector) class = class "v"
        if (text ~ /\(%rsp/ || (frame && text ~ /\(%rbp/)) class = class (vector ? "s" : "t")
        if (text ~ /^v?(add|sub)[sp]d/) class = class "a"
        if (text ~ /^v?mul[sp]d/) class = class "m"
        if (text ~ /^vfn?m(add|sub)/) class = class "f"
        if (text ~ /^v?div[sp]d/) class = class "d"
        if (text ~ /^v?sqrt[sp]d/) class = class "r"
        if (text ~ /^call/) class = class "c"
        print address[i] "\t" class
    }
    n = 0; frame = 0
}
/^[0-9a-f]+ <.*>:$/ { flush(); next }
/^ *[0-9a-f]+:\t/ {
    n++
    split($0, part, "\t")
    gsub(/[ :]/, "", part[1]); address[n] = part[1]; line[n] = part[2]
    if (part[2] ~ /^mov +%rsp,%rbp/) frame = 1
}
END { flush() }'

# Sums of the classes, weighted by how often, as a row of the table.
tally='
function add(class, count,    i, c) {
    for (i = 1; i <= length(class); i++) { c = substr(class, i, 1); sum[c] += count }
}
function row(name, steps, cycles) {
    printf "%-28s %8.0f %8s %8.0f %8.0f %7.0f%% %7.0f %7.0f %6.0f %7.1f %7.1f\n", name, sum["i"] / steps, cycles,
        sum["v"] / steps, sum["s"] / steps, sum["v"] ? 100 * sum["s"] / sum["v"] : 0, sum["a"] / steps,
        sum["m"] / steps, sum["f"] / steps, sum["d"] / steps, sum["r"] / steps
}'
head() {
    printf '%-28s %8s %8s %8s %8s %8s %7s %7s %6s %7s %7s\n' "$1" instr. cycles vector stack "of them" \
        add mul fma div sqrt
}

# Instructions and cycles per case-step from the counters of the processor; "-" where it has none.
cycles_of() { # method isa
    local rounds=20 total steps
    command -v perf >/dev/null || { echo -; return; }
    total=$(STANCE_ISA=$2 perf stat -x, -e cycles:u -o "$scratch/perf" "$stance" bench --json --repeats $rounds \
        --cases 256 --scene "$scene" --regime "$regime" --method "$1" >"$scratch/perf.json" 2>/dev/null &&
        awk -F, '/cycles/ {print $1}' "$scratch/perf")
    steps=$(sed -n 's/.*"steps": \([0-9.]*\).*/\1/p' "$scratch/perf.json")
    [[ $total =~ ^[0-9]+$ ]] || { echo -; return; }
    awk -v t="$total" -v s="$steps" -v r=$rounds 'BEGIN { printf "%.0f", t / (s * (r + 1)) }'
}

isas=$(for o in "$build/kernel/$scene-${methods[0]}"-*.o; do basename "$o" .o | sed 's/.*-//'; done)
objdump -d --no-show-raw-insn "$stance" | awk "$classify" >"$scratch/classes"

echo "$scene, $regime: executed in one case-step"
head "kernel"
if command -v valgrind >/dev/null; then
    for method in "${methods[@]}"; do
        for isa in scalar sse2 neon avx2; do
            grep -qx $isa <<<"$isas" || continue
            STANCE_ISA=$isa valgrind --tool=callgrind --dump-instr=yes --compress-strings=no --compress-pos=no \
                --callgrind-out-file="$scratch/run" "$stance" bench --json --repeats 1 --cases $cases \
                --scene "$scene" --regime "$regime" --method "$method" >"$scratch/json" 2>"$scratch/log" ||
                { echo "profile: $method, $isa: $(tail -n 1 "$scratch/log")" >&2; continue; }
            lanes=$(sed -n 's/.*"lanes": \([0-9]*\).*/\1/p' "$scratch/json")
            steps=$(sed -n 's/.*"steps": \([0-9.]*\).*/\1/p' "$scratch/json")
            # Functions of the kernel are those defined in engine/core; all ran twice, once to warm up.
            awk -v steps="$steps" -v name="$method $isa, $lanes lanes" -v cycles="$(cycles_of "$method" $isa)" "$tally"'
                FNR == NR { class[$1] = $2; next }
                /^fl=/ { ours = /engine\/(core|methods)\// }
                /^calls=/ { getline; next }
                ours && /^0x/ { add(class[substr($1, 3)], $NF) }
                END { row(name, 2 * steps, cycles) }' "$scratch/classes" "$scratch/run"
        done
    done
else
    echo "profile: valgrind is missing (apt-get install valgrind)" >&2
fi

echo
echo "In the object files, whether executed or not"
head "kernel"
for method in "${methods[@]}"; do
    for isa in $isas; do
        object=$build/kernel/$scene-$method-$isa.o
        [ -e "$object" ] || continue
        objdump -d --no-show-raw-insn "$object" | awk "$classify" |
            awk -v name="$method $isa" "$tally"'{ add($2, 1) } END { row(name, 1, "-") }'
    done
done
