#!/usr/bin/env bash
# What analysis/questions.md tells is what comes out.
. "$(dirname "$0")/scratch.sh"
mkdir bin results && ln -s "$stance" bin/stance && ln -s "$shipped" scenarios
"$python" "$tests/told.py" "$tests/../analysis/questions.md"
