#!/bin/sh
# Measures the convergence of one step (bench/convergence.c) and draws docs/results/convergence.svg.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox
scripts/build.sh
mkdir -p out
build/bench/convergence scenes/hanging_cloth.json 0.2 3000 >out/hanging_cloth.csv
build/bench/convergence scenes/dam_break.json 0.1 400 >out/dam_break.csv
build/bench/convergence scenes/column.json 0.3 400 >out/column.csv
gnuplot scripts/convergence.gnuplot
