#!/bin/sh
# Makes the static library that is installed, from the internal one. All objects become one, in which
# symbols are local unless they are visible and named pdyn_*: a program that links it sees the functions
# marked PDYN_API alone, as with the shared library. Arguments: ld, objcopy, ar, the internal library, the output.
set -eu
ld=$1 objcopy=$2 ar=$3 internal=$4 output=$5
"$ld" -r -o "$output.o" --whole-archive "$internal"
"$objcopy" --localize-hidden --wildcard --keep-global-symbol='pdyn_*' "$output.o"
rm -f "$output"
"$ar" rcsD "$output" "$output.o"
rm "$output.o"
