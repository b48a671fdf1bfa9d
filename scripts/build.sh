#!/bin/sh
# Installs what a build needs and builds into build/. Arguments: options of meson, such as
# --prefix=DIR or -Dcholmod=disabled; a build/ that exists takes them, too.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev meson ninja-build pkg-config libsuitesparse-dev libjansson-dev \
    libcmocka-dev zlib1g-dev libwebsockets-dev
if [ ! -f build/build.ninja ]; then
    meson setup build "$@" >/dev/null
elif [ $# -gt 0 ]; then
    meson configure build "$@"
fi
ninja -C build
