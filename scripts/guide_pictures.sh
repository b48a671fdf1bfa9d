#!/bin/sh
# Makes the pictures of docs/guide/first-scene.md: runs the commands of the page and takes a picture
# of each result.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
scripts/install.sh chromium
root=$PWD dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
PATH=$root/build/app:$PATH
sed -n '/^```sh$/,/^```$/{/^```/d;p}' docs/guide/first-scene.md >"$dir/commands"
(cd "$dir" && sh -eu commands)

# run, frame
while read -r run frame; do
    chromium --headless --no-sandbox --disable-gpu --use-gl=angle --use-angle=swiftshader \
        --enable-unsafe-swiftshader --hide-scrollbars --user-data-dir="$dir/profile" --window-size=640,400 \
        --virtual-time-budget=10000 --screenshot="docs/guide/first-scene/$run.png" \
        "file://$dir/$run/replay.html#frame=$frame&play=0" >/dev/null 2>&1 </dev/null
    echo "docs/guide/first-scene/$run.png"
done <<'EOF'
sheet 8
leak 18
cloth 24
own 9
fine 9
EOF
