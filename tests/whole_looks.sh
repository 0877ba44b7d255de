#!/usr/bin/env bash
# Pictures come out as their options say: see looks.py. Speaks TAP.
# about: analysis/plot
set -u
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/looks.py" "$stance" "$shipped"
