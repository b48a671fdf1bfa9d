#!/bin/sh
# Measures cloth against exact solutions (bench/validation.c), draws
# docs/results/cloth_validation.svg and fills the tables of docs/results/cloth_validation.md.
# `quick`: small sizes, written to out/validation instead of docs/.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox
scripts/build.sh
out=out/validation
mkdir -p "$out"
case ${1:-} in
quick) strips="25 50" chain=25 segments=25 sheets="17 33" docs=$out ;;
"") strips="25 50 100 100x4" chain=100 segments="25 50" sheets="17 33 65 129" docs=docs/results ;;
*) echo "usage: scripts/cloth_validation.sh [quick]" >&2; exit 2 ;;
esac
# shellcheck disable=SC2086
{
    build/bench/validation elastica "$out" $strips >"$out/elastica.md"
    build/bench/validation catenary "$out" 50 100 >"$out/catenary.md"
    build/bench/validation chain "$out" "$chain" 1 5 20 >"$out/chain.md"
    build/bench/validation buckling "$out" $segments >"$out/buckling.md"
    build/bench/validation stretch "$out" 20 40 >"$out/stretch.md"
    build/bench/validation sheet "$out" $sheets >"$out/sheet.md"
}
gnuplot -e "target='$docs/cloth_validation.svg'; table='$out/elastica.csv'" scripts/cloth_validation.gnuplot
scripts/fill_tables.sh "$out" docs/results/cloth_validation.md "$docs/cloth_validation.md"
