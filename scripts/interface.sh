#!/bin/sh
# Measures the interface between water and what it touches (bench/interface.c): a table for each command, as markdown, in
# out/interface. `quick`: small sizes, for a look. Further arguments go to every command: --set PATH=VALUE, --threads N.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
out=out/interface
mkdir -p "$out"
case ${1:-} in
quick)
    shift
    displaced="1.2 12 0 level:20:1 tilted:20:1" thick="1 12 3 level:20:1" tank="1 16x40"
    floating="2 25 8 slab:500 cube:900 cube:2000" free="0.3 8 0 between:20:0.2 between:20:12"
    neutral="0.5 8 3 between:20:3" stream="30 0 1" added_mass="0 strip:25" bag="0.5 12.5 1.1 8"
    dropped="1 20 8 3 0.3" plate="2 50" ;;
"" | --*)
    displaced="1.2 16 0"
    for d in 30 20 12.5; do
        for shape in level tilted curved; do
            for edge in 0.5 1 2 4; do displaced="$displaced $shape:$d:$edge"; done
        done
    done
    thick="1.2 16 3 level:30:1 level:20:1 level:12.5:1" tank="1 24x80"
    floating="3 25 12 slab:250 slab:500 cube:900 ball:250 ball:500 ball:900 cube:2000"
    free="1 12 0 between:20:0.05 between:20:0.2 between:20:1 between:20:12 cavity:20:0.05 cavity:20:0.2 cavity:20:1 cavity:20:12"
    neutral="2 12 3 between:20:3 cavity:20:3" stream="20 0 0.5 1 2" added_mass="0 strip:25 strip:20 disc:30"
    bag="1 12.5 1.1 6 8 12" dropped="2 20 12 3 0.3" plate="3 50 25" ;;
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
