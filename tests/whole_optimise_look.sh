#!/usr/bin/env bash
# What is said and drawn of the file of a search, finished, cut short, damaged, and of several: see searches.py.
# about: runner/optimise analysis/plot
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/searches.py" "$stance"
