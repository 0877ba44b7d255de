#!/usr/bin/env bash
# `make install`: everything is there and works from there, and `make uninstall` leaves nothing. What is made
# of the tables of options (help, manual pages, completion) has every command and option; the schema takes every
# scenario that ships, as PyYAML (YAML 1.1) reads it.
. "$(dirname "$0")/scratch.sh"
root=$(dirname "$tests") build=$(cd "$root" && realpath "${BUILD:-build}")
# As it is: other tests run beside this one.
made=(make -s -C "$root" -o "$stance" -o "$build/libstance.a" -o "$build/libstance_control.a"
    BUILD="$build" PROGRAM="$stance" STAGE="$scratch/stage" DESTDIR="$scratch/dest" PREFIX=/opt/stance)
at=$scratch/dest/opt/stance
mkdir -p "$scratch/dest/opt" && : >"$scratch/dest/opt/other"

expect "make install" 0 "${made[@]}" install
for f in bin/stance lib/libstance.a lib/libstance_control.a lib/pkgconfig/stance.pc include/stance/engine/stance.h \
    include/stance/engine/control/design.h share/stance/scenario.schema.json share/doc/stance/LICENSE \
    share/doc/stance/CITATION.cff share/stance/scenarios/basin_one_foot.yaml share/man/man5/stance-scenario.5; do
    is "... $f" test -s "$at/$f"
done
expect "the program runs there" 0 "$at/bin/stance" check "$at/share/stance/scenarios/drop.yaml"

# ---- manual pages -------------------------------------------------------------------------------
names=$("$stance" -h | awk '/^  [a-z]/ {print $1}')
is "the help lists commands" [ "$(wc -w <<<"$names")" -ge 15 ]
for name in $names bench-accuracy; do
    page=$at/share/man/man1/stance-$name.1
    man --warnings -l "$page" >page 2>log
    grep -q 'SEE ALSO' page && [ ! -s log ] && "$stance" ${name/-/ } -h | awk 'NR == 1 {print $3}' | grep -qF -f - page
    result $? "man stance-$name"
done
# Every line of the help stands in the page, but for how paragraphs are filled.
man -l "$at/share/man/man1/stance-basin.1" 2>/dev/null | sed 's/‐$//' | tr -d ' \n-' >page
"$stance" basin -h | awk 'blank >= 2; /^$/ { blank++ }' | tr -d ' \n-' | head -c 700 >part
tr -d '‐' <page | grep -qF -f part
result $? "... says what the help says"
for said in "basin:(2 to 1000)" "run:(not with --only --extend --force-scenario)" "compare:(with --labels)"; do
    "$stance" "${said%%:*}" -h | tr -s ' \n' ' ' | grep -qF -- "${said#*:}"
    result $? "... ${said%%:*}: ${said#*:}"
done

# ---- completion ---------------------------------------------------------------------------------
"$stance" help --options >commands
cut -f2 commands | grep -v '^-$' | sort -u >offered
grep -rhoE '(\{| )"--?[a-z-]+",' "$root"/runner "$root"/analysis --include='*.[ch]' | grep -oE -- '-[^"]*' | sort -u >taken
comm -23 offered taken >log
is "options are rows of tables" '[ ! -s log ] && [ "$(wc -l <offered)" -ge 40 ]'
awk -F'\t' '$2 != "-" {print $1 "\t" $2}' commands | while IFS=$'\t' read -r command option; do
    # shellcheck disable=SC2086
    "$stance" $command -h | awk '/^$/ { exit } { print }' | grep -qE -- "[[| ]$option( |\]|\$)" || echo "$command $option"
done >log
is "every option that a command takes is in its synopsis" [ ! -s log ]
# (-h after it: nothing else is done.)
awk -F'\t' '$2 != "-" {print $1, $2, $3 == "-" ? "" : "x", "-h"}' commands | while read -r command; do
    # shellcheck disable=SC2086
    "$stance" $command </dev/null >/dev/null 2>&1 || echo "$command"
done >log
is "... and taken by the command whose synopsis has it" [ ! -s log ]
complete_bash() { # words ...: what is offered, in a line
    PATH=$at/bin:$PATH bash -c '. "$0"; COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); _stance; echo "${COMPREPLY[@]}"' \
        "$at/share/bash-completion/completions/stance" "$@"
}
cp "$shipped/drop.yaml" .
offers() { # name, wanted, words ...
    complete_bash "${@:3}" >log 2>&1
    is "bash: $1" [ "$(cat log)" = "$2" ]
}
offers "commands" "summary" stance su
offers "options" "--resume" stance run --re
offers "scenarios" "drop.yaml" stance check dr
offers "paths" "ground.friction" stance describe ground.f
offers "paths to set" "stop.time" stance run drop.yaml --set stop.t
offers "words" "drop fallen" stance sensitivity --failed ""
offers "outcomes" "stabilised" stance compare --of stab
offers "methods" "lagrange" stance build --method la
offers "commands of bench" "accuracy" stance bench acc
for shell in zsh fish; do
    file=$at/share/$shell/$([ $shell = zsh ] && echo site-functions/_stance || echo vendor_completions.d/stance.fish)
    if command -v $shell >/dev/null; then
        expect "$shell reads its completion" 0 $shell -n "$file"
    else
        skip "$shell reads its completion" "no $shell"
    fi
    missing=$(cut -f2 commands | grep -v '^-$' | sed 's/^-*//' | sort -u | while read -r o; do grep -qE -- "-[ls]? ?$o\b" "$file" || echo "$o"; done)
    echo "$missing" >log
    is "... with every option" [ -z "$missing" ]
done
if command -v fish >/dev/null; then
    HOME=$scratch PATH=$at/bin:$PATH fish -c "source $at/share/fish/vendor_completions.d/stance.fish; complete -C 'stance run --re'" >log 2>&1
    says "fish: options" "^--resume"
fi

# ---- schema -------------------------------------------------------------------------------------
cat >schema.py <<'END'
import glob, json, sys
import jsonschema, yaml
schema = json.load(open(sys.argv[1] + "/scenario.schema.json"))
jsonschema.Draft202012Validator.check_schema(schema)
validator = {s["properties"]["scene"]["enum"][0]: jsonschema.Draft202012Validator(s) for s in schema["oneOf"]}
files = glob.glob(sys.argv[1] + "/scenarios/**/*.yaml", recursive=True)
for file in files:
    with open(file) as text:
        read = yaml.safe_load(text)
    if "truths" in read:
        continue # of `make truths`: a list, no scenario
    scenario = read
    for error in validator[scenario["scene"]].iter_errors(scenario):
        sys.exit(f"{file}: {list(error.path)}: {error.message}")
assert len(files) > 40
scenario["ground"]["fricton"] = 1
assert not validator[scenario["scene"]].is_valid(scenario)
END
if "$python" -c 'import yaml, jsonschema' 2>/dev/null; then
    expect "the schema takes every scenario that ships, read as YAML 1.1" 0 "$python" schema.py "$at/share/stance"
else
    skip "the schema takes every scenario that ships" "no PyYAML or jsonschema"
fi

# ---- the library --------------------------------------------------------------------------------
if [ -n "${STANCE_SLOW:-}" ]; then
    skip "the example" "a library with sanitizers"
else
    cp "$at/share/stance/scenarios/library/balance.c" .
    flags=$(PKG_CONFIG_PATH=$at/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$scratch/dest pkg-config --cflags --libs stance)
    # shellcheck disable=SC2086
    expect "the example compiles against what is installed" 0 \
        "${CC:-cc}" -std=c17 -Wall -Wextra -Werror -Wno-missing-field-initializers -g0 balance.c $flags -o balance
    expect "... and runs" 0 ./balance
    ./balance | awk '{print $4}' | tr '\n' ' ' >example
    cat >example.yaml <<'END'
stance: 1
scene: biped
ground: {friction: 0.8, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, design: lqr, sample_time: 0.001, torque_limit: 10}
method: {name: capturing, step: 0.001}
stop: {time: 8}
sweep: {grid: [{path: initial.offset.theta, from: -0.12, to: 0.06, count: 19}]}
END
    "$stance" run example.yaml --quiet -o example.h5
    "$stance" table example.h5 --answer outcome | awk -F, 'NR > 1 {print $NF}' | tr -d '\r' | tr '\n' ' ' >program
    is "... its cases end as the program's do" 'diff example program >log'
fi

# ---- again, and gone ----------------------------------------------------------------------------
expect "make install over it" 0 "${made[@]}" install
expect "make uninstall" 0 "${made[@]}" uninstall
find "$scratch/dest" -mindepth 1 | grep -v '/opt$\|/opt/other$' >log
is "... leaves nothing, and what was there before" '[ ! -s log ] && [ -e "$scratch/dest/opt/other" ]'
expect "make uninstall of nothing says so" 2 "${made[@]}" uninstall
