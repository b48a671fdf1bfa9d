#!/bin/sh
# Installs the library of a build folder (default build) into an empty prefix, and builds and runs all
# of examples/, and an example of the Python package, from there: what someone without the source tree can do.
set -eu
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build}") root=$(pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
meson install -C "$build" --no-rebuild --quiet --destdir "$dir"
pc=$(find "$dir" -name projdyn.pc)
library=$(dirname "$(dirname "$pc")")
program=$(find "$dir" -type f -name projdyn -perm -u+x)
export PKG_CONFIG_SYSROOT_DIR="$dir" PKG_CONFIG_PATH="$(dirname "$pc")" LD_LIBRARY_PATH="$library"
flags=$(pkg-config --cflags projdyn) libs=$(pkg-config --cflags --libs projdyn)

echo "== symbols"
others=$(nm -D --defined-only "$library/libprojdyn.so" | awk '$3 !~ /^pdyn_/ { print $3 }')
[ -z "$others" ] || { echo "not pdyn_*: $others" >&2; exit 1; }
[ "$(readlink "$library/libprojdyn.so")" = libprojdyn.so.0 ]

cp -r examples "$dir/examples"
cd "$dir/examples"
# The last compiler is that of the plug-ins that run below.
for compiler in "clang -std=c17 -O0" "g++ -x c++ -std=c++20 -Wno-missing-field-initializers -O0" "gcc -std=c17 -O2"; do
    command -v "${compiler%% *}" >/dev/null || { echo "skipped: no $compiler"; continue; }
    echo "== $compiler"
    for header in $(find "$dir" -path '*/include/projdyn/*.h'); do
        echo "#include <projdyn/$(basename "$header")>" >header.c
        ${compiler%% *} -Wall -Wextra -Wpedantic -Werror ${compiler#* } -fsyntax-only $flags header.c
    done
    ${compiler%% *} -Wall -Wextra -Wpedantic -Werror ${compiler#* } -o cloth cloth.c $libs
    ./cloth | tail -n 1
    ${compiler%% *} -Wall -Wextra -Wpedantic -Werror ${compiler#* } -o memory memory.c $libs
    for source in plugin/*.c; do
        name=$(basename "$source" .c)
        ${compiler%% *} -Wall -Wextra -Wpedantic -Werror ${compiler#* } -shared -fPIC $flags -o "plugin/$name.so" "$source" -lm
        "$program" list --plugin "plugin/$name.so" >/dev/null
        echo "$name: built"
    done
done
./memory 1

echo "== scenes"
for scene in plugin/*.json; do
    name=$(basename "$scene" .json)
    "$program" run "$scene" --allow-plugins --time 0.04 --quiet -o "$dir/out"
    said=$("$program" check --conformance "plugin/$name.so") || { echo "$name: $said" >&2; exit 1; }
    echo "$name: ran; $said"
done

echo "== python"
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
    PYTHONPATH="$root/python" PROJDYN_LIBRARY="$library/libprojdyn.so.0" /usr/bin/python3 "$root/python/examples/drag_pin.py" | tail -n 1
else
    echo "skipped: no numpy"
fi
