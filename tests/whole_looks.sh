#!/usr/bin/env bash
# Pictures come out as their options say: see looks.py.
# about: analysis/plot
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/looks.py" "$stance" "$shipped"
