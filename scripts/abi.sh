#!/bin/sh
# Compares the binary interface of the installed headers and library with that of the last release,
# tests/abi/projdyn-0.1.json: fails where a function, a member or an enumerator was removed or changed. --update writes
# that file anew: for a release, or after a change on purpose. CHANGELOG.md says which number such a change raises.
#
# The interface is read from the debug information of an object file that includes all headers and has a pointer to
# every exported function. A function that no header declares does not compile.
set -eu
cd "$(dirname "$0")/.."
scripts/install.sh gcc libc6-dev binutils dwarves python3
[ -f build/build.ninja ] || scripts/build.sh
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

meson install -C build --quiet --destdir "$dir" >/dev/null
library=$(find "$dir" -name libprojdyn.so) include=$(find "$dir" -name include)
{
    find "$include" -name '*.h' -printf '#include <projdyn/%f>\n' | LC_ALL=C sort
    echo 'union functions {'
    nm -D --defined-only "$library" | awk '{ print "__typeof__(" $3 ") *" $3 ";" }'
    echo '} functions;'
} >"$dir/interface.c"
gcc -g -fno-eliminate-unused-debug-types -I"$include" -c -o "$dir/interface.o" "$dir/interface.c"
scripts/abi.py tests/abi/projdyn-0.1.json "$dir/interface.o" "$@"
