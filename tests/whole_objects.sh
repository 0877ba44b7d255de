#!/usr/bin/env bash
# Kernels that are compiled on demand, and their cache, under all circumstances that a user's machine
# may have: whatever is wrong is safe and said. The lanes of the ball and of the rod stand for those of
# a mechanism; what is compiled must give the bits of the kernel that is built in (test_objects).
# about: runner/objects runner/run analysis/table
# shellcheck disable=SC2016,SC2034
build=$(cd "$(dirname "$0")/../${BUILD:-build}" && pwd)
. "$(dirname "$0")/scratch.sh"
job=$build/tests/test_objects isa=scalar
export STANCE_CACHE=$scratch/cache TMPDIR=$scratch/tmp && mkdir tmp
unset CC XDG_CACHE_HOME
umask 022

others() { # what there is in a directory
    find "$1" -mindepth 1
}
object() { # a file of the cache, by what its name begins with
    ls -d "$STANCE_CACHE/$1"-*.so
}
compiles() { # name, number of lines that the program says beside, job ...: compiled, with the right bits
    expect "$1" 0 "$job" "${@:3}" says 'compiled, the same bits' times $((1 + $2)) '^stance:'
}
# A stand-in for the compiler, of which --version and -dumpmachine are the true ones.
compiler() { # file, what it does instead of compiling
    printf '#!/bin/bash\ncase $1 in --version | -dumpmachine) exec cc "$@" ;; esac\n%s\n' "$2" >"$1"
    chmod +x "$1"
}

# What the compiler has made once of the same source with the same flags it need not make again: the cc in the path
# keeps it.
mkdir tools made
real=$(command -v cc)
cat >tools/cc <<END
#!/bin/bash
case " \$* " in *" --version "* | *" -dumpmachine "*) exec "$real" "\$@" ;; esac
flags=() out=
while ((\$#)); do
    if [ "\$1" = -o ]; then out=\$2 && shift; else flags+=("\$1"); fi
    shift
done
made=$scratch/made/\$({ echo "\${flags[@]}"; "$real" "\${flags[@]}" -E -P; } | sha256sum | cut -c 1-40) || exit
if [ ! -e "\$made" ]; then
    "$real" "\${flags[@]}" -o "\$made.\$\$" || exit
    mv "\$made.\$\$" "\$made"
fi
cp "\$made" "\$out"
END
chmod +x tools/cc
PATH=$scratch/tools:$PATH

# ---- all goes well --------------------------------------------------------------------------------
scenes=(ball)
long_tests && scenes+=(rod)
for scene in "${scenes[@]}"; do
    expect "$scene: compiled" 0 "$job" $scene implicit,midpoint,capturing,lagrange $isa
    times "$scene: ... each with the right bits" 4 'compiled, the same bits'
    expect "$scene: kept" 0 "$job" $scene implicit,midpoint,capturing,lagrange $isa times 4 'kept, the same bits'
done
expect "event-driven is always the one that is built in" 0 "$job" rod event-driven scalar \
    says 'event-driven scalar: built in, the same bits'
expect "... or none" 2 "$job" rod event-driven scalar alone \
    says 'event-driven is not compiled on demand, and none of this size is built in'
objects=$((4 * ${#scenes[@]}))
is "the cache has $objects objects and nothing else" test "$(others "$STANCE_CACHE" | grep -c '\.so$')/$(others "$STANCE_CACHE" | wc -l)" = $objects/$objects
is "... and is the user's alone" test "$(stat -c %a "$STANCE_CACHE" "$STANCE_CACHE"/*.so | sort -u | tr '\n' ' ')" = "600 700 "
fastest=$(timeout "$patience" "$stance" --version | sed -n 's/.*in use: //p')
for isa in $(timeout "$patience" "$stance" --version | sed -n 's/instruction sets \(.*\); in use.*/\1/p' | tr -d ,); do
    expect "rod, $isa" 0 "$job" ball lagrange "$isa" says 'the same bits'
done
isa=scalar
HOME=$scratch/home && mkdir home && export HOME
env -u STANCE_CACHE "$job" ball lagrange scalar >log 2>&1
is "without STANCE_CACHE it is ~/.cache/stance" test -n "$(ls home/.cache/stance/lagrange-*)"
env -u STANCE_CACHE XDG_CACHE_HOME="$scratch/xdg" "$job" ball lagrange scalar >log 2>&1
is "... or XDG_CACHE_HOME's" test -n "$(ls xdg/stance/lagrange-*)"

# ---- several at once ------------------------------------------------------------------------------
rm -rf "$STANCE_CACHE"
for k in 1 2 3; do timeout "$patience" "$job" ball lagrange $isa >"log$k" 2>&1 & done
wait
cat log[123] >log
is "three jobs at once have the right bits" test "$(grep -Ec '(compiled|kept), the same bits' log)" = 3
is "... and leave one object" test "$(others "$STANCE_CACHE")" = "$(object lagrange-$isa)"
expect "... which is whole" 0 "$job" ball lagrange $isa says 'kept, the same bits'
rm -rf "$STANCE_CACHE"
expect "two ranks" 0 mpirun -n 2 "$job" ball lagrange,capturing $isa \
    says '^stance: compiling' times 4 'compiled, the same bits'
expect "two ranks, kept" 0 mpirun -n 2 "$job" ball lagrange,capturing $isa times 4 'kept, the same bits'

rm -rf "$STANCE_CACHE"
expect "two ranks on different processors" 0 mpirun -n 1 "$job" ball lagrange,capturing scalar : -n 1 "$job" ball lagrange "$fastest"
is "... have each its own, with the right bits" test "$(grep -Ec "(0: lagrange scalar|1: lagrange $fastest): compiled, the same bits" log)" = 2

# ---- files that are not what they should be -------------------------------------------------------
spoilt() { # name, what is said, command that spoils a file
    local file # of the command
    file=$(object lagrange-$isa)
    eval "$3" || echo "cannot be made: $3" >&2
    compiles "$1: compiled anew" 1 ball lagrange $isa says "$2: thrown away"
    expect "... and kept" 0 "$job" ball lagrange $isa says 'kept, the same bits'
}
{
    spoilt "an object cut short" 'truncated or damaged' 'truncate -s 1000 "$file"'
    spoilt "an object of nothing" 'truncated or damaged' ': >"$file"'
    spoilt "an object with a bit turned over" 'truncated or damaged' \
        'printf "\101" | dd of="$file" bs=1 seek=9000 conv=notrunc status=none; printf "\102" | dd of="$file" bs=1 seek=9001 conv=notrunc status=none'
    spoilt "another object under its name" 'something else under this name' 'cp "$(object capturing-$isa)" "$file"'
    spoilt "an object that others can write" 'not a file of this user alone' 'chmod 666 "$file"'
    spoilt "a link to an object" 'cannot be read' 'mv "$file" elsewhere && ln -s "$scratch/elsewhere" "$file"'
    spoilt "a pipe" 'not a file of this user alone' 'rm "$file" && mkfifo "$file"'
    if ((UID == 0)); then
        spoilt "an object of another user" 'not a file of this user alone' 'chown nobody "$file"'
    else
        skip "an object of another user" "not root"
    fi
}

# ---- directories that cannot be trusted -----------------------------------------------------------
distrusted() { # name, what is said
    expect "$1 is refused" 3 "$job" ball lagrange $isa says "$2" lines 1
}
chmod 777 "$STANCE_CACHE"
distrusted "a directory that others can write to" "others can write to it: not used as cache; chmod go-w $STANCE_CACHE"
chmod 720 "$STANCE_CACHE"
distrusted "... or the group" "others can write to it: not used as cache; chmod go-w $STANCE_CACHE"
chmod 700 "$STANCE_CACHE"
ln -s cache link
STANCE_CACHE=$scratch/link/ distrusted "a symbolic link" 'a symbolic link: not used as cache; name the directory itself with STANCE_CACHE'
if ((UID == 0)); then
    mkdir theirs && chown nobody theirs
    STANCE_CACHE=$scratch/theirs distrusted "a directory of another user" 'belongs to another user: not used as cache; name a directory of yours'
else
    skip "a directory of another user" "not root"
fi

# ---- no room --------------------------------------------------------------------------------------
STANCE_CACHE=/sys/stance compiles "a home that nothing can be written to" 1 ball lagrange $isa \
    says "compiled for this run alone"
env -u STANCE_CACHE -u HOME "$job" ball lagrange $isa >log 2>&1
says "no home" "neither STANCE_CACHE nor HOME names a directory; compiled for this run alone"
if ((UID == 0)) && mount -t tmpfs -o size=64k none "$disk" 2>/dev/null; then
    mkdir -m 700 "$disk/cache"
    STANCE_CACHE=$disk/cache compiles "a full disk" 1 ball lagrange $isa \
        says 'No space left on device; compiled for this run alone' is 'test -z "$(others "$disk/cache")"'
    mount -o remount,size=1m "$disk"
    cp "$(object lagrange-$isa)" "$disk/cache"
    mount -o remount,ro "$disk"
    STANCE_CACHE=$disk/cache expect "an object on a disk that can only be read" 0 "$job" ball lagrange $isa \
        says 'kept, the same bits'
    STANCE_CACHE=$disk/cache compiles "another one" 1 rod capturing $isa \
        says 'Read-only file system; compiled for this run alone'
    umount "$disk"
else
    skip "a full disk" "no tmpfs can be mounted"
fi
rm -rf "$STANCE_CACHE"
expect "files that may not be larger than 8 kB" 0 bash -c "trap '' XFSZ; ulimit -f 8; '$job' ball lagrange $isa | cat" \
    says "nothing can be compiled in $TMPDIR (TMPDIR): File too large; kernels that are built in compute instead"
is "... and nothing kept" test -z "$(others "$STANCE_CACHE")"
TMPDIR=/nowhere expect "a directory for temporary files that is not there" 0 "$job" ball lagrange $isa \
    says 'nothing can be compiled in /nowhere (TMPDIR): No such file or directory; kernels that are built in compute instead'

# ---- compilers ------------------------------------------------------------------------------------
refused() { # name, what is said, what the job is started with
    expect "$1: the kernel that is built in computes" 0 env "${@:3}" "$job" ball lagrange $isa \
        says 'built in, the same bits' "$2.*kernels that are built in compute instead, more slowly" \
            is 'test -z "$(others "$STANCE_CACHE")"'
}
compiler fusing 'exec cc "$@" -ffp-contract=fast'
CC=./fusing expect "a compiler that fuses: the kernel that is built in computes" 0 "$job" ball lagrange $isa \
    says 'built in, the same bits' \
        'computes another [a-z_]* in check [0-9]*: refused.*kernels that are built in compute instead, more slowly'
is "... and remembered, nothing else" test "$(others "$STANCE_CACHE")" = "$(ls "$STANCE_CACHE/lagrange-$isa"-*.refused)"
CC=./fusing expect "... so that the next job does not compile" 0 "$job" ball lagrange $isa \
    says 'refused.*(known from before; stance build tries again); kernels that are built in compute'
is "... and not that it compiles" test -z "$(grep compiling log)"
compiles "... nor does another compiler mind" 0 ball lagrange $isa
rm -rf "$STANCE_CACHE"
CC=./fusing expect "... whose results are others indeed" 1 "$job" ball lagrange $isa alone
rm -rf "$STANCE_CACHE"
compiler failing 'echo "x.c:1:2: note: before" >&2; echo "x.c:3:4: error: no such thing" >&2; echo "  3 | here" >&2; exit 1'
refused "a compiler that fails" 'failing does not compile lagrange for scalar (exit code 1): x.c:3:4: error: no such thing|  3 | here' CC=./failing
CC=./failing expect "... and no kernel built in" 2 "$job" ball lagrange $isa alone
is "... is said in one line" test "$(grep -vc '^stance: compiling' log)" = 1
compiler dying 'kill -9 $$'
refused "a compiler that is killed" 'dying does not compile lagrange for scalar (signal 9): and does not say why' CC=./dying
compiler empty 'exit 0'
refused "a compiler that makes nothing" 'empty does not compile lagrange for scalar' CC=./empty
compiler other 'while [ "$1" != -o ]; do shift; done; echo text >"$2"'
refused "a compiler that makes no object" 'a compiled kernel cannot be loaded' CC=./other
refused "a compiler that is not there" "the compiler CC='/nowhere/cc' does not run" CC=/nowhere/cc
refused "no compiler" 'there is no compiler here' PATH="$scratch"
CC=/nowhere/cc expect "no compiler, and no kernel built in" 2 "$job" ball lagrange $isa alone \
    says '`stance build` where there is one, and copy '"$STANCE_CACHE/lagrange-$isa-"
if command -v clang >/dev/null; then
    CC=clang compiles "clang" 0 ball lagrange "$fastest"
else
    skip "clang" "not installed"
fi
CC="cc -DUNUSED" compiles "CC may have options" 0 ball lagrange $isa
CC=/nowhere/cc expect "an object serves where there is no compiler, whoever compiled it" 0 "$job" ball lagrange $isa \
    alone says 'kept, the same bits'

# ---- the command ----------------------------------------------------------------------------------
expect "stance build of a scene that the program carries" 0 "$stance" build "$shipped/ball_bounce.yaml" --method \
    lagrange --isa scalar says '^lagrange *scalar *compiled'
expect "... of no scenario" 3 "$stance" build nothing.yaml
expect "... for no method" 2 "$stance" build "$shipped/ball_bounce.yaml" --method lagrang \
    says "stance build: --method takes one of .*lagrange"
expect "... for no instruction set" 2 "$stance" build "$shipped/ball_bounce.yaml" --isa=avx \
    says "stance build: --isa takes one of .*scalar"

pole=$shipped/mechanisms/cart_pole.yaml few=(--set 'sweep.grid[0].count=2' --set 'sweep.grid[1].count=2')
rm -rf "$STANCE_CACHE"
expect "what takes less time than compiling" 0 "$stance" run --quiet -o built_in.h5 "$pole" "${few[@]}"
is "... is computed without" test -z "$(others "$STANCE_CACHE")"
expect "... stance build compiles all the same" 0 "$stance" build "$pole"
expect "... what is kept then computes" 0 "$stance" run --quiet -o kept.h5 "$pole" "${few[@]}"
isas() { "$python" -c 'import h5py, sys; print(*(h5py.File(f).attrs["instruction_set"].decode() for f in sys.argv[1:]))' "$@"; }
is "... each file names what computed" test "$(isas built_in.h5 kept.h5)" = "$fastest $fastest"
is "... the same bits, beside cases at the other stop, too" cmp <("$stance" table built_in.h5) <("$stance" table kept.h5)

CC=./failing expect "... whose compiler fails exits 3" 3 "$stance" build "$pole" --isa scalar --method implicit \
    says 'failing does not compile implicit for scalar' "implicit *$fastest *none: the one built in computes"
STANCE_CACHE=/sys/stance expect "... whose object cannot be kept exits 3" 3 "$stance" build "$pole" \
    says 'for this run alone' 'midpoint .* compiled, but not kept'

# ---- in the middle of a run -----------------------------------------------------------------------
# A compiler that waits until rows are in the file, which kernels that are built in have computed.
compiler waiting 'until [ -e '"$scratch"'/go ]; do sleep 0.1; done; exec cc "$@"'
rm -rf "$STANCE_CACHE"
many=(--set 'sweep.grid[0].count=201' --set 'sweep.grid[1].count=201')
rows() { timeout "$patience" "$stance" status --json "$1" 2>/dev/null | "$python" -c 'import json, sys; print(json.load(sys.stdin)["done"])' 2>/dev/null || echo 0; }
comes() { # name, compiler, what starts the run ...: while it runs, the compiler ends
    local own
    rm -rf "$STANCE_CACHE" go
    CC=$scratch/$2 timeout "$patience" "${@:3}" "$stance" run --quiet --force -o comes.h5 "$pole" "${many[@]}" >log 2>&1 &
    own=$!
    until [ -e comes.h5 ] && (($(rows comes.h5) > 0)) || ! kill -0 $own 2>/dev/null; do sleep 0.1; done
    is "$1: rows are there before it is compiled" test -z "$(others "$STANCE_CACHE" | grep -v part)"
    touch go
    until [ -n "$(others "$STANCE_CACHE" | grep -v part)" ] || ! kill -0 $own 2>/dev/null; do sleep 0.1; done
    is "... which ends before the run does" kill -0 $own
    wait $own
    result $? "... that goes on"
    result $(($(grep -vc '^stance: compiling' log) != 0)) "... and has nothing to say of it"
}
comes "a compiled kernel that comes later" waiting
mv comes.h5 first.h5
expect "... a run that has it from the beginning" 0 "$stance" run --quiet --force -o all.h5 "$pole" "${many[@]}"
is "... the same bits" "$stance" compare all.h5 first.h5
comes "of two ranks" waiting mpirun -n 2
is "... the same bits" "$stance" compare all.h5 comes.h5
later() { # name, what is said, what the run is started with ...: none comes
    rm -rf "$STANCE_CACHE"
    expect "$1" 0 env "${@:3}" "$stance" run --quiet --force -o comes.h5 "$pole" "${many[@]}" \
        says "$2.*kernels that are built in compute on, more slowly" is "$stance" compare all.h5 comes.h5
}
later "a compiler that fails while kernels that are built in compute" 'failing does not compile' CC=./failing
# (Made before, so that it comes while there still are cases, however busy the machine is.)
CC=./fusing "$stance" build "$pole" >log 2>&1
later "... or fuses" 'computes another [a-z_]* in check [0-9]*: refused' CC=./fusing
is "... remembered" test -n "$(others "$STANCE_CACHE" | grep 'refused$')"

# ---- signals, and kills ---------------------------------------------------------------------------
# A compiler that starts others and does not end.
compiler slow 'echo $$ >compiling; sleep 1000 & wait'
stopped() { # name, exit code, whom to tell, command ...
    local group own
    CC=$scratch/slow timeout "$patience" "${@:4}" >log 2>&1 &
    own=$!
    until [ -s "$(echo "$TMPDIR"/stance-*/compiling)" ]; do sleep 0.1; done
    group=$(cat "$TMPDIR"/stance-*/compiling)
    eval "kill -TERM $3"
    wait $own
    result $(($? != $2)) "$1: exit code $2"
    is "... the compiler is gone, and what it started" test -z "$(ps -o pid= -g "$group")"
    is "... and its directory" test -z "$(ls -d "$TMPDIR"/stance-* "$STANCE_CACHE"/* 2>/dev/null)"
}
rm -rf "$STANCE_CACHE"
many=(--set 'sweep.grid[0].count=401' --set 'sweep.grid[1].count=401' --force)
stopped "a run that is told to stop while it compiles" 4 '$(pgrep -P $own)' "$stance" run --quiet -o stopped.h5 "$pole" "${many[@]}"
says "... says how to go on" 'stopped .* go on with'
stopped "stance build that is told to stop" 143 '$(pgrep -P $own)' "$stance" build "$pole" "${many[@]:0:4}"
for rank in 1 2; do
    stopped "of two ranks rank $((rank - 1)) that is told to stop" 4 '$(pgrep -P $(pgrep -P $own) stance | sed -n ${rank}p)' \
        mpirun -n 2 "$stance" run --quiet -o stopped.h5 "$pole" "${many[@]}"
done

# ---- the largest size -----------------------------------------------------------------------------
rm -rf "$STANCE_CACHE"
compiles "a cache of one object" 0 ball lagrange $isa
touch -d '100 days ago' "$(object lagrange)"
truncate -s 200M "$STANCE_CACHE/large-scalar-0.so" "$STANCE_CACHE/larger-scalar-0.so"
truncate -s 1M "$STANCE_CACHE/0.part" "$STANCE_CACHE/notes.txt"
touch -d '20 days ago' "$STANCE_CACHE/larger-scalar-0.so"
touch -d '30 days ago' "$STANCE_CACHE/large-scalar-0.so"
touch -d '40 days ago' "$STANCE_CACHE/0.part"
touch -d '50 days ago' "$STANCE_CACHE/notes.txt"
expect "an old one" 0 "$job" ball lagrange $isa says 'kept, the same bits'
compiles "another one" 0 ball capturing $isa \
    is 'test "$(cd "$STANCE_CACHE" && echo *)" = "$(cd "$STANCE_CACHE" && echo capturing-* lagrange-* larger-scalar-0.so notes.txt)"'
