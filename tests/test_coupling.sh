#!/bin/sh
# Validations of coupled fluid and cloth on small scenes: test_coupling.sh COUPLING.
set -eu
coupling=$1
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
failed=0

# expect NAME LOWEST HIGHEST: checks numbers on standard input, one per line, at least one
expect() {
    awk -v name="$1" -v low="$2" -v high="$3" '
        { count++; if (!($1 >= low && $1 <= high)) { print name ": " $1 ", expected " low " to " high; bad = 1 } }
        END { if (!count) { print name ": nothing measured"; bad = 1 } exit bad }' || failed=1
}

"$coupling" basin "$directory" 1.5 20 >"$directory/basin"
grep '^| 20 ' "$directory/basin" | awk -F'|' '{ print $6 + 0 }' | expect "pins over weight" 0.995 1.005
grep '^| 20 ' "$directory/basin" | awk -F'|' '{ print $8 + 0 }' | expect "unevenness, spacings" 0 1
"$coupling" lintearia "$directory" 0.4 20 >"$directory/lintearia"
grep '^| 0' "$directory/lintearia" | awk -F'|' '{ print $9 + 0 }' | expect "lintearia, RMS" 0 2
"$coupling" gate "$directory" 10x12x2 >"$directory/gate"
grep '^| 10 ' "$directory/gate" | grep -o '[-+][0-9]* %' | tr -d '%' | expect "peak of the gate" -15 15
"$coupling" leaks "$directory" impact:10:17:10:0.03:6x30:20 bag:10:6:10:0.05:20x300:2 >"$directory/leaks"
grep -E '^\| (impact|bag)' "$directory/leaks" | awk -F'|' '{ print $9 + 0 }' | expect "on the wrong side" 0 0
exit $failed
