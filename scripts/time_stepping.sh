#!/bin/sh
# Compares the time integrators (bench/time_stepping.c, trade, shipped scenes), draws
# docs/results/time-stepping.svg and fills the tables of docs/results/time-stepping.md.
# `quick`: without trades and scenes, written to out/ instead of docs/.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox jq
scripts/build.sh
out=out/time_stepping
mkdir -p "$out"
hang=scenes/hanging_cloth.json
edge='bodies.sheet.constraints.pin.vertices={"box":{"minimum":[-0.3546,0,-1],"maximum":[-0.3526,9,1]}}'
build/bench/time_stepping order $hang 0.1 5 0.15625 "20 10 5 2.5 1.25" solver.tolerance=1e-6 >"$out/fall.md"
build/bench/time_stepping order $hang 0.6 30 0.3125 "20 10 5 2.5 1.25" solver.tolerance=1e-4 >"$out/hang.md"
build/bench/time_stepping order $hang 2 20 0.5 "8 4 2 1" solver.tolerance=1e-3 \
    "bodies.sheet.surface.rotate=[0,0,-45]" "$edge" >"$out/swing.md"
build/bench/time_stepping sloshing "8 4 2" >"$out/sloshing.md"
[ "${1:-}" != quick ] || { cat "$out"/*.md; exit 0; }

# A row for each scene: steps, ms of the processor a step, outer and linear iterations, unsolved steps, energy gained.
scenes="hanging_cloth flag slung_load twist cloth_on_sphere stacked_sheets dam_break paddle inlet balloon curtain hammock
    flag_in_stream soft_ball dragged_cloth cloth_on_mesh double_dam_break column water_on_cloth"
measure() { # SCENE INTEGRATOR
    dir=$out/$1-$2
    build/app/projdyn run "scenes/$1.json" --set "time_step.integrator=$2" --threads 1 --no-frames --quiet -o "$dir"
    ms=$(awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "ms_cpu") at = k } NR > 1 { s += $at } END { printf "%.2f", s / (NR - 1) }' "$dir/metrics.csv")
    jq -r --arg ms "$ms" '[.steps, $ms, (.outer_iterations.mean * 10 | round / 10), (.linear_iterations.mean | round),
        .unsolved_steps, ((.energy.end.total - .energy.start.total) * 1000 | round / 1000)] | join(" | ")' "$dir/report.json"
}
{
    echo "| scene | integrator | steps | ms a step | outer | linear | unsolved | energy gained, J |"
    echo "|---|---|---|---|---|---|---|---|"
    for scene in $scenes; do
        for integrator in euler bdf2; do
            echo "| $scene | $integrator | $(measure "$scene" $integrator) |"
        done
    done
} >"$out/scenes.md"

for scene in hanging_cloth curtain; do
    for integrator in euler bdf2; do
        build/app/projdyn trade "scenes/$scene.json" --set "time_step.integrator=$integrator" --minutes 3 --window 0.6 --quiet \
            -o "$out/trade-$scene-$integrator" >"$out/trade-$scene-$integrator.txt"
    done
done
gnuplot -e "out='$out'" scripts/time_stepping.gnuplot
scripts/fill_tables.sh "$out" docs/results/time-stepping.md docs/results/time-stepping.md
