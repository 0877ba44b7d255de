#!/usr/bin/env bash
# What becomes of every shipped scenario: corpus.txt.
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache
"$python" "$tests/corpus.py" "$stance"
