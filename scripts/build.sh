#!/bin/sh
# Installs what a build needs and builds into build/. Arguments: options of meson for a new build/.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev meson ninja-build pkg-config libsuitesparse-dev libjansson-dev \
    libcmocka-dev zlib1g-dev libwebsockets-dev
[ -f build/build.ninja ] || meson setup build "$@" >/dev/null
ninja -C build
