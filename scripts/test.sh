#!/bin/sh
# Installs what the tests need, builds, and runs all of them.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh g++ python3-numpy python3-matplotlib doxygen parallel chromium ffmpeg python3-vtk9 python3-meshio
scripts/build.sh
meson test -C build --print-errorlogs
