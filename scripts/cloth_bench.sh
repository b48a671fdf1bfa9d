#!/bin/sh
# Measures speed and error of a sheet (bench/cloth.c) and writes out/cloth.csv, and bench/cloth.csv when all runs ended
# well. `quick`: small sizes, printed only.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
run() { OMP_NUM_THREADS=1 build/bench/cloth "$@"; }
measure() {
    run
    for n in 33 65 129 257; do
        for stiffness in 400 4000 40000; do run $n $stiffness; done
    done
    run run 65 400 10 1
    run run 65 400 7 3
    run run 65 400 6 20
}
case ${1:-} in
quick) run; run 33 400; run 33 4000; run run 33 400 5 2 ;;
"")
    mkdir -p out
    measure >out/cloth.csv
    cp out/cloth.csv bench/cloth.csv
    ;;
*) echo "usage: scripts/cloth_bench.sh [quick]" >&2; exit 2 ;;
esac
