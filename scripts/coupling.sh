#!/bin/sh
# Measures the coupling of fluid and cloth (bench/coupling.c), draws docs/results/coupling.svg and
# fills the tables of docs/results/coupling.md.
# `quick`: small sizes, written to out/coupling instead of docs/.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox
scripts/build.sh
out=out/coupling
mkdir -p "$out"
case ${1:-} in
quick)
    steps=100 seconds=2 basin=20 sheet=20 gate="10x12x2:bdf2 10x7.8x2:bdf2" docs=$out
    leaks="impact:12:25:10:0.03:6x30:20 bag:12:8:10:0.05:20x300:2" ;;
"")
    steps=1000 seconds=10 basin="20 12.5" sheet="20 12.5" docs=docs/results
    gate="10x12x2 10x7.8x2 5x12x1 5x7.8x1 10x12x2:bdf2 10x7.8x2:bdf2 5x12x1:bdf2 5x7.8x1:bdf2"
    leaks="impact:22:50:10:0.05:6x30:20 impact:22:50:1:0.03:6x30:20 impact:46:50:10:0.05:6x30:20 impact:46:200:10:0.05:6x30:20"
    leaks="$leaks impact:46:50:10:0.05:6x30:5 bag:12:8:10:0.4:20x300:0.5 bag:12:8:10:0.4:20x300:2 bag:12:8:1:0.03:20x300:2" ;;
*) echo "usage: scripts/coupling.sh [quick]" >&2; exit 2 ;;
esac
# shellcheck disable=SC2086
{
    export OMP_NUM_THREADS=1 # of a BLAS with threads: times are those of all threads
    build/bench/coupling momentum "$out" "$steps" 0.2 >"$out/momentum.md"
    build/bench/coupling basin "$out" "$seconds" $basin >"$out/basin.md"
    build/bench/coupling lintearia "$out" 2 $sheet >"$out/lintearia.md"
    build/bench/coupling gate "$out" $gate >"$out/gate.md"
    build/bench/coupling leaks "$out" $leaks >"$out/leaks.md"
}
gnuplot -e "target='$docs/coupling.svg'; out='$out'" scripts/coupling.gnuplot
scripts/fill_tables.sh "$out" docs/results/coupling.md "$docs/coupling.md"
