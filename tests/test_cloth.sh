#!/bin/sh
# Validations of cloth on small meshes: test_cloth.sh VALIDATION. Deviations from exact solutions and moduli in the
# tables have to stay within bounds, in per cent.
set -eu
validation=$1
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
failed=0

# expect NAME LOWEST HIGHEST: checks numbers on standard input, one per line, at least one
expect() {
    awk -v name="$1" -v low="$2" -v high="$3" '
        { count++; if (!($1 >= low && $1 <= high)) { print name ": " $1 ", expected " low " to " high; bad = 1 } }
        END { if (!count) { print name ": nothing measured"; bad = 1 } exit bad }' || failed=1
}
deviations() { grep -o '[-+][0-9.]* %' | tr -d '% '; }

"$validation" elastica "$directory" 25 >"$directory/elastica"
grep -E '^\| (0.1|1|10|100) ' "$directory/elastica" | deviations | expect elastica -1 1
"$validation" catenary "$directory" 50 | deviations | expect catenary -1 1
"$validation" chain "$directory" 25 5 | grep '^| [12] ' | deviations | expect chain -1 1
"$validation" stretch "$directory" 20 >"$directory/stretch"
awk -F'|' '/triangle/ { print $5 + 0 }' "$directory/stretch" | expect "modulus of triangles" 0.995 1.005
awk -F'|' '/spring . regular/ { print $5 + 0 }' "$directory/stretch" | expect "modulus of springs" 0.95 1.05
exit $failed
