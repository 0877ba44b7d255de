#!/usr/bin/env bash
# Mechanisms against an independent program: inertia, energy, contacts, equilibria, linearisations.
# Speaks TAP.
# about: runner/scenario
set -u
cd "$(dirname "$0")/.."
exec "${PYTHON:-/usr/bin/python3}" tests/mechanism_oracle.py "${BUILD:-build}/tests/mechanism_numbers"
