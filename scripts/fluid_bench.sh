#!/bin/sh
# Measures speed and error of the fluid (bench/fluid.c) and writes out/fluid.csv. `quick`: small sizes, printed only.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
run() { build/bench/fluid "$@"; }
measure() {
    run
    for setting in fast accurate cfl; do
        seconds=0.3
        [ $setting = cfl ] && seconds=1
        for threads in 1 2; do run 29 $threads $setting $seconds; done
        run 29 2 ${setting}_solved $seconds
    done
    run 17 1 fast 0.3
    run 46 1 fast 0.3
    run 46 2 fast 0.3
    run 100 1 fast 0.03
    run 100 2 fast 0.03
    run 29 1 fast 0.1 # what 100 cells do for as many steps
}
case ${1:-} in
quick) run; run 17 1 fast 0.1; run 17 2 accurate 0.1; run 17 2 cfl 0.1 ;;
"")
    mkdir -p out
    measure >out/fluid.csv
    ;;
*) echo "usage: scripts/fluid_bench.sh [quick]" >&2; exit 2 ;;
esac
