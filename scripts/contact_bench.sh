#!/bin/sh
# Runs the contact scenes for ten seconds and the falling sheet at two sizes, and bodies with friction
# (scripts/friction.py); writes bench/contact.csv and the tables of docs/results/contact.md. Takes
# some minutes.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
scripts/install.sh python3-numpy
out=out/contact
csv=bench/contact.csv
mkdir -p "$out"
echo "run,vertices,steps,frames,intersections,elements,outer_iterations,residual_mean,residual_max,ms_contact,ms_rest,moved_mm" >"$csv"
measure() {
    name=$1
    shift
    echo "$name,$(build/bench/contact "$@" time_step.integrator=euler)" >>"$csv"
}
measure "cloth_on_sphere 10 s" scenes/cloth_on_sphere.json duration=10
measure "cloth_on_mesh 10 s" scenes/cloth_on_mesh.json duration=10
measure "stacked_sheets 10 s" scenes/stacked_sheets.json duration=10
measure "on its edge and folding 13 s" scenes/cloth_on_sphere.json duration=13 contact.friction=0.5 \
    bodies.sheet.surface.grid='{"size": [0.6, 0.6], "vertices": [33, 33]}' \
    bodies.sheet.surface.rotate='[88, 0, 20]' bodies.sheet.surface.translate='[1, 0.1, 0]'
measure "cloth_on_sphere 33^2 0.6 s" scenes/cloth_on_sphere.json duration=0.6 \
    bodies.sheet.surface.grid.vertices='[33, 33]'
measure "cloth_on_sphere 65^2 0.4 s" scenes/cloth_on_sphere.json duration=0.4 \
    bodies.sheet.surface.grid.vertices='[65, 65]'
measure "50 m/s 33^2 0.12 s" scenes/cloth_on_sphere.json duration=0.12 \
    bodies.sheet.velocity='[0, -50, 0]' bodies.sheet.surface.translate='[0.02, 0.8, 0.01]' \
    bodies.sheet.surface.grid.vertices='[33, 33]'
awk -F, -f scripts/contact_table.awk "$csv" >"$out/table.md"
for table in incline landing; do
    PYTHONPATH=python PROJDYN_LIBRARY=build/src/libprojdyn.so.0 /usr/bin/python3 -B scripts/friction.py $table >"$out/$table.md"
done
scripts/fill_tables.sh "$out" docs/results/contact.md docs/results/contact.md
