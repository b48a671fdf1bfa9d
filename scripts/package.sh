#!/bin/sh
# Builds the library alone (no app, tests, bench, examples), installs it into an empty prefix, and builds
# and runs tests/package from there with CMake and with pkg-config, each shared and static, and with the source
# as a subproject of meson. Checks that both libraries export the same symbols, all with the prefix pdyn_. Then
# the same without CHOLMOD, with the program, which runs a scene.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev meson ninja-build pkg-config libsuitesparse-dev libjansson-dev zlib1g-dev cmake
dir=$(mktemp -d "$PWD/build-package-XXXXXX") # as deep as build: ccache takes its objects where the commands are the same
trap 'rm -rf "$dir" "$dir"-*' EXIT

# install NAME MESON-OPTIONS...: sets the prefix, its pkg-config file and its folder of libraries. The prefix is
# moved: nothing may depend on the one of the configuration.
install() {
    prefix=$dir/$1-prefix build=$dir-$1
    shift
    meson setup "$build" --prefix=/usr/local -Dwerror=true -Dtests=false -Dbench=false -Dexamples=false "$@" >"$dir/said"
    ninja -C "$build" >/dev/null
    meson install -C "$build" --no-rebuild --quiet --destdir "$dir/installed"
    mv "$dir/installed/usr/local" "$prefix"
    pc=$(find "$prefix" -name projdyn.pc)
    library=$(dirname "$(dirname "$pc")")
}

# links PROGRAM: shared or static, by what the dynamic loader would look for
links() { if readelf -d "$1" | grep -q 'NEEDED.*libprojdyn'; then echo shared; else echo static; fi; }

build_with_cmake() { # KIND CMAKE-OPTIONS...
    kind=$1
    shift
    rm -rf "$dir/cmake"
    cmake -S tests/package -B "$dir/cmake" -DCMAKE_PREFIX_PATH="$prefix" "$@" >"$dir/said" || { cat "$dir/said"; exit 1; }
    cmake --build "$dir/cmake" >"$dir/said" || { cat "$dir/said"; exit 1; }
    [ "$(links "$dir/cmake/package")" = "$kind" ]
    "$dir/cmake/package"
    echo "$kind: ran"
}

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

echo "== library alone"
install library -Dapp=false
! grep -E 'zlib|cmocka' "$dir/said" || { echo "the library needs CHOLMOD and jansson only" >&2; exit 1; }
find "$prefix" ! -type d | sed "s|$prefix/||" | LC_ALL=C sort

for header in include/projdyn/*; do
    [ -f "$prefix/$header" ] || { echo "$header is not installed" >&2; exit 1; }
done

echo "== symbols"
nm -D --defined-only "$library/libprojdyn.so" | awk '{ print $3 }' | LC_ALL=C sort >"$dir/shared"
nm -g --defined-only "$library/libprojdyn.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$dir/static"
! grep -v '^pdyn_' "$dir/shared" "$dir/static" || { echo "not pdyn_*" >&2; exit 1; }
diff "$dir/shared" "$dir/static"
echo "$(wc -l <"$dir/static") symbols, all pdyn_*, the same in both libraries"

echo "== cmake"
build_with_cmake shared
build_with_cmake static -Dprojdyn_USE_STATIC_LIBS=ON
for version in 0.0 0.99 1.0; do
    cmake -S tests/package -B "$dir/cmake-$version" -DCMAKE_PREFIX_PATH="$prefix" -DWANTED=$version >"$dir/said" 2>&1 || true
    grep -q 'compatible with requested' "$dir/said" || { echo "version $version is not refused:" && cat "$dir/said" && exit 1; }
done

echo "== pkg-config"
build_with_pkg_config shared
rm "$library"/libprojdyn.so* # the linker takes the static library where there is no shared one
build_with_pkg_config static --static

echo "== subproject of meson"
mkdir -p "$dir/project/subprojects"
cp tests/package/meson.build tests/package/package.c "$dir/project"
ln -s "$PWD" "$dir/project/subprojects/projdyn"
meson setup --wrap-mode=forcefallback "$dir-project" "$dir/project" >"$dir/said" || { cat "$dir/said"; exit 1; }
ninja -C "$dir-project" >"$dir/said" || { cat "$dir/said"; exit 1; }
"$dir-project/package"
echo "subproject: ran"

echo "== without CHOLMOD"
install free -Dcholmod=disabled
program=$prefix/bin/projdyn
if readelf -d "$program" "$library/libprojdyn.so" | grep -i cholmod || grep -i cholmod "$pc"; then
    echo "linked with CHOLMOD" >&2
    exit 1
fi
"$program" --version | grep -x 'solvers: cg dual hybrid'
"$program" run tests/pour.json --time 0.02 -o "$dir/run" >"$dir/said" 2>&1 || { cat "$dir/said"; exit 1; }
echo "pour.json: ran"
build_with_cmake static -Dprojdyn_USE_STATIC_LIBS=ON
rm "$library"/libprojdyn.so*
build_with_pkg_config static --static
