#!/usr/bin/env bash
# Inputs of every size and kind that are no inputs: each is one clear error, at once, in little memory.
# What they hold inside is fuzzed (whole_fuzz.sh); this is about what is given where a file, a number
# or a name is meant.
#
. "$(dirname "$0")/scratch.sh"
# "At once" is said of the processor's time, which others do not lengthen. Sanitizers reserve addresses
# by the terabyte.
computing=20 memory=2000000 # s, kB
[ -n "${STANCE_SLOW:-}" ] && computing=120 memory=unlimited
limited() { # command ...: what it prints in out, what it says in log
    (ulimit -v "$memory" && ulimit -t "$computing" && exec timeout "$patience" "$@") >out 2>log </dev/null
}
# A command that must fail with this code and say exactly one line, which matches.
refused() { # name, code, pattern, command ...
    limited "${@:4}"
    [ $? = "$2" ] && [ "$(wc -l <log)" = 1 ] && grep -q -- "$3" log && [ ! -s out ]
    result $? "$1"
}
accepted() { # name, command ...
    limited "${@:2}" && ! grep -qv ': warning: ' log
    result $? "$1"
}
good=$shipped/ball_bounce.yaml
repeat() { # how often, text: as one line
    awk -v n="$1" -v text="$2" 'BEGIN {for (i = 0; i < n; i++) printf text}'
}

# ---- text that is too much of something -----------------------------------------------------------
head -c 67108864 /dev/zero | tr '\0' a >large.yaml
refused "64 MB of text" 2 'large.yaml: larger than 1 MiB' "$stance" check large.yaml
seq -f 'key%.0f: 1' 100000 | head -c 1000000 >keys.yaml
refused "a hundred thousand keys" 2 'keys.yaml:1001:1: more than 1000 keys in one mapping' "$stance" check keys.yaml
{ printf 'stance: 1\nrobot: ' && repeat 100000 '['; } >deep.yaml
refused "a hundred thousand lists in each other" 2 'deep.yaml:2:[0-9]*: nested deeper than 32 levels' "$stance" check deep.yaml
{ printf 'stance: 1\nrobot: ' && repeat 100000 '{a: '; } >deep.yaml
refused "a hundred thousand mappings in each other" 2 'deep.yaml:2:[0-9]*: nested deeper than 32 levels' "$stance" check deep.yaml
{ echo 'a0: &a0 [x, x, x, x, x, x, x, x]' && for i in $(seq 100); do
    echo "a$i: &a$i [*a$((i - 1)), *a$((i - 1)), *a$((i - 1)), *a$((i - 1)), *a$((i - 1)), *a$((i - 1)), *a$((i - 1))]"
done; } >bomb.yaml
refused "aliases of aliases of aliases" 2 'bomb.yaml:[0-9]*:[0-9]*: aliases expand to more than 100000 nodes' "$stance" check bomb.yaml
seq 300 | sed 's/.*/a&: \&a& 1/' >anchors.yaml
refused "hundreds of anchors" 2 'anchors.yaml:257:[0-9]*: more than 256 anchors' "$stance" check anchors.yaml
refused "a --set of a megabyte" 2 "is not a path\|longer than" bash -c "'$stance' check '$good' --set \"\$(head -c 120000 /dev/zero | tr '\\0' a)=1\""

# Thousands of wrong words: the first ones are shown, the others counted, none takes long.
{ printf 'stance: 1\nscene: biped\nrecord: {answers: [' && seq -f 'word%.0fxxxxxxxxxxxxxxxx, ' -s '' 30000 && echo ']}'; } >words.yaml
limited "$stance" check words.yaml
[ $? = 2 ] && [ "$(wc -l <log)" = 21 ] && tail -n 1 log | grep -q 'more errors$'
result $? "thousands of unknown words"

# ---- bytes that are no text -----------------------------------------------------------------------
printf 'stance: 1\n\0scene: ball\n' >bytes.yaml
refused "a zero byte" 2 'bytes.yaml:2:1: not text: the control character U+0000' "$stance" check bytes.yaml
printf 'stance: 1\nsc\377ne: ball\n' >bytes.yaml
refused "bytes that are not UTF-8" 2 'bytes.yaml:2:3: not UTF-8 text (byte 0xff)' "$stance" check bytes.yaml
sed 's/./&\x00/g' "$good" >bytes.yaml
refused "UTF-16" 2 'bytes.yaml:1:2: not text' "$stance" check bytes.yaml
{ printf '\357\273\277' && cat "$good"; } >mark.yaml
accepted "a byte order mark is taken" "$stance" check mark.yaml
sed 's/$/\r/' "$good" >lines.yaml
accepted "lines that end as on other systems are taken" "$stance" check lines.yaml

# ---- what is no file ------------------------------------------------------------------------------
mkdir folder.yaml && mkfifo pipe && ln -s loop loop && ln -s pipe to_pipe
refused "a folder as scenario" 2 'folder.yaml: is a directory, not a file' "$stance" check folder.yaml
refused "a pipe without a writer as scenario" 2 'pipe: a named pipe into which nothing is written' "$stance" check pipe
refused "/dev/zero as scenario" 2 '/dev/zero: larger than 1 MiB' "$stance" run /dev/zero
refused "a link to itself as scenario" 3 'loop: Too many levels of symbolic links' "$stance" design loop
accepted "what another command writes is waited for" bash -c "'$stance' check <(sleep 1.2; cat '$good')"
accepted "a file to compare with" "$stance" run "$good" --only 0 -o one.h5 --quiet
for file in pipe to_pipe /dev/zero loop folder.yaml missing; do
    case $file in
    loop) why='Too many levels of symbolic links' ;;
    folder.yaml) why='Is a directory' ;;
    missing) why='No such file or directory' ;;
    *) why='not a file' ;;
    esac
    for command in summary status plot "compare one.h5" "bench plot"; do
        # shellcheck disable=SC2086
        refused "$command $file" 3 "$file: .*$why" "$stance" $command $file
    done
done
for file in pipe /dev/zero folder.yaml; do
    refused "run into $file" 3 "$file: not a regular file" "$stance" run "$good" --only 0 --force -o $file
done
refused "a resume of a link to a pipe" 3 'to_pipe: not a file' "$stance" run "$good" --resume -o to_pipe
truncate -s 17M table.csv
refused "a table of benchmarks of 17 MB" 3 'larger than 16 MiB' "$stance" bench plot table.csv
printf 'subject,scene\n1,2\n' >table.csv
refused "a table of something else" 3 'table.csv:1: not a line of a table of benchmarks' "$stance" bench plot table.csv
truncate -s 1T sparse.h5
refused "a terabyte of nothing as results" 3 'sparse.h5: not an HDF5 file' "$stance" summary sparse.h5

# ---- what fuzzing found in results files ------------------------------------------------------------
accepted "a file with trajectories" "$stance" run "$shipped/block_threshold.yaml" --quiet -o tracks.h5 \
    --set 'record={every: 0.1, cases: [0]}' --set 'sweep.grid[0].count=3' --set 'sweep.grid[1].count=2'
holds "every header in a results file has a checksum" <<'END'
data = bytearray(open("tracks.h5", "rb").read())
with h5py.File("tracks.h5") as file:
    names = ["/"]
    file.visit(names.append)
    at = {name: h5py.h5o.get_info(file[name].id).addr for name in names}
# Headers of version 2 and later have a checksum.
bare = [name for name in names if data[at[name]:at[name] + 4] != b"OHDR"]
assert not bare, bare
data[at["trajectory/force"] + 20] ^= 4
open("force.h5", "wb").write(data)
END
refused "a trajectory that cannot be opened is no trajectory without it" 3 'force.h5: cannot read trajectory/force' \
    "$stance" plot force.h5 --case 0

# ---- numbers, names and counts beyond what there is ------------------------------------------------
huge='sweep.grid=[{path: ground.restitution, from: 0, to: 0.9, count: 1e9}, {path: stop.time, from: 1, to: 2, count: 9e6}'
biped=$shipped/basin_one_foot.yaml
refused "more designs than can be" 2 'more than the 4194304 controller designs that are kept in memory' "$stance" check "$biped" \
    --set 'sweep.grid=[{path: robot.trunk_mass, from: 1, to: 2, count: 1e9}]'
# One step of it would take minutes (test_limits has it too): `check` tries it, says so, and returns.
endless="$scratch/endless.yaml"
cat >"$endless" <<'END'
stance: 1
scene: biped
robot: {leg_length: 0.003, trunk_length: 62.5, foot_mass: 0.0044, trunk_mass: 0.0023, hip_mass: 2}
ground: {friction: 0}
initial: {state: {z: 62.51, theta: 0.02, q1: 0.011, q2: -0.106, vq1: 0.028, vq2: 0.295}}
controller: {kind: hold, kp: 65, kd: 4.7e6, torque_limit: 8, target: {q1: 0.028, q2: -0.1005}}
method: {name: capturing, step: 0.001, tolerance: 1e-4}
stop: {time: 1, settle: off, fall_height: 0}
END
accepted "a step without end is checked in no time" "$stance" check "$endless"
# Designs of a minute and of hours: what there was no time for is said.
cat >designs.yaml <<'END'
stance: 1
scene: biped
ground: {friction: 0.8, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, design: place, design_time: sampled,
             poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], sample_time: 0.001, torque_limit: 10}
method: {name: event-driven, step: 0.001, tolerance: 1.0e-13}
stop: {time: 800}
sweep:
  grid:
    - {path: controller.sample_time, from: 0.001, to: 0.1, count: 2000}
    - {path: robot.trunk_mass, from: 1.7, to: 1.9, count: 1000}
END
prints() { # pattern ...: out has them
    for pattern; do is "... and says $pattern" grep -q -- "$pattern" out; done
}
some='designs     2000000 distinct, [1-9][0-9]* of them computed: all exist$'
accepted "two million designs are checked in no time" "$stance" check designs.yaml
prints "$some" 'unchecked   the other [1-9][0-9]* and the initial states of their cases$' \
    'cost        \(at most \)\?about [0-9.]* h'
accepted "... as JSON" "$stance" check --json designs.yaml
prints '"designs_computed": [1-9][0-9]\{0,5\},'
accepted "... planned" "$stance" run --dry-run designs.yaml
prints "$some"
refused "more cases than fit a number" 2 'make more than 2^53 cases' "$stance" check "$good" --set "$huge, {path: ground.friction, from: 0, to: 1, count: 2}]"
refused "more instants than fit a file" 2 'record.every: .* instants' "$stance" check "$good" --set 'record={every: 1e-300, cases: all}'
refused "a file that no disk holds" 3 'results/ball_bounce.h5' "$stance" run "$good" --quiet --set "$huge]"
refused "a case that is no number" 2 '--only' "$stance" run "$good" --only 99999999999999999999999
refused "a case beyond the last" 2 '--only 18446744073709551614' "$stance" run "$good" --only 18446744073709551614
refused "a time that is none" 2 '--time-limit' "$stance" run "$good" --time-limit 1e999h
refused "an unknown instruction set" 2 'STANCE_ISA' env STANCE_ISA="$(head -c 5000 /dev/zero | tr '\0' x)" "$stance" check "$good"
refused "a name longer than names are" 3 'too long' "$stance" run "$good" -o "$(head -c 5000 /dev/zero | tr '\0' x)"
refused "a scenario with such a name" 3 'too long' "$stance" check "$(head -c 5000 /dev/zero | tr '\0' x)"
refused "an option that is none" 2 'unknown option' "$stance" check "--$(head -c 5000 /dev/zero | tr '\0' x)"
