#!/bin/sh
# Measures the interface between water and surfaces (bench/interface.c) in some 60 minutes: one
# markdown table for each command, in out/interface; fills the tables of docs/results/interface.md.
# `quick`: small sizes in five minutes, written to out/interface instead of docs/. Further arguments
# go to every command (--set PATH=VALUE, --threads N); with these, docs/ is not written either.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
out=out/interface
mkdir -p "$out"
full=
case ${1:-} in
quick)
    shift
    displaced="1.2 12 0 level:20:1 tilted:20:1" thick="1 12 3 level:20:1" tank="1 16x40"
    floating="1 25 8 slab:500 cube:900 cube:2000" free="0.2 8 0 between:20:0.2 between:20:12"
    neutral="0.5 8 3 settled:20:3" stream="30 0 2" added_mass="0 strip:25" bag="0.5 12.5 1.1 8"
    dropped="1 20 8 3 0.3 0 0.3 0.03" plate="2 50" ;;
"" | --*)
    full=yes
    displaced="1.2 16 0 level:30:1 level:20:1 level:12.5:1 tilted:30:1 tilted:20:1 tilted:12.5:1 curved:30:1 curved:20:1"
    displaced="$displaced curved:12.5:1 level:20:0.5 level:20:2 level:20:4"
    thick="1.2 16 3 level:30:1 level:20:1 level:12.5:1" tank="1 24x80"
    floating="3 25 12 slab:250 slab:500 cube:900 ball:500 ball:900 cube:2000"
    free="1 12 0 between:20:0.05 between:20:0.2 between:20:1 between:20:12 cavity:20:0.2 cavity:20:1 cavity:20:12"
    neutral="2 12 3 settled:20:3 between:20:3" stream="20 0 0.5 1 2" added_mass="0 strip:25 strip:12.5"
    added_mass="$added_mass strip:8.33333 strip:6.25 disc:30 disc:15"
    bag="1 12.5 1.1 6 8" dropped="2 20 12 3 0.3 0 0.3 0.03" plate="2 50" ;;
*) echo "usage: scripts/interface.sh [quick] [--set PATH=VALUE]... [--threads N]" >&2; exit 2 ;;
esac
measure() { # NAME COMMAND ARGUMENTS
    name=$1 command=$2 arguments=$3
    shift 3
    # shellcheck disable=SC2086
    build/bench/interface "$command" "$out" $arguments "$@" >"$out/$name.md"
    echo "$name" && cat "$out/$name.md"
}
measure displaced displaced "$displaced" "$@"
measure displaced_contact displaced "$thick" "$@"
measure tank tank "$tank" "$@"
measure floating floating "$floating" "$@"
measure free free "$free" "$@"
measure neutral free "$neutral" "$@"
measure stream stream "$stream" "$@"
measure added_mass added_mass "$added_mass" "$@"
measure bag bag "$bag" "$@"
measure dropped dropped "$dropped" "$@"
measure plate plate "$plate" "$@"
docs=$out
if [ "$full" ]; then # the same with boundary particles
    [ $# -gt 0 ] || docs=docs/results
    set -- --set 'boundary="points"' "$@"
    measure points_displaced displaced "1.2 12 0 level:20:1 tilted:20:1" "$@"
    measure points_tank tank "1 16x40" "$@"
    measure points_floating floating "2 25 8 slab:500 cube:900 cube:2000" "$@"
    measure points_added_mass added_mass "0 strip:25" "$@"
    measure points_bag bag "1 12.5 1.1 8" "$@"
fi
scripts/fill_tables.sh "$out" docs/results/interface.md "$docs/interface.md"
