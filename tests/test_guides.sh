#!/bin/sh
# Follows the guides as a reader who starts with nothing: runs the code blocks of a page, in their
# order, in an empty directory, with `projdyn` in PATH.
# Pictures and films are small, the run with more particles is short, and runs have one thread.
# Usage: test_guides.sh PROJDYN SOURCE-ROOT
set -eu
projdyn=$(realpath "$1") root=$(realpath "$2")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
PATH=$(dirname "$projdyn"):$PATH
export PYTHONPATH="$root/python" PROJDYN_LIBRARY="$(dirname "$projdyn")/../src/libprojdyn.so.0"

blocks() { # LANGUAGE PAGE: its code blocks, one after the other
    sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/{/^\`\`\`/d;p}" "$root/docs/guide/$2.md"
}

follow() { # PAGE LANGUAGE INTERPRETER...
    page=$1 language=$2
    shift 2
    mkdir "$dir/$page"
    blocks "$language" "$page" |
        sed 's/^projdyn render .*/& --size 64x48/; s/^projdyn run .* -o fine$/& --time 0.1/; s/^projdyn run .*/& --threads 1/' >"$dir/commands"
    [ -s "$dir/commands" ] || { echo "not ok $page: no code blocks"; exit 1; }
    (cd "$dir/$page" && "$@" "$dir/commands") >"$dir/said" 2>&1 ||
        { echo "not ok $page:"; tail -n 20 "$dir/said"; exit 1; }
    echo "ok $page"
}

if /usr/bin/python3 -c 'import matplotlib, meshio, numpy, vtkmodules' 2>/dev/null; then
    follow python python /usr/bin/python3
else
    echo "skipped python: matplotlib, meshio, numpy or vtk is not installed"
fi

command -v chromium >/dev/null && command -v ffmpeg >/dev/null || {
    echo "skipped first-scene: chromium or ffmpeg is not installed"
    exit 77
}
follow first-scene sh sh -eu

# What the page says of its steps 2 and 3: water leaks, and contact holds it.
grep -q '"leak"' "$dir/first-scene/leak/report.json" || { echo "not ok first-scene: no leak in step 2"; exit 1; }
grep -q '"warnings": \[\]' "$dir/first-scene/cloth/report.json" || { echo "not ok first-scene: a warning in step 3"; exit 1; }
