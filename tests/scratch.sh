# shellcheck shell=bash disable=SC2034
# Where tests of the whole program work, sourced first by them: a scratch folder of their own, with
# `disk` in it for a file system to be mounted, the program (bin/stance, or what STANCE names; a slow
# one with STANCE_SLOW), the settings that mpirun wants of root, the commands of outside.sh, and TAP's last line.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
tests=$PWD/tests shipped=$PWD/scenarios python=${PYTHON:-/usr/bin/python3}
export STANCE=${STANCE:-$PWD/bin/stance}
stance=$STANCE
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export PMIX_MCA_gds=hash OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_rmaps_base_oversubscribe=1
count=0

scratch=$(mktemp -d)
disk=$scratch/disk
trap 'umount "$disk" 2>/dev/null; rm -rf "$scratch"; ((count == 0)) || echo "1..$count"; ((failed == 0)) || exit 1' EXIT
cd "$scratch" && mkdir "$disk" || exit 1
# shellcheck source=tests/outside.sh
. "$tests/outside.sh"
skip() { echo "ok $((++count)) - $1 # SKIP $2"; }
