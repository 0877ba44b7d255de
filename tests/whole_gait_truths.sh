#!/usr/bin/env bash
# What is known of gaits from outside: compasses, wheels, published walkers, zero dynamics (gait_truths.py).
# about: analysis/gait runner/run
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/gait_truths.py" "$stance" "$shipped"
