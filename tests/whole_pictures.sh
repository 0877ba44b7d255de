#!/usr/bin/env bash
# Pictures of every kind show what the results files hold: see pictures.py.
# about: analysis/plot
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/pictures.py" "$stance" "$shipped"
