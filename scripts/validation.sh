#!/bin/sh
# Measures the fluid against an experiment and exact solutions (bench/validation.c), draws
# docs/results/validation.svg and fills the tables of docs/results/validation.md.
# `quick`: small sizes, written to out/validation instead of docs/.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox python3-numpy
scripts/build.sh
out=out/validation
rm -rf "$out"
mkdir -p "$out"
case ${1:-} in
quick) cells="8 12" deep=16x8 wide="16x8" rest=2 along=20 swing=3 python=quick docs=$out ;;
"") cells="8 16 32" deep=40x24 wide="24x8 24x16 24x32" rest=2 along=32 swing=6 python='' docs=docs/results ;;
*) echo "usage: scripts/validation.sh [quick]" >&2; exit 2 ;;
esac
# shellcheck disable=SC2086
{
    build/bench/validation martin_moyce "$out" $cells >"$out/martin_moyce.md"
    build/bench/validation tank "$out" "$rest" "$deep" >"$out/tank.md"
    build/bench/validation tank "$out" 3 $wide >"$out/width.md"
    build/bench/validation sloshing "$out" "$swing" "$along" >"$out/sloshing.md"
    for script in flows vortex; do
        PYTHONPATH=python PROJDYN_LIBRARY=build/src/libprojdyn.so.0 /usr/bin/python3 -B scripts/$script.py $python >"$out/$script.md"
    done
}
gnuplot -e "target='$docs/validation.svg'; deep='$deep'" scripts/validation.gnuplot
scripts/fill_tables.sh "$out" docs/results/validation.md "$docs/validation.md"
