#!/bin/sh
# Measures the convergence of one step (bench/convergence.c) and draws docs/results/convergence.svg.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox
scripts/build.sh
mkdir -p out
measure() { # scene, seconds before the step, projective iterations, overrides
    name=$1 && shift
    build/bench/convergence "scenes/$name.json" "$@" time_step.integrator=euler >"out/$name.csv"
}
measure hanging_cloth 0.2 3000 solver.type=cg
measure dam_break 0.1 400
measure column 0.3 400
gnuplot scripts/convergence.gnuplot
