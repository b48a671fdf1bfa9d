#!/bin/sh
# Builds the Python wheel into a folder (default dist), installs it into an empty environment, and runs a
# scene and an example from there, away from the source tree. Needs no network once the packages are there.
# Arguments after the folder are options of pip wheel.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev ninja-build pkg-config libsuitesparse-dev libjansson-dev zlib1g-dev \
    patchelf python3-mesonpy python3-numpy python3-pip python3-venv python3-wheel
out=$(realpath -m "${1:-dist}")
[ $# = 0 ] || shift
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
unset PYTHONPATH PROJDYN_LIBRARY PROJDYN_PROGRAM
export TMPDIR="$dir" # of its own: meson asks Python with a script there, which imports what lies beside it

echo "== build"
/usr/bin/python3 -m pip wheel --quiet --no-build-isolation --no-deps --no-index --wheel-dir "$dir/wheel" "$@" .
mkdir -p "$out"
mv "$dir"/wheel/projdyn-*.whl "$out"
wheel=$(ls -t "$out"/projdyn-*.whl | head -n 1)
/usr/bin/python3 -m zipfile --list "$wheel" | awk 'NR > 1 { print $1 }'

echo "== install"
/usr/bin/python3 -m venv --system-site-packages "$dir/venv"
"$dir/venv/bin/pip" install --quiet --no-index --no-deps "$wheel"
cp scenes/hanging_cloth.json python/examples/scene_from_arrays.py "$dir"
cd "$dir"

echo "== run"
venv/bin/python3 -m projdyn run hanging_cloth.json --time 0.1 --quiet -o run
[ -s run/report.json ]
venv/bin/python3 scene_from_arrays.py 3
venv/bin/python3 -c 'import projdyn; print(projdyn.__file__, projdyn.version())'
echo "the wheel is $wheel"
