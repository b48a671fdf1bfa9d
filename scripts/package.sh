#!/bin/sh
# Builds the library alone (no app, tests, bench, examples), installs it into an empty prefix, and builds
# and runs tests/package from there with CMake and with pkg-config, each shared and static. Checks that
# both libraries export the same symbols, all with the prefix pdyn_.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev meson ninja-build pkg-config libsuitesparse-dev libjansson-dev cmake
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

echo "== library alone"
meson setup "$dir/build" --prefix=/usr/local -Dwerror=true -Dapp=false -Dtests=false -Dbench=false -Dexamples=false >"$dir/said"
! grep -E 'zlib|cmocka' "$dir/said" || { echo "the library needs CHOLMOD and jansson only" >&2; exit 1; }
ninja -C "$dir/build" >/dev/null
meson install -C "$dir/build" --no-rebuild --quiet --destdir "$dir/installed"
prefix=$dir/prefix # a moved prefix: nothing may depend on the one of the configuration
mv "$dir/installed/usr/local" "$prefix"
pc=$(find "$prefix" -name projdyn.pc)
library=$(dirname "$(dirname "$pc")")
find "$prefix" ! -type d | sed "s|$prefix/||" | LC_ALL=C sort

echo "== symbols"
nm -D --defined-only "$library/libprojdyn.so" | awk '{ print $3 }' | LC_ALL=C sort >"$dir/shared"
nm -g --defined-only "$library/libprojdyn.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$dir/static"
! grep -v '^pdyn_' "$dir/shared" "$dir/static" || { echo "not pdyn_*" >&2; exit 1; }
diff "$dir/shared" "$dir/static"
echo "$(wc -l <"$dir/static") symbols, all pdyn_*, the same in both libraries"

# links PROGRAM: shared or static, by what the dynamic loader would look for
links() { if readelf -d "$1" | grep -q 'NEEDED.*libprojdyn'; then echo shared; else echo static; fi; }

build_with_cmake() { # KIND CMAKE-OPTIONS...
    kind=$1
    shift
    cmake -S tests/package -B "$dir/cmake-$kind" -DCMAKE_PREFIX_PATH="$prefix" "$@" >"$dir/said" || { cat "$dir/said"; exit 1; }
    cmake --build "$dir/cmake-$kind" >"$dir/said" || { cat "$dir/said"; exit 1; }
    [ "$(links "$dir/cmake-$kind/package")" = "$kind" ]
    "$dir/cmake-$kind/package"
    echo "$kind: ran"
}
echo "== cmake"
build_with_cmake shared
build_with_cmake static -Dprojdyn_USE_STATIC_LIBS=ON
for version in 0.0 0.99 1.0; do
    cmake -S tests/package -B "$dir/cmake-$version" -DCMAKE_PREFIX_PATH="$prefix" -DWANTED=$version >"$dir/said" 2>&1 || true
    grep -q 'compatible with requested' "$dir/said" || { echo "version $version is not refused:" && cat "$dir/said" && exit 1; }
done

build_with_pkg_config() { # KIND PKG-CONFIG-OPTIONS...
    kind=$1
    shift
    # shellcheck disable=SC2046
    ${CC:-cc} -o "$dir/package-$kind" tests/package/package.c $(PKG_CONFIG_PATH="$(dirname "$pc")" pkg-config \
        --define-variable=prefix="$prefix" "$@" --cflags --libs projdyn)
    [ "$(links "$dir/package-$kind")" = "$kind" ]
    LD_LIBRARY_PATH="$library" "$dir/package-$kind"
    echo "$kind: ran"
}
echo "== pkg-config"
build_with_pkg_config shared
rm "$library"/libprojdyn.so* # the linker takes the static library where there is no shared one
build_with_pkg_config static --static
