#!/usr/bin/env bash
# Copies what stage.sh made below ROOT, and removes it again: what was put there, files and the folders that
# were not there before, stands in ROOT/share/stance/installed.
# Usage: put.sh install STAGE ROOT | put.sh uninstall ROOT
set -eu
list=share/stance/installed
if [ "$1" = install ]; then
    stage=$2 root=$3 record=$(mktemp)
    up=0
    trap 'rm -f "$record"' EXIT
    for (( ; ; up++)); do # how many folders above are to be made, too
        above=$root
        for ((k = 0; k < up; k++)); do above=$(dirname "$above"); done
        [ -d "$above" ] && break
    done
    {
        [ -e "$root/$list" ] && grep '/$' "$root/$list"
        for ((k = 0; k < up; k++)); do echo ./; done
        (cd "$stage" && find . -mindepth 1 -type d -printf '%P/\n') | while read -r f; do [ -d "$root/$f" ] || echo "$f"; done
        (cd "$stage" && find . -type f -printf '%P\n')
        echo "$list"
    } >"$record"
    (cd "$stage" && find . -type f -printf '%m %P\n') | while read -r mode f; do install -D -m "$mode" "$stage/$f" "$root/$f"; done
    install -D -m 644 "$record" "$root/$list"
else
    root=$2
    [ -e "$root/$list" ] || { echo "nothing is installed in $root" >&2 && exit 1; }
    record=$(cat "$root/$list")
    grep -v '/$' <<<"$record" | while read -r f; do
        rm -f "$root/$f"
        case $f in *.py) rm -rf "$root/$(dirname "$f")/__pycache__" ;; esac # what Python made of it
    done
    # The deepest first; what holds something else stays.
    grep '/$' <<<"$record" | grep -vx './' | sort -ru | while read -r f; do rmdir --ignore-fail-on-non-empty "$root/$f" 2>/dev/null || true; done
    for ((above = $(grep -cx './' <<<"$record"); above > 0; above--)); do
        rmdir --ignore-fail-on-non-empty "$root" 2>/dev/null || break
        root=$(dirname "$root")
    done
fi
