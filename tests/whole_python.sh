#!/usr/bin/env bash
# `import stance`: the package from a checkout and from where it is installed, every line of analysis/python.md, and
# its first study in a notebook where Debian's kernel is.
# about: runner/install analysis/python/stance analysis
# shellcheck disable=SC2154
. "$(dirname "$0")/scratch.sh"
root=$(dirname "$tests") build=$(cd "$root" && realpath "${BUILD:-build}") page=$root/analysis/python.md
export PYTHONPATH=$root/analysis/python PYTHONDONTWRITEBYTECODE=1
here() { # folder: a fresh one, with the README's robot
    mkdir -p "$scratch/$1" && cd "$scratch/$1" && ln -sfn "$shipped" scenarios
    awk '/^    # own.yaml$/ { robot = 1; next } robot && !/^    / { exit } robot { print substr($0, 5) }' "$root/README.md" >own.yaml
}
checks() { # what python_package.py tells, counted on here
    "$python" "$tests/python_package.py" "$@" >log 2>&1
    retold log
    tells "... all of $1" '^1\.\.[0-9]+$'
}
if ! "$python" -c 'import h5py, xarray, yaml' 2>/dev/null; then
    skip "the package" "no h5py, xarray or PyYAML"
    exit
fi

here package
checks package
here page
checks page "$page"
if "$python" -c 'import nbclient, ipykernel' 2>/dev/null; then
    here notebook
    checks notebook "$page"
else
    skip "the study in a notebook" "no python3-nbclient and python3-ipykernel, which tests do not install"
fi

# ---- how long it is: it computes nothing ----------------------------------------------------------
(($(cat "$root"/analysis/python/stance/*.py | wc -l) <= 600)) && ! grep -nE 'shell=True|os\.system' "$root"/analysis/python/stance/*.py
result $? "the package is 600 lines at most, and calls no shell"

# ---- installed ----------------------------------------------------------------------------------
here installed
made=(make -s -C "$root" -o "$stance" -o "$build/libstance.a" -o "$build/libstance_control.a" BUILD="$build"
    PROGRAM="$stance" PYTHON="$python" STAGE="$scratch/stage" DESTDIR="$scratch/dest ü")
unset PYTHONPATH PYTHONDONTWRITEBYTECODE
for prefix in /usr/local /opt/stance; do
    expect "make install below $prefix" 0 "${made[@]}" PREFIX=$prefix install
    found=$(cd "$scratch/dest ü$prefix/lib" && echo python*/*-packages)
    if [ $prefix = /usr/local ]; then
        "$python" -c 'import sys; sys.exit(sys.argv[1] not in sys.path)' "$prefix/lib/$found" || [ ! -d "$prefix/lib/$found" ]
        result $? "... where Python looks by itself: lib/$found"
    fi
    # What another STANCE names is not asked for: the program beside it is found.
    PYTHONPATH="$scratch/dest ü$prefix/lib/$found" expect "... is imported from there" 0 env -u STANCE "$python" -c '
import os, sys
import stance
assert stance.__file__.startswith(sys.argv[1]) and stance.program() == sys.argv[1] + "/bin/stance", stance.program()
assert stance.scenario("own.yaml").check()["cases"] == 1' "$scratch/dest ü$prefix"
    expect "make uninstall" 0 "${made[@]}" PREFIX=$prefix uninstall
    [ -z "$(find "$scratch/dest ü" -name '*.py*' -o -name stance 2>/dev/null)" ]
    result $? "... leaves nothing of it, nor what Python made of it"
done
