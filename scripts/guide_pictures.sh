#!/bin/sh
# Makes the pictures of docs/guide/first-scene.md: runs the commands of the page and draws each run.
set -eu
cd "$(dirname "$0")/.."
scripts/build.sh >/dev/null
scripts/install.sh chromium ffmpeg pngquant
root=$PWD dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
PATH=$root/build/app:$PATH
sed -n '/^```sh$/,/^```$/{/^```/d;p}' docs/guide/first-scene.md >"$dir/commands"
(cd "$dir" && sh -eu commands)

while read -r run time; do
    projdyn render "$dir/$run" -o "docs/guide/first-scene/$run.png" --size 640x400 --time "$time" </dev/null
    pngquant --force --ext .png "docs/guide/first-scene/$run.png"
done <<'EOF'
sheet 0.25
leak 0.6
cloth 0.8
own 0.3
fine 0.3
EOF
