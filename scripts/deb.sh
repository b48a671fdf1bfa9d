#!/bin/sh
# Builds the Debian packages (debian/) from a copy of the working tree, checks them with lintian, unpacks them into an
# empty root, and uses them there: the program runs a scene, pkg-config builds a C program, Python loads the library.
# Argument: a folder that gets the packages; without it they are removed.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev make dpkg-dev debhelper dh-python help2man lintian meson ninja-build pkg-config \
    libsuitesparse-dev libjansson-dev zlib1g-dev libwebsockets-dev python3-numpy
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
say() { "$@" >"$dir/said" 2>&1 || { cat "$dir/said" >&2; exit 1; }; } # prints what a command says if it fails

echo "== packages"
mkdir "$dir/source" "$dir/root"
tar -c --exclude-vcs --exclude='./build*' --exclude='./out*' --exclude=./dist --exclude=__pycache__ . | tar -x -C "$dir/source"
version=$(dpkg-parsechangelog -S Version)
grep -q "^  version: '$version'" meson.build || { echo "debian/changelog: expected the version of meson.build, found $version" >&2; exit 1; }
(cd "$dir/source" && say dpkg-buildpackage -us -uc -b)
for package in libprojdyn0 libprojdyn-dev projdyn python3-projdyn; do
    file=$(echo "$dir/${package}_${version}"_*.deb)
    dpkg -x "$file" "$dir/root"
    echo "$package: $(dpkg-deb --field "$file" Installed-Size) KiB, depends on $(dpkg-deb --field "$file" Depends)"
done
lintian --allow-root --fail-on error,warning "$dir"/*.changes

echo "== installed packages"
root=$dir/root/usr
library=$(dirname "$(find "$root" -name 'libprojdyn.so.0')")
export LD_LIBRARY_PATH="$library"
"$root/bin/projdyn" --version
say "$root/bin/projdyn" run "$root/share/doc/projdyn/examples/hanging_cloth.json" --time 0.04 -o "$dir/run"
[ -s "$dir/run/report.json" ] && echo "hanging_cloth: ran"
# shellcheck disable=SC2046
cc -o "$dir/package" tests/package/package.c $(PKG_CONFIG_PATH="$library/pkgconfig" pkg-config --define-variable=prefix="$root" --cflags --libs projdyn)
"$dir/package"
cat >"$dir/check.py" <<'END'
import projdyn
print("python:", projdyn.version())
END
PYTHONPATH=$root/lib/python3/dist-packages /usr/bin/python3 -B "$dir/check.py"

[ $# = 0 ] || cp "$dir"/*.deb "$1"
