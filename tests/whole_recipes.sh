#!/usr/bin/env bash
# The recipes of an image and of Spack name what the program is built of: see recipes.py.
. "$(dirname "$0")/scratch.sh"
"$python" "$tests/recipes.py"
