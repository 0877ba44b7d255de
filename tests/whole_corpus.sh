#!/usr/bin/env bash
# What becomes of every shipped scenario: corpus.txt. Speaks TAP.
set -u
# shellcheck source=tests/scratch.sh
. "$(dirname "$0")/scratch.sh"
export STANCE_CACHE=$scratch/cache
"$python" "$tests/corpus.py" "$stance"
