#!/usr/bin/env bash
# What the page scenarios/paper.md says of the paper's claims: every command on it runs, and numbers that it
# gives are what they print.
. "$(dirname "$0")/scratch.sh"
page=$shipped/paper.md
lines=0
ln -s "$shipped" scenarios && ln -s "$stance" stance

numbers() { # what the command of a row prints, and what its results file holds
    local file=one.h5
    if [[ $1 == *" run "* ]]; then
        eval "${1/#stance/./stance} -o $file --force" && ./stance summary $file && ./stance table $file
    else
        eval "${1/#stance/./stance}"
    fi
}
# The commands, once each.
grep '^|.*| `stance [^`]*` |$' "$page" | sed 's/.*| `\(stance [^`]*\)` |$/\1/' | sort -u >commands
is "the page has commands" [ "$(wc -l <commands)" -ge 18 ]
while read -r command; do
    lines=$((lines + 1))
    timeout "$patience" bash -c "$(declare -f numbers); numbers \"\$1\"" - "$command" >"said.$lines" 2>log </dev/null
    result $? "$command"
done <commands
cat said.* >all
: >log
# The page gives what is printed there: a number of the page, and what stands beside it in the output.
while IFS='|' read -r given printed; do
    is "the page's $given" 'grep -qF -- "$given" "$page" && grep -qE -- "$printed" all'
done <<'END'
0.570127|q1 +0\.570127 rad
(-7.531, 3.766)|hip1 +-7\.531349
105.948|force +105\.948000
±5.616, ±3.601, ±4.320|eigenvalues +-5\.61615, -3\.60115, -4\.32043i
rank 6|rank 6 of 6
1.16 s|stabilised,simulated,none,[0-9.]+,1\.16
8.49 N m|peak_torque +8\.485
4.5 evaluations|4\.501 evaluations per step
0.765 s|fell,simulated,none,0\.765
1.010 s|fell,simulated,none,1\.01,
seven of the ten|[*] x-theta .*on a surface of postures
1.03 iterations|flight +implicit .* 1\.0[23] 
1 coordinate is left|^  A +trunk +vtrunk$
1.05708|z 1\.05708
0.278 m in 0.668 s|step length +0\.2779
END
