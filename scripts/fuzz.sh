#!/bin/sh
# Fuzzes what reads files, with ASan and UBSan: each target for so many seconds (default 10), from the
# seeds of fuzz/seeds and the scenes. Usage: fuzz.sh [SECONDS [TARGET...]]
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-10}
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- scene obj ply stl points tetgen gmsh table
scripts/install.sh clang libclang-rt-14-dev
[ -f build-fuzz/build.ninja ] || CC=clang meson setup build-fuzz -Dfuzz=true -Dbuildtype=debugoptimized \
    -Doptimization=1 -Db_sanitize=address,undefined -Db_lundef=false \
    -Dc_args='-fsanitize=fuzzer-no-link -fno-sanitize-recover=all -gline-tables-only' >/dev/null
for target in "$@"; do set -- "$@" "fuzz/fuzz_$target"; shift; done
ninja -C build-fuzz "$@" >/dev/null
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
for path in "$@"; do
    target=${path#fuzz/fuzz_} seeds=fuzz/seeds/${path#fuzz/fuzz_}
    [ -d "$seeds" ] || seeds=scenes
    mkdir "$dir/$target"
    (cd "$dir" && UBSAN_OPTIONS=halt_on_error=1 "$OLDPWD/build-fuzz/$path" -max_total_time="$seconds" -max_len=4096 \
        -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$OLDPWD/out-fuzz-" \
        "$dir/$target" "$OLDPWD/$seeds" >"$dir/said" 2>&1) || { tail -n 40 "$dir/said"; exit 1; }
    echo "$target: $(grep -o 'number_of_executed_units: .*' "$dir/said" | tr -s ' ') in $seconds s, no finding"
done
