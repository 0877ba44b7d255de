#!/usr/bin/env bash
# What takes too long for every change: each stage leaves a row in tests/verdicts (stage, day, revision, what it
# said last), which is committed. `--judge` refuses rows that say that something failed, and those that are more
# than seven days older than the change that it judges. Seven: in a week there are some hundred changes, of which
# the one that a stage objects to is found by seven runs of what failed; nobody runs the stages, which take a
# machine some hours, for each of them.
# Usage: tests/long.sh [STAGE]...  all of them, or some; tests/long.sh --judge
set -u
cd "$(dirname "$0")/.." || exit 1
stages="analyser tests kills sanitizers arm web"
case ${1:-} in
    --judge)
        bad=0 day=$(git log -1 --format=%cs)
        for stage in $stages; do
            row=$(grep "^$stage " tests/verdicts) || { echo "make test-long: $stage has not run"; bad=1; continue; }
            read -r _ ran _ <<<"$row"
            age=$((($(date -d "$day" +%s) - $(date -d "$ran" +%s)) / 86400))
            ((age <= 7)) || { echo "make test-long: $stage is $age days older than this change"; bad=1; }
            ! grep -q ' failed: ' <<<"$row" || { echo "make test-long: $row"; bad=1; }
        done
        exit $bad ;;
    "") ;;
    *) stages=$* ;;
esac
failed=0
for stage in $stages; do
    case $stage in
        analyser) STANCE_TEST_LONG=1 make -j"$(nproc)" lint ;;
        tests) make -j"$(nproc)" test-length ;;
        kills) make test-kills ;;
        sanitizers) make -j"$(nproc)" sanitize ;;
        arm) make test-neon ;;
        web) make test-web ;;
        *) echo "no such stage: $stage" >&2 && exit 2 ;;
    esac 2>&1 | tee build/long.log
    status=${PIPESTATUS[0]}
    said=$(grep -v '^make' build/long.log | tail -n 1)
    ((status == 0)) || { failed=1; said="failed: $said"; }
    row="$stage $(date +%F) $(git describe --always --dirty) $said"
    { grep -v "^$stage " tests/verdicts 2>/dev/null; echo "$row"; } | sort >build/verdicts && cp build/verdicts tests/verdicts
done
cat tests/verdicts
exit $failed
