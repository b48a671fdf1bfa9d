#!/bin/sh
# A pool in a cloth, from a bare Debian 12 or 13 to a page that shows it: installs, builds, runs, packs.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
build/app/projdyn run scenes/pool_in_cloth.json -o out/pool_in_cloth
build/app/projdyn replay out/pool_in_cloth -o out/pool_in_cloth/replay.html
echo
echo "Open out/pool_in_cloth/replay.html in Firefox or Chromium."
echo "The frames (*.vtk.series, for ParaView, PyVista, Blender, splashsurf), metrics.csv and report.json lie beside it."
echo "Next, with 20,000 particles (ten minutes): build/app/projdyn run scenes/water_on_cloth.json"
