# shellcheck shell=bash disable=SC2034
# Where tests of the whole program work, sourced first by them: a scratch folder of their own, with
# `disk` in it for a file system to be mounted, the program (bin/stance, or what STANCE names; a slow
# one with STANCE_SLOW), the settings that mpirun wants of root, and the commands of outside.sh.
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
tests=$PWD/tests shipped=$PWD/scenarios python=${PYTHON:-/usr/bin/python3}
export STANCE=${STANCE:-$PWD/bin/stance}
stance=$STANCE
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1
count=0 patience=60 # seconds that a command may take
[ -n "${STANCE_SLOW:-}" ] && patience=300

scratch=$(mktemp -d)
disk=$scratch/disk
trap 'umount "$disk" 2>/dev/null; rm -rf "$scratch"' EXIT
cd "$scratch" && mkdir "$disk" || exit 1
# shellcheck source=tests/outside.sh
. "$tests/outside.sh"
skip() { echo "ok $((++count)) - $1 # SKIP $2"; }

# A robot on one foot, sampled every 10 ms: what most scenarios of the tests begin with.
balance() {
    cat <<'END'
stance: 1
scene: biped
ground: {friction: 0.8, contacts: [foot1]}
initial: {equilibrium: {theta: -0.41, q2: 0.82}, support_foot: 1}
controller: {kind: state-feedback, design: place, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6],
             sample_time: 0.01, torque_limit: 10}
method: {name: implicit, step: 0.01}
END
}
