#!/bin/sh
# Mean step residual over the step length h and the weight w, for fluid, cloth and both, with the
# projective and the newton step. Writes bench/stability.csv and draws docs/results/stability.svg.
# Takes some minutes.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gnuplot-nox
scripts/build.sh
out=out/stability
rm -rf "$out" # sweep keeps runs that are there
mkdir -p "$out"
csv=$out/stability.csv
echo "scene,step,h,w,status,residual,kinetic_J,linear" >"$csv"
map() { # NAME SCENE PATH OF THE WEIGHT, OPTIONS...
    name=$1 scene=$2 path=$3
    shift 3
    for h in 1e-4 1e-3 1e-2 1e-1 1; do
        end=$(awk -v h=$h 'BEGIN { print 20 * h }')
        build/app/projdyn sweep "$scene" --quiet -o "$out/$name-$h" --set time_step.integrator=euler --set solver.type=auto --set solver.tolerance=0.1 \
            --set solver.outer_iterations=20 --set solver.linear_tolerance=0.1 --set solver.step=projective,newton \
            "$@" --set "$path=1,1e2,1e4,1e6,1e8,1e10,1e12" --set duration="$end" --set frame_interval="$end" \
            --set time_step="{\"fixed\": $h}" || true
        # sweep.csv: the settings as given, with "" where they have quotes; then columns by name
        /usr/bin/python3 - "$name" "$h" "$path" "$out/$name-$h/sweep.csv" >>"$csv" <<'PYTHON'
import csv, sys
name, h, path, file = sys.argv[1:]
for row in csv.DictReader(open(file)):
    print(name, row["solver.step"], h, row[path], row["status"], row["mean_step_residual"], row["max_kinetic_J"],
          row["mean_linear_iterations"], sep=",")
PYTHON
    done
}
map fluid scenes/dam_break.json bodies.water.constraints.fluid.stiffness --set bodies.water.particles.radius=0.05 \
    --set bodies.water.constraints.fluid='{"type": "fluid", "viscosity": 0.02}' # without its compression
map cloth scenes/hanging_cloth.json bodies.sheet.constraints.spring.stretching_stiffness \
    --set bodies.sheet.surface.grid.vertices='[9, 9]' --set bodies.sheet.constraints.pin.vertices.vertices='[0, 8]'
map coupled tests/pour.json bodies.water.constraints.fluid.stiffness --set bodies.water.particles.radius=0.05 \
    --set bodies.sheet.surface.grid.vertices='[9, 9]'
cp "$csv" bench/stability.csv
gnuplot scripts/stability_map.gnuplot
