#!/usr/bin/env bash
# Where pages go, and from what they are made: nothing else is written over.
# about: analysis/view
. "$(dirname "$0")/scratch.sh"
"$stance" run "$shipped/basin_one_foot.yaml" --set 'sweep.grid[0].count=3' --set 'sweep.grid[1].count=3' -o map.h5 >/dev/null 2>&1
"$stance" view map.h5 2>/dev/null >log || { skip "pages" "the program was built without the page: make web"; exit 0; }
mkdir a b
cp map.h5 a/same.h5 && cp map.h5 b/same.h5 && cp map.h5 index.h5 && cp map.h5 'a#b?%41 c.h5' && cp map.h5 $'no\xff.h5'
expect "two pages of one name" 2 "$stance" view a/same.h5 b/same.h5 -o pages \
    says "a/same.h5: its page would be written over that of b/same.h5, pages/same.html"
expect "a page of the index's name" 2 "$stance" view map.h5 index.h5 -o pages
cp map.h5 own.html
expect "a page over its file" 2 "$stance" view own.html -o own.html
expect "... which stays" 0 cmp map.h5 own.html
expect "names that are no addresses" 0 "$stance" view map.h5 'a#b?%41 c.h5' $'no\xff.h5' -o pages
expect "... in the index" 0 grep -q 'href="a%23b%3F%2541%20c.html"' pages/index.html
expect "a name that is not UTF-8" 0 "$python" -c '
import json, re, sys
text = open(b"pages/no\xff.html", "rb").read()
sys.exit(json.loads(re.search(rb"id=.head.>(.*?)</script>", text)[1])["file"] != "no?")'
head -c 9000 map.h5 >cut.h5
expect "a file that is cut" 3 "$stance" view cut.h5
expect "... makes no page" 1 test -e cut.html -o -e cut.html.part
