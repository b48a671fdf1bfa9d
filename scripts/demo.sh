#!/bin/sh
# Water on a cloth, from a bare Debian 12 to a page that shows it: installs, builds, runs, packs.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh
build/app/projdyn run scenes/water_on_cloth.json -o out/water_on_cloth
build/app/projdyn replay out/water_on_cloth -o out/water_on_cloth/replay.html
echo
echo "Open out/water_on_cloth/replay.html in Firefox or Chromium."
echo "The frames (*.vtk.series, for ParaView, PyVista, Blender, splashsurf), metrics.csv and report.json lie beside it."
